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
  EXPECT_THAT(names,
              testing::UnorderedElementsAre("target_size", "scale", "e_max", "e_max_mm", "normal_deviation",
                                            "t_junctions", "self_seams", "creases", "symmetry", "max_sides",
                                            "ruling_spacing_min", "ruling_spacing_max", "min_bend_radius",
                                            "effort", "morph", "seed", "material", "up"));
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

TEST(SweepParameters, TolerancesComeOutAscending) {
  const Json all = complete_sweep_parameters(Json{{"e_max", sweep_tolerances_from_text("0.05,0.01,0.02")}});
  EXPECT_EQ(all.at("e_max"), Json::parse("[0.01,0.02,0.05]"));
  EXPECT_EQ(all.at("t_junctions"), true);
}

TEST(SweepParameters, WrongListsAreRefused) {
  for (const char* text :
       {R"({})", R"({"e_max":0.02})", R"({"e_max":[]})", R"({"e_max":[0.02,0.02]})", R"({"e_max":[0.02,0]})",
        R"({"e_max":[0.02,"0.03"]})", R"({"e_max":[0.02],"e_max_mm":1})", R"({"e_max":[0.02],"emax":1})",
        R"({"e_max":[0.01,0.02,0.03,0.04,0.05,0.06,0.07,0.08,0.09,0.1,0.11]})"})
    EXPECT_THROW((void)complete_sweep_parameters(Json::parse(text)), InvalidParameter) << text;
  for (const char* text : {"", "0.1,", ",0.1", "0.1;0.2", "0.1, 0.2", "2", "a"})
    EXPECT_THROW((void)sweep_tolerances_from_text(text), InvalidParameter) << text;
}

TEST(Process, OfASweepTakesAListOfTolerances) {
  const OrderedJson process = process_description(kSweep, "/api/v1", "1");
  EXPECT_EQ(process["inputs"]["e_max"]["minOccurs"], 1);
  EXPECT_EQ(process["inputs"]["e_max"]["schema"]["items"]["maximum"], 0.5);
  EXPECT_FALSE(process["inputs"].contains("e_max_mm"));
  EXPECT_TRUE(process["inputs"].contains("symmetry"));
  EXPECT_TRUE(process["outputs"].contains("sweep.json"));
  EXPECT_FALSE(process["outputs"].contains("layout.svg"));
  EXPECT_EQ(output_title("0.02-layout.svg"), output_title("layout.svg"));
  EXPECT_EQ(output_title("-layout.svg"), "");
}

TEST(Process, DescribesEveryParameterAndOutput) {
  const OrderedJson process = process_description(kDecompose, "/api/v1", "1");
  for (const ParameterDefinition& d : parameter_definitions())
    EXPECT_EQ(Json::parse(process["inputs"][d.name]["schema"].dump()), d.schema) << d.name;
  EXPECT_TRUE(process["inputs"].contains("mesh"));
  EXPECT_TRUE(process["outputs"].contains("layout.svg"));
  EXPECT_FALSE(process["outputs"].contains("sweep.json"));
}

}  // namespace
}  // namespace sheetform::api
