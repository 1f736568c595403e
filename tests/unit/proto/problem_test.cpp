#include "sheetform_api/problem.h"

#include <gtest/gtest.h>

#include <set>

namespace sheetform::api {
namespace {

TEST(Problem, KindsStandInTheOrderOfTheirTypes) {
  std::set<std::string> slugs;
  for (std::size_t i = 0; i < problem_kinds().size(); ++i) {
    EXPECT_EQ(static_cast<std::size_t>(problem_kinds()[i].type), i);
    EXPECT_TRUE(slugs.insert(problem_kinds()[i].slug).second);
    EXPECT_EQ(problem_type_from_slug(problem_kinds()[i].slug), problem_kinds()[i].type);
  }
  EXPECT_EQ(problem_kinds().back().type, ProblemType::kInternal);
}

TEST(Problem, RoundTripsThroughJson) {
  Problem p;
  p.type = ProblemType::kUnreadableMesh;
  p.detail = "a coordinate is not a number";
  p.where = "line 4";
  p.fix = "export again";
  p.limit = 7;
  const Json json = to_json(p);
  EXPECT_EQ(json.at("type"), "urn:sheetform:problem:unreadable-mesh");
  EXPECT_EQ(json.at("status"), 422);
  const Problem back = problem_from_json(json);
  EXPECT_EQ(to_json(back), json);
}

TEST(Problem, OgcTypesHaveTheirUri) {
  EXPECT_EQ(type_uri(ProblemType::kNoSuchJob),
            "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/no-such-job");
}

TEST(Problem, StrangeJsonIsInternal) {
  EXPECT_EQ(problem_from_json(Json::parse("[1]")).type, ProblemType::kInternal);
  EXPECT_EQ(problem_from_json(Json::parse(R"({"type":5,"detail":[]})")).type, ProblemType::kInternal);
}

}  // namespace
}  // namespace sheetform::api
