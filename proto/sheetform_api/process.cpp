#include "sheetform_api/process.h"

#include <algorithm>

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

/// Files that may come with the mesh, as parts of a form.
OrderedJson guides_input() {
  OrderedJson schema{{"type", "object"}};
  schema["properties"] = {{"seams", {{"type", "array"}}}, {"keep_out", {{"type", "array"}}}};
  return {{"title", "Guides"},
          {"description",
           "Strokes drawn on the mesh, in its units: lines that become seams, and areas that seams keep out "
           "of. In a form the part `guides`"},
          {"minOccurs", 0},
          {"maxOccurs", 1},
          {"schema", std::move(schema)}};
}

OrderedJson parameter_input(const ParameterDefinition& d) {
  return {{"title", d.title},
          {"description", d.text},
          {"minOccurs", 0},
          {"maxOccurs", 1},
          {"schema", OrderedJson::parse(dump(d.schema))}};
}

OrderedJson tolerances_input(const ParameterDefinition& d) {
  return {{"title", "Tolerances"},
          {"description", d.text + " A list; in a query with commas between."},
          {"minOccurs", 1},
          {"maxOccurs", 1},
          {"schema", OrderedJson::parse(dump(sweep_tolerances_schema()))}};
}

OrderedJson inputs(bool sweep) {
  OrderedJson object{{"mesh", mesh_input()}, {"guides", guides_input()}};
  for (const ParameterDefinition& d : parameter_definitions()) {
    if (!sweep)
      object[d.name] = parameter_input(d);
    else if (d.name == kTolerance)
      object[d.name] = tolerances_input(d);
    else if (is_sweep_parameter(d.name))
      object[d.name] = parameter_input(d);
  }
  return object;
}

/// The files of each point of a sweep are not listed: their names follow from the tolerances.
OrderedJson outputs(bool sweep) {
  OrderedJson object = OrderedJson::object();
  for (const OutputDefinition& o : output_definitions())
    if (o.of_sweep == sweep)
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
      {"ruled.obj", "model/obj", "The bent sheets in 3D, with the flat layout as texture coordinates"},
      {"sweep.json", "application/json", "Parts, cut length and distance for each tolerance", true},
      {"sweep.csv", "text/csv", "The same as a table", true}};
  return list;
}

std::string output_title(const std::string& name) {
  for (const OutputDefinition& o : output_definitions()) {
    if (name == o.name) return o.title;
    const std::string end = point_file({}, o.name);
    if (name.size() > end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0)
      return o.title;
  }
  return {};
}

std::string point_file(const std::string& point, const std::string& name) { return point + "-" + name; }

bool is_process(std::string_view id) {
  return std::find(std::begin(kProcesses), std::end(kProcesses), id) != std::end(kProcesses);
}

Json process_summary(const std::string& id, const std::string& root, const std::string& version) {
  const bool sweep = id == kSweep;
  const std::string self = root + "/processes/" + id;
  return {
      {"id", id},
      {"version", version},
      {"title", sweep ? "Fewer parts, or closer to the shape" : "Cut a surface into developable sheets"},
      {"description",
       sweep
           ? "Decomposes a mesh for several tolerances in one job: parts and cut length against error. Each "
             "point of the curve opens as a job of its own, without being computed again."
           : "Decomposes a mesh into sheets that are cut flat and bent into shape, within a tolerance."},
      {"jobControlOptions", {"async-execute", "dismiss"}},
      {"outputTransmission", {"reference"}},
      {"links", to_json({{self, "self", "application/json", "This process"},
                         {self + "/execution", kExecuteRel, "application/json", "Start a job"}})}};
}

OrderedJson process_description(const std::string& id, const std::string& root, const std::string& version) {
  OrderedJson object = OrderedJson::parse(dump(process_summary(id, root, version)));
  object["x-groups"] = groups();
  object["inputs"] = inputs(id == kSweep);
  object["outputs"] = outputs(id == kSweep);
  return object;
}

}  // namespace sheetform::api
