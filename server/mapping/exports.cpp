#include "server/mapping/exports.h"

#include "server/base/version.h"
#include "sheetform/blueprint/exports.h"

namespace sheetform::server {
namespace {

struct FormatTitle {
  const char *name, *title;
};
constexpr FormatTitle kFormats[] = {{"svg", "Sheets to cut, true to scale (SVG)"},
                                    {"dxf", "Sheets to cut, in millimetres (DXF)"},
                                    {"pdf", "Sheets to print, with parts list and assembly steps (PDF)"},
                                    {"parts-svg", "One file a part (SVG)"},
                                    {"parts-dxf", "One file a part (DXF)"},
                                    {"fold", "Crease pattern and folded form (FOLD)"},
                                    {"frame", "Frame of rods along the seams, to print in 3D (STL)"},
                                    {"parts-json", "Parts with areas, lengths and order of assembly (JSON)"},
                                    {"parts-csv", "Parts as a table (CSV)"},
                                    {"zip", "All of these in one archive (ZIP)"}};

std::vector<Profile> own_profiles(const std::string& json) {
  return json.empty() ? std::vector<Profile>{} : read_profiles(json);
}

}  // namespace

void check_export(const ExportWish& wish) { (void)read_export_request(wish.format, wish.query); }

void check_profiles(const std::string& json) { (void)own_profiles(json); }

api::Json exports_document(const std::string& root, const std::string& profiles) {
  api::Json formats = api::Json::array(), parameters = api::Json::array();
  for (const FormatTitle& f : kFormats)
    formats.push_back({{"format", f.name}, {"title", f.title}, {"href", root + "/" + f.name}});
  for (const ExportParameter& p : export_parameters()) {
    api::Json one{{"name", p.name}, {"default", p.otherwise}, {"text", p.text}};
    if (!p.choices.empty()) one["choices"] = p.choices;
    if (p.name == "profile")
      for (const Profile& own : own_profiles(profiles)) one["choices"].push_back(own.name);
    if (p.open) one["open"] = true;
    parameters.push_back(std::move(one));
  }
  return {{"formats", formats}, {"parameters", parameters}};
}

api::Json to_json(const ExportWish& w, const std::string& profiles) {
  return {{"format", w.format},       {"query", w.query},    {"job", w.job},
          {"model", w.model},         {"link", w.link},      {"version", kVersion},
          {"digest", w.input_digest}, {"profiles", profiles}};
}

OutputFile run_export(std::string_view ruled_obj, std::string_view layout_json, const api::Json& wish) {
  const std::string format = wish.at("format"), profiles = wish.at("profiles");
  const std::map<std::string, std::string> query = wish.at("query");
  BlueprintOrigin origin;
  origin.version = wish.at("version");
  origin.job = wish.at("job");
  origin.model = wish.at("model");
  origin.input_digest = wish.at("digest");
  origin.link = wish.at("link");
  Artifact file = export_result(ruled_obj, layout_json, read_export_request(format, query), origin,
                                own_profiles(profiles));
  return {std::move(file.name), std::move(file.media_type), std::move(file.content)};
}

}  // namespace sheetform::server
