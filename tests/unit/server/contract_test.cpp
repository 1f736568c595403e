// proto/openapi.yaml and the handlers describe the same API: every route is described, everything described
// has a route.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "server/base/identity.h"
#include "server/http/api_server.h"
#include "sheetform_api/api_description.h"

namespace sheetform::server {
namespace {

class ContractTest : public testing::Test {
 protected:
  ContractTest()
      : folder_(std::filesystem::temp_directory_path() / ("sheetform-contract-" + to_hex(random_bytes(6)))) {}
  ~ContractTest() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
  const api::Json description_ = api::Json::parse(api::api_description());
};

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return static_cast<char>(std::toupper(static_cast<unsigned char>(c))); });
  return text;
}

std::vector<std::string> described(const api::Json& description) {
  std::vector<std::string> list;
  for (const auto& [path, item] : description.at("paths").items())
    for (const auto& [method, operation] : item.items())
      if (method != "parameters") list.push_back(upper(method) + " " + path);
  return list;
}

TEST_F(ContractTest, RoutesAndDescriptionAreTheSame) {
  ServiceOptions options;
  options.data = folder_;
  JobService service(options);
  const ApiServer server(service, {});
  std::vector<std::string> routes;
  for (const Route& r : server.router().routes())
    if (r.path != "/api/v1") routes.push_back(r.method + " " + r.path);  // the landing page without its slash
  EXPECT_THAT(routes, testing::UnorderedElementsAreArray(described(description_)));
}

TEST_F(ContractTest, EveryOperationIsFitForPeople) {
  std::vector<std::string> names;
  for (const auto& [path, item] : description_.at("paths").items())
    for (const auto& [method, operation] : item.items()) {
      if (method == "parameters") continue;
      EXPECT_FALSE(operation.value("summary", "").empty()) << method << path;
      names.push_back(operation.at("operationId"));
      for (const auto& [status, response] : operation.at("responses").items())
        EXPECT_TRUE(response.contains("$ref") || response.at("description").is_string())  // `Yes` is none
            << method << path << status;
    }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
}

TEST_F(ContractTest, EveryReferenceLeadsSomewhere) {
  std::vector<const api::Json*> open{&description_};
  int references = 0;
  while (!open.empty()) {
    const api::Json& node = *open.back();
    open.pop_back();
    if (node.is_object() && node.contains("$ref") && node["$ref"].is_string()) {
      const std::string target = node["$ref"];
      ASSERT_EQ(target.rfind("#/", 0), 0u) << target;
      EXPECT_TRUE(description_.contains(api::Json::json_pointer(target.substr(1)))) << target;
      ++references;
    }
    EXPECT_FALSE(node.is_null());  // a text with a comma, not quoted, becomes a name without a value
    if (node.is_structured())
      for (const api::Json& child : node) open.push_back(&child);
  }
  EXPECT_GT(references, 50);
}

TEST_F(ContractTest, EveryTypeOfProblemIsListed) {
  const api::Json& type =
      description_.at("components").at("schemas").at("Problem").at("properties").at("type");
  ASSERT_EQ(type.at("enum").size(), api::problem_kinds().size());
  for (const api::ProblemKind& kind : api::problem_kinds()) {
    EXPECT_THAT(type.at("enum"), testing::Contains(api::type_uri(kind.type)));
    EXPECT_NE(type.at("description").get<std::string>().find(kind.title), std::string::npos);
  }
}

}  // namespace
}  // namespace sheetform::server
