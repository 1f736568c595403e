#include "sheetform_api/job.h"

#include <gtest/gtest.h>

namespace sheetform::api {
namespace {

bool has_link(const Json& status, const std::string& href) {
  for (const Json& link : status.at("links"))
    if (link.at("href") == href) return true;
  return false;
}

TEST(StatusInfo, HasWhatOgcAsksFor) {
  StatusInfo s;
  s.id = "1";
  s.process = "decompose";
  s.state = JobState::kSuccessful;
  const Json json = Json::parse(status_text(s, "/api/v1"));
  EXPECT_EQ(json.at("jobID"), "1");
  EXPECT_EQ(json.at("type"), "process");
  EXPECT_EQ(json.at("status"), "successful");
  EXPECT_TRUE(has_link(json, "/api/v1/jobs/1/results"));
  EXPECT_FALSE(json.contains("finished"));
}

TEST(StatusInfo, NoResultsLinkBeforeTheEnd) {
  StatusInfo s;
  s.id = "1";
  EXPECT_FALSE(has_link(Json::parse(status_text(s, "/api/v1")), "/api/v1/jobs/1/results"));
}

TEST(StatusInfo, TellsWhatIsKeptAsTextAsItStands) {
  StatusInfo s;
  s.id = "1";
  s.state = JobState::kFailed;
  s.message = "\"},{";
  s.mesh = R"({"name":"a\"guides\":"})";
  s.parameters = R"({"e_max":0.02})";
  s.report = R"({"parts":[1,2]})";
  s.problem = Problem{};
  Json json = Json::parse(status_text(s, "/api/v1"));
  EXPECT_EQ(json.at("message"), s.message);
  EXPECT_EQ(json.at("inputs").at("mesh"), Json::parse(s.mesh));
  EXPECT_EQ(json.at("parameters"), Json::parse(s.parameters));
  EXPECT_EQ(json.at("report"), Json::parse(s.report));
  EXPECT_EQ(json.at("exception"), to_json(*s.problem));
  EXPECT_FALSE(has_link(json, "/api/v1/jobs/1/guides"));
  s.mesh = R"({"guides":{"seams":1}})";
  json = Json::parse(status_text(s, "/api/v1"));
  EXPECT_TRUE(has_link(json, "/api/v1/jobs/1/guides"));
  EXPECT_EQ(Json::parse(array_text({"1", "{}"})), Json::parse("[1,{}]"));
  EXPECT_EQ(array_text({}), "[]");
}

TEST(JobState, NamesRoundTrip) {
  for (const JobState s : {JobState::kAccepted, JobState::kRunning, JobState::kSuccessful, JobState::kFailed,
                           JobState::kDismissed})
    EXPECT_EQ(job_state_from(to_string(s)), s);
  EXPECT_FALSE(job_state_from("done"));
}

TEST(MeshInfo, RoundTripsAndTellsTheSize) {
  MeshInfo m;
  m.name = "a.obj";
  m.bytes = 10;
  m.format = "obj";
  m.vertices = 3;
  m.faces = 1;
  m.box_max = {2, 3, 6};
  m.scale = 25.4;
  const Json json = to_json(m);
  EXPECT_DOUBLE_EQ(json.at("bboxDiagonal").get<double>(), 7);
  EXPECT_DOUBLE_EQ(json.at("sizeMm").at(2).get<double>(), 6 * 25.4);
  EXPECT_EQ(json.at("unitAssumed"), "1 unit = 25.4 mm");
  EXPECT_EQ(to_json(mesh_info_from_json(json)), json);
}

ProblemType refusal(const char* text) {
  ExecuteRequest request;
  Problem problem;
  EXPECT_FALSE(read_execute_request(Json::parse(text), request, problem)) << text;
  return problem.type;
}

TEST(ExecuteRequest, IsRead) {
  ExecuteRequest request;
  Problem problem;
  ASSERT_TRUE(read_execute_request(
      Json::parse(R"({"inputs":{"mesh":{"value":"QUJD","filename":"a.stl"},"e_max":0.1},"tag":"x"})"),
      request, problem));
  EXPECT_EQ(request.mesh_base64, "QUJD");
  EXPECT_EQ(request.mesh_name, "a.stl");
  EXPECT_EQ(request.parameters, Json::parse(R"({"e_max":0.1})"));
  EXPECT_EQ(request.tag, "x");
  EXPECT_TRUE(read_execute_request(Json::parse(R"({"inputs":{"mesh":"QUJD"}})"), request, problem));
  EXPECT_TRUE(read_execute_request(Json::parse(R"({"inputs":{"mesh":"QUJD"},"response":"document",
      "outputs":{"layout.svg":{},"ruled.obj":{"transmissionMode":"reference"}}})"),
                                   request, problem));
}

TEST(ExecuteRequest, WrongShapesAreRefused) {
  for (const char* text :
       {"[]", "{}", R"({"inputs":[]})", R"({"inputs":{}})", R"({"inputs":{"mesh":5}})",
        R"({"inputs":{"mesh":{}}})", R"({"inputs":{"mesh":""},"x":1})", R"({"inputs":{"mesh":""},"tag":1})",
        R"({"inputs":{"mesh":""},"response":"raw"})", R"({"inputs":{"mesh":""},"response":"banana"})",
        R"({"inputs":{"mesh":""},"outputs":["layout.svg"]})",
        R"({"inputs":{"mesh":""},"outputs":{"nix":{}}})",
        R"({"inputs":{"mesh":""},"outputs":{"layout.svg":{"transmissionMode":"value"}}})"})
    EXPECT_EQ(refusal(text), ProblemType::kMalformedRequest) << text;
  EXPECT_EQ(refusal(R"({"inputs":{"mesh":{"href":"http://x"}}})"), ProblemType::kRemoteInputDisabled);
}

TEST(ResultsDocument, KeepsTheOrder) {
  const OrderedJson doc = results_document(
      {{"b.svg", "image/svg+xml", "", 3, "00"}, {"a.obj", "model/obj", "A", 4, "11"}}, "/api/v1/jobs/1");
  EXPECT_EQ(
      dump(doc),
      R"({"b.svg":{"href":"/api/v1/jobs/1/results/b.svg","type":"image/svg+xml","length":3,"sha256":"00"},)"
      R"("a.obj":{"href":"/api/v1/jobs/1/results/a.obj","type":"model/obj","title":"A","length":4,"sha256":"11"}})");
}

}  // namespace
}  // namespace sheetform::api
