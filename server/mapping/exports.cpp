#include "server/mapping/exports.h"

#include "server/base/version.h"
#include "sheetform/base/error.h"
#include "sheetform/blueprint/exports.h"
#include "sheetform_api/parameter_schema.h"

namespace sheetform::server {
namespace {

std::vector<Profile> own_profiles(const std::string& json) {
  return json.empty() ? std::vector<Profile>{} : read_profiles(json);
}

/// Throws Error when there is no such parameter, with those that may be meant and all others.
void check_name(const std::string& name) {
  std::string like, all;
  for (const ExportParameter& p : export_parameters()) {
    if (p.name == name) return;
    if (api::may_mean(name, p.name, p.text)) like += (like.empty() ? "" : ", ") + p.name;
    all += (all.empty() ? "" : ", ") + p.name;
  }
  throw Error(ErrorCode::kInvalidParameter, "an export has no parameter \"" + name.substr(0, 60) + "\"",
              name.empty() ? "query" : name,
              (like.empty() ? "" : "you may mean " + like + "; ") + "there are " + all);
}

}  // namespace

void check_export(const ExportWish& wish) {
  for (const auto& [name, value] : wish.query) check_name(name);
  (void)read_export_request(wish.format, wish.query);
}

void check_profiles(const std::string& json) { (void)own_profiles(json); }

api::Json exports_document(const std::string& root, const std::string& profiles) {
  api::Json formats = api::Json::array(), parameters = api::Json::array();
  for (const ExportFormatText& f : export_formats())
    formats.push_back(
        {{"format", f.name}, {"title", f.text}, {"type", f.media_type}, {"href", root + "/" + f.name}});
  for (const ExportParameter& p : export_parameters(own_profiles(profiles))) {
    api::Json one{
        {"name", p.name}, {"default", p.otherwise}, {"text", p.text}, {"type", p.type}, {"group", p.group}};
    if (!p.unit.empty()) one["unit"] = p.unit;
    if (p.low) one["minimum"] = *p.low, one["maximum"] = *p.high;
    if (!p.choices.empty()) one["choices"] = p.choices;
    if (p.open) one["open"] = true;
    if (!p.formats.empty()) one["formats"] = p.formats;
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
