#include "server/jobs/worker_protocol.h"

#include <array>
#include <cmath>

namespace sheetform::server {
namespace {

using api::Json;

constexpr std::array<const char*, 5> kModes{"decompose", "inspect", "probe", "export", "sweep"};
constexpr std::size_t kTextBytes = 400;
constexpr std::size_t kNameBytes = 64;

std::string text_member(const Json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_string() ? found->get<std::string>().substr(0, kTextBytes)
                                                     : std::string();
}

std::optional<WorkerMessage::Progress> progress_from(const Json& value) {
  if (!value.is_object() || !value.contains("fraction") || !value["fraction"].is_number())
    return std::nullopt;
  const double fraction = value["fraction"].get<double>();
  if (!(fraction >= 0 && fraction <= 1)) return std::nullopt;
  return WorkerMessage::Progress{fraction, text_member(value, "stage"), text_member(value, "message")};
}

bool is_media_type(std::string_view text) {
  if (text.empty() || text.size() > kNameBytes || text.find('/') == std::string_view::npos) return false;
  for (const char c : text)
    if (!std::isalnum(static_cast<unsigned char>(c)) &&
        std::string_view("/+-.").find(c) == std::string_view::npos)
      return false;
  return true;
}

std::optional<WorkerMessage::Result> result_from(const Json& value) {
  if (!value.is_object() || !value.contains("files") || !value["files"].is_array()) return std::nullopt;
  WorkerMessage::Result result;
  for (const Json& file : value["files"]) {
    if (!file.is_object()) return std::nullopt;
    WorkerFile entry{text_member(file, "name"), text_member(file, "media")};
    if (!is_output_name(entry.name) || !is_media_type(entry.media_type)) return std::nullopt;
    result.files.push_back(std::move(entry));
  }
  result.report = value.value("report", Json::object());
  result.notes = value.value("notes", Json::array());
  if (!result.report.is_object() || !result.notes.is_array()) return std::nullopt;
  return result;
}

/// Made of labels, which have capitals.
bool is_export_name(std::string_view name) {
  if (name.empty() || name.size() > kNameBytes || name[0] == '.' || name[0] == '-') return false;
  for (const char c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '-' && c != '_') return false;
  return true;
}

std::optional<WorkerFile> exported_from(const Json& value) {
  if (!value.is_object()) return std::nullopt;
  WorkerFile file{text_member(value, "name"), text_member(value, "media")};
  if (!is_export_name(file.name) || !is_media_type(file.media_type)) return std::nullopt;
  return file;
}

Json to_json(const WorkerMessage::Result& result) {
  Json files = Json::array();
  for (const WorkerFile& f : result.files) files.push_back({{"name", f.name}, {"media", f.media_type}});
  return {{"files", files}, {"report", result.report}, {"notes", result.notes}};
}

}  // namespace

std::string to_text(const WorkerRequest& r) {
  return api::dump(Json{{"mode", kModes[static_cast<std::size_t>(r.mode)]},
                        {"name", r.name},
                        {"parameters", r.parameters},
                        {"threads", r.threads},
                        {"memory", r.memory},
                        {"fileBytes", r.file_bytes},
                        {"cpuSeconds", r.cpu_seconds},
                        {"wallSeconds", r.wall_seconds},
                        {"sandbox", r.sandbox},
                        {"parent", r.parent}});
}

WorkerRequest worker_request_from(const std::string& text) {
  const Json value = Json::parse(text);
  WorkerRequest r;
  const std::string mode = value.at("mode");
  for (std::size_t i = 0; i < kModes.size(); ++i)
    if (mode == kModes[i]) r.mode = static_cast<WorkerMode>(i);
  r.name = value.at("name");
  r.parameters = value.at("parameters");
  r.threads = value.at("threads");
  r.memory = value.at("memory");
  r.file_bytes = value.at("fileBytes");
  r.cpu_seconds = value.at("cpuSeconds");
  r.wall_seconds = value.value("wallSeconds", 0);
  r.sandbox = value.at("sandbox");
  r.parent = value.value("parent", 0);
  return r;
}

std::string to_line(const WorkerMessage& m) {
  Json line = Json::object();
  if (m.progress)
    line["progress"] = {{"fraction", m.progress->fraction},
                        {"stage", m.progress->stage},
                        {"message", m.progress->message.substr(0, kTextBytes)}};
  if (m.problem) line["problem"] = api::to_json(*m.problem);
  if (m.result) line["result"] = to_json(*m.result);
  if (m.exported) line["exported"] = {{"name", m.exported->name}, {"media", m.exported->media_type}};
  if (!m.mesh.is_null()) line["mesh"] = m.mesh;
  if (!m.probe.is_null()) line["probe"] = m.probe;
  return api::dump(line) + "\n";
}

std::optional<WorkerMessage> message_from_line(std::string_view line) {
  Json value;
  std::string why;
  if (line.size() > kStatusLineBytes || !api::parse_json(line, value, why) || !value.is_object() ||
      value.size() != 1)
    return std::nullopt;
  WorkerMessage m;
  const auto member = value.begin();
  const std::string& name = member.key();
  if (name == "progress") m.progress = progress_from(*member);
  if (name == "problem" && member->is_object()) m.problem = api::problem_from_json(*member);
  if (name == "result") m.result = result_from(*member);
  if (name == "exported") m.exported = exported_from(*member);
  if (name == "mesh" && member->is_object()) m.mesh = *member;
  if (name == "probe" && member->is_object()) m.probe = *member;
  const bool any =
      m.progress || m.problem || m.result || m.exported || !m.mesh.is_null() || !m.probe.is_null();
  return any ? std::optional(std::move(m)) : std::nullopt;
}

bool is_output_name(std::string_view name) {
  if (name.empty() || name.size() > kNameBytes || name[0] == '.' || name[0] == '-') return false;
  for (const char c : name)
    if (!(c >= 'a' && c <= 'z') && !(c >= '0' && c <= '9') && c != '.' && c != '-' && c != '_') return false;
  return true;
}

}  // namespace sheetform::server
