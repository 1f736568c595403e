#include "sheetform_api/process.h"

#include "sheetform_api/job.h"
#include "sheetform_api/parameter_schema.h"

namespace sheetform::api {
namespace {

constexpr const char* kExecuteRel = "http://www.opengis.net/def/rel/ogc/1.0/execute";

OrderedJson mesh_input() {
  OrderedJson forms = OrderedJson::array();
  for (const char* type : kMeshMediaTypes)
    forms.push_back({{"type", "string"}, {"contentEncoding", "binary"}, {"contentMediaType", type}});
  return {{"title", "Mesh"},
          {"description", "The surface as OBJ, STL, PLY or OFF; the format is found from the bytes"},
          {"minOccurs", 1},
          {"maxOccurs", 1},
          {"schema", {{"oneOf", forms}}}};
}

OrderedJson parameter_input(const ParameterDefinition& d) {
  return {{"title", d.title},
          {"description", d.text},
          {"minOccurs", 0},
          {"maxOccurs", 1},
          {"schema", OrderedJson::parse(dump(d.schema))}};
}

OrderedJson inputs() {
  OrderedJson object{{"mesh", mesh_input()}};
  for (const ParameterDefinition& d : parameter_definitions()) object[d.name] = parameter_input(d);
  return object;
}

OrderedJson outputs() {
  OrderedJson object = OrderedJson::object();
  for (const OutputDefinition& o : output_definitions())
    object[o.name] = {{"title", o.title},
                      {"schema", {{"type", "string"}, {"contentMediaType", o.media_type}}}};
  return object;
}

OrderedJson groups() {
  OrderedJson list = OrderedJson::array();
  for (const ParameterGroup& g : parameter_groups())
    list.push_back({{"id", g.id}, {"title", g.title}, {"text", g.text}});
  return list;
}

}  // namespace

const std::vector<OutputDefinition>& output_definitions() {
  static const std::vector<OutputDefinition> list{
      {"layout.svg", "image/svg+xml", "The parts to cut, in millimetres (SVG)"},
      {"layout.json", "application/json", "Structure and report"},
      {"ruled.obj", "model/obj", "The bent sheets in 3D, with the flat layout as texture coordinates"}};
  return list;
}

std::string output_title(const std::string& name) {
  for (const OutputDefinition& o : output_definitions())
    if (name == o.name) return o.title;
  return {};
}

Json process_summary(const std::string& root, const std::string& version) {
  const std::string self = root + "/processes/" + kDecompose;
  return {{"id", kDecompose},
          {"version", version},
          {"title", "Cut a surface into developable sheets"},
          {"description",
           "Decomposes a mesh into sheets that are cut flat and bent into shape, within a tolerance."},
          {"jobControlOptions", {"async-execute", "dismiss"}},
          {"outputTransmission", {"reference"}},
          {"links", to_json({{self, "self", "application/json", "This process"},
                             {self + "/execution", kExecuteRel, "application/json", "Start a job"}})}};
}

OrderedJson process_description(const std::string& root, const std::string& version) {
  OrderedJson object = OrderedJson::parse(dump(process_summary(root, version)));
  object["x-groups"] = groups();
  object["inputs"] = inputs();
  object["outputs"] = outputs();
  return object;
}

}  // namespace sheetform::api
