#include "sheetform_api/parameter_schema.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sheetform_api/api_description.h"
#include "sheetform_api/process.h"

namespace sheetform::api {
namespace {

const ParameterDefinition& parameter(const char* name) {
  const ParameterDefinition* d = find_parameter(name);
  if (d == nullptr) throw std::logic_error(name);
  return *d;
}

std::string refusal_of(const char* name, const std::string& text) {
  try {
    (void)parameter_from_text(parameter(name), text);
    return "taken";
  } catch (const InvalidParameter& e) {
    EXPECT_EQ(e.name(), name);
    EXPECT_FALSE(e.fix().empty());
    return "refused";
  }
}

TEST(ParameterSchema, NamesEveryParameterOnce) {
  std::vector<std::string> names;
  for (const ParameterDefinition& d : parameter_definitions()) names.push_back(d.name);
  EXPECT_THAT(names, testing::UnorderedElementsAre(
                         "target_size", "scale", "e_max", "e_max_mm", "normal_deviation", "t_junctions",
                         "self_seams", "creases", "symmetry", "max_sides", "ruling_spacing_min",
                         "ruling_spacing_max", "min_bend_radius", "effort", "morph", "seed"));
}

TEST(ParameterSchema, EveryDefinitionIsFitForPeople) {
  std::vector<std::string> groups;
  for (const ParameterGroup& g : parameter_groups()) groups.push_back(g.id);
  for (const ParameterDefinition& d : parameter_definitions()) {
    EXPECT_FALSE(d.title.empty()) << d.name;
    EXPECT_GT(d.text.size(), 10u) << d.name;
    EXPECT_FALSE(d.values().empty()) << d.name;
    EXPECT_THAT(groups, testing::Contains(d.group)) << d.name;
  }
}

TEST(ParameterSchema, DefaultsPassTheirOwnChecks) {
  const Json all = complete_parameters(Json::object());
  EXPECT_EQ(all.at("e_max"), 0.02);
  EXPECT_FALSE(all.contains("e_max_mm"));
  EXPECT_EQ(complete_parameters(all), all);
}

struct Case {
  const char *name, *text, *answer;
};

TEST(ParameterSchema, TextsAreTakenOrRefused) {
  const Case cases[] = {{"e_max", "0.02", "0.02"},
                        {"e_max", "5e-1", "0.5"},
                        {"e_max", "0", "refused"},
                        {"e_max", "0.51", "refused"},
                        {"e_max", "-0.1", "refused"},
                        {"e_max", "nan", "refused"},
                        {"e_max", "inf", "refused"},
                        {"e_max", "1e999", "refused"},
                        {"e_max", "", "refused"},
                        {"e_max", "0.02mm", "refused"},
                        {"e_max", " 0.02", "refused"},
                        {"e_max", "+0.02", "refused"},
                        {"e_max", "0,02", "refused"},
                        {"max_sides", "6", "6"},
                        {"max_sides", "6.0", "refused"},
                        {"max_sides", "7", "refused"},
                        {"max_sides", "2", "refused"},
                        {"seed", "9007199254740991", "9007199254740991"},
                        {"seed", "-1", "refused"},
                        {"t_junctions", "on", "true"},
                        {"t_junctions", "off", "false"},
                        {"t_junctions", "yes", "refused"},
                        {"creases", "off", "\"off\""},
                        {"creases", "40", "40.0"},
                        {"creases", "0.5", "refused"},
                        {"creases", "none", "refused"},
                        {"effort", "draft", "\"draft\""},
                        {"effort", "Draft", "refused"},
                        {"symmetry", "auto", "\"auto\""},
                        {"symmetry", "1,0,0,2.5", "\"1,0,0,2.5\""},
                        {"symmetry", "0,0,0,1", "refused"},
                        {"symmetry", "1,0,0", "refused"},
                        {"symmetry", "1,0,0,1,1", "refused"},
                        {"symmetry", "1,0,0,", "refused"},
                        {"symmetry", "1,0,nan,0", "refused"}};
  for (const Case& c : cases) {
    SCOPED_TRACE(std::string(c.name) + "=" + c.text);
    if (std::string(c.answer) == "refused")
      EXPECT_EQ(refusal_of(c.name, c.text), "refused");
    else
      EXPECT_EQ(dump(parameter_from_text(parameter(c.name), c.text)), c.answer);
  }
}

TEST(ParameterSchema, WrongJsonIsRefusedByName) {
  for (const char* text :
       {R"({"e_max":"0.02"})", R"({"t_junctions":"on"})", R"({"max_sides":5.5})", R"({"seed":1.5})",
        R"({"emax":1})", R"({"creases":true})", R"({"symmetry":4})", R"({"effort":null,"x":1})"})
    EXPECT_THROW((void)complete_parameters(Json::parse(text)), InvalidParameter) << text;
  EXPECT_EQ(complete_parameters(Json::parse(R"({"e_max":null})")).at("e_max"), 0.02);
}

TEST(ParameterSchema, FlagsAreWrittenWithDashes) { EXPECT_EQ(parameter("e_max_mm").flag(), "--e-max-mm"); }

TEST(ApiDescription, HoldsTheSchemaInItsOwnWords) {
  const Json description = Json::parse(api_description());
  const Json& property =
      description.at("components").at("schemas").at("Parameters").at("properties").at("e_max");
  EXPECT_EQ(property.at("exclusiveMinimum"), true);
  EXPECT_EQ(property.at("minimum"), 0);
  EXPECT_EQ(description.at("openapi"), "3.0.3");
}

TEST(Process, DescribesEveryParameterAndOutput) {
  const OrderedJson process = process_description("/api/v1", "1");
  for (const ParameterDefinition& d : parameter_definitions())
    EXPECT_EQ(Json::parse(process["inputs"][d.name]["schema"].dump()), d.schema) << d.name;
  EXPECT_TRUE(process["inputs"].contains("mesh"));
  EXPECT_TRUE(process["outputs"].contains("layout.svg"));
}

}  // namespace
}  // namespace sheetform::api
