#include "sheetform_api/job.h"

#include <cmath>

#include "sheetform_api/process.h"

namespace sheetform::api {
namespace {

constexpr const char* kResultsRel = "http://www.opengis.net/def/rel/ogc/1.0/results";
constexpr const char* kExceptionsRel = "http://www.opengis.net/def/rel/ogc/1.0/exceptions";
constexpr std::array<const char*, 5> kStates{"accepted", "running", "successful", "failed", "dismissed"};

double extent(const MeshInfo& m, std::size_t axis) { return m.box_max[axis] - m.box_min[axis]; }

std::vector<Link> links_of(const StatusInfo& s, const std::string& root) {
  const std::string self = root + "/jobs/" + s.id;
  std::vector<Link> links{{self, "self", "application/json", "This job"},
                          {self, "monitor", "application/json", "State and progress"},
                          {root + "/jobs", "up", "application/json", "All jobs"},
                          {self + "/events", "events", "text/event-stream", "Live progress"},
                          {self + "/input", "input", "application/octet-stream", "The uploaded mesh"}};
  if (s.mesh.find("\"guides\":") != std::string::npos)  // a member: inside of a text the quotes are escaped
    links.push_back({self + "/guides", "guides", "application/json", "What was drawn on the mesh"});
  if (s.state == JobState::kSuccessful) {
    links.push_back({self + "/results", kResultsRel, "application/json", "The files of the result"});
    links.push_back({self + "/results?f=zip", "enclosure", "application/zip", "All files in one archive"});
    if (s.process != kSweep)  // its points have them
      links.push_back(
          {self + "/exports", "exports", "application/json", "Files for other machines and sheets"});
  }
  if (s.state == JobState::kFailed)
    links.push_back({self + "/results", kExceptionsRel, "application/problem+json", "What went wrong"});
  if (s.attempt > 0) links.push_back({self + "/log", "log", "text/plain", "Log of the job"});
  return links;
}

void put(Json& object, const char* name, const std::string& text) {
  if (!text.empty()) object[name] = text;
}

void append_member(std::string& object, const char* name, const std::string& text) {
  if (!text.empty()) object.append(",\"").append(name).append("\":").append(text);
}

bool refuse(Problem& problem, ProblemType type, std::string detail, std::string where, std::string fix) {
  problem.type = type;
  problem.detail = std::move(detail);
  problem.where = std::move(where);
  problem.fix = std::move(fix);
  return false;
}

bool malformed(Problem& problem, std::string detail, std::string where) {
  return refuse(problem, ProblemType::kMalformedRequest, std::move(detail), std::move(where),
                "see the schema Execute in /api/v1/api");
}

bool read_mesh_object(const Json& mesh, ExecuteRequest& request, Problem& problem) {
  if (mesh.contains("href"))
    return refuse(problem, ProblemType::kRemoteInputDisabled, "inputs.mesh names an address",
                  "inputs.mesh.href", "send the mesh itself in inputs.mesh.value, in base64");
  if (!mesh.contains("value") || !mesh["value"].is_string())
    return malformed(problem, "inputs.mesh has no text `value`", "inputs.mesh");
  request.mesh_base64 = mesh["value"].get<std::string>();
  if (mesh.contains("filename") && mesh["filename"].is_string()) request.mesh_name = mesh["filename"];
  return true;
}

bool read_mesh_input(const Json& inputs, ExecuteRequest& request, Problem& problem) {
  const auto mesh = inputs.find("mesh");
  if (mesh == inputs.end()) return malformed(problem, "inputs has no mesh", "inputs");
  if (mesh->is_object()) return read_mesh_object(*mesh, request, problem);
  if (!mesh->is_string())
    return malformed(problem, "inputs.mesh is neither a text nor an object", "inputs.mesh");
  request.mesh_base64 = mesh->get<std::string>();
  return true;
}

/// What is asked for and not done would be an answer that nobody wanted.
bool read_wishes(const Json& value, Problem& problem) {
  if (value.contains("response") && value["response"] != "document")
    return refuse(problem, ProblemType::kMalformedRequest, "response can only be document", "response",
                  "leave it out; the results are a document with the address of each file");
  if (!value.contains("outputs")) return true;
  if (!value["outputs"].is_object()) return malformed(problem, "outputs is not an object", "outputs");
  for (const auto& [name, wish] : value["outputs"].items()) {
    if (output_title(name).empty())
      return refuse(problem, ProblemType::kMalformedRequest, "there is no output " + name.substr(0, 60),
                    "outputs", "see /api/v1/processes for the outputs, or leave outputs out");
    if (!wish.is_object() || wish.value("transmissionMode", Json("reference")) != "reference")
      return refuse(problem, ProblemType::kMalformedRequest, "outputs come as references only",
                    "outputs." + name.substr(0, 60), "leave outputs out, or give transmissionMode reference");
  }
  return true;
}

}  // namespace

Json to_json(const Link& link) {
  Json object{{"href", link.href}, {"rel", link.rel}};
  put(object, "type", link.type);
  put(object, "title", link.title);
  return object;
}

Json to_json(const std::vector<Link>& links) {
  Json list = Json::array();
  for (const Link& link : links) list.push_back(to_json(link));
  return list;
}

const char* to_string(JobState state) { return kStates[static_cast<std::size_t>(state)]; }

std::optional<JobState> job_state_from(std::string_view text) {
  for (std::size_t i = 0; i < kStates.size(); ++i)
    if (text == kStates[i]) return static_cast<JobState>(i);
  return std::nullopt;
}

Json to_json(const MeshInfo& m) {
  const std::array<double, 3> size{extent(m, 0), extent(m, 1), extent(m, 2)};
  Json object{{"bytes", m.bytes},
              {"sha256", m.sha256},
              {"format", m.format},
              {"vertices", m.vertices},
              {"faces", m.faces},
              {"bbox", {{"min", m.box_min}, {"max", m.box_max}}},
              {"bboxDiagonal", std::hypot(size[0], size[1], size[2])},
              {"sizeMm", {size[0] * m.scale, size[1] * m.scale, size[2] * m.scale}},
              {"unitAssumed", "1 unit = " + number_text(m.scale) + " mm"},
              {"scale", m.scale}};
  put(object, "name", m.name);
  if (m.seams + m.keep_out > 0) object["guides"] = {{"seams", m.seams}, {"keepOut", m.keep_out}};
  return object;
}

MeshInfo mesh_info_from_json(const Json& value) {
  MeshInfo m;
  m.name = value.value("name", "");
  m.bytes = value.value("bytes", std::int64_t{0});
  m.sha256 = value.value("sha256", "");
  m.format = value.value("format", "");
  m.vertices = value.value("vertices", std::int64_t{0});
  m.faces = value.value("faces", std::int64_t{0});
  m.scale = value.value("scale", 1.0);
  if (value.contains("guides")) {
    m.seams = value["guides"].value("seams", std::int64_t{0});
    m.keep_out = value["guides"].value("keepOut", std::int64_t{0});
  }
  if (value.contains("bbox")) {
    m.box_min = value["bbox"].at("min").get<std::array<double, 3>>();
    m.box_max = value["bbox"].at("max").get<std::array<double, 3>>();
  }
  return m;
}

std::string status_text(const StatusInfo& s, const std::string& root) {
  Json object{{"jobID", s.id},
              {"id", s.id},
              {"processID", s.process},
              {"type", "process"},
              {"processingEntityType", "ogc-api-processes"},
              {"status", to_string(s.state)},
              {"progress", s.progress},
              {"created", rfc3339(s.created)},
              {"updated", rfc3339(s.updated)},
              {"attempt", s.attempt}};
  put(object, "message", s.message);
  put(object, "stage", s.stage);
  put(object, "tag", s.tag);
  put(object, "reusedFrom", s.reused_from);
  if (s.started) object["started"] = rfc3339(*s.started);
  if (s.finished) object["finished"] = rfc3339(*s.finished);
  if (s.queue_position) object["queuePosition"] = *s.queue_position;
  std::string text = dump(object);
  text.pop_back();
  append_member(text, "links", dump(to_json(links_of(s, root))));
  if (!s.mesh.empty()) append_member(text, "inputs", "{\"mesh\":" + s.mesh + "}");
  append_member(text, "parameters", s.parameters);
  append_member(text, "report", s.report);
  if (s.problem) append_member(text, "exception", dump(to_json(*s.problem)));
  return text += '}';
}

std::string array_text(const std::vector<std::string>& items) {
  std::string text = "[";
  for (const std::string& item : items) text.append(text.size() > 1 ? "," : "").append(item);
  return text += ']';
}

OrderedJson results_document(const std::vector<ResultFile>& files, const std::string& job_path) {
  OrderedJson object = OrderedJson::object();
  for (const ResultFile& file : files) {
    OrderedJson entry{{"href", job_path + "/results/" + file.name}, {"type", file.media_type}};
    if (!file.title.empty()) entry["title"] = file.title;
    entry["length"] = file.bytes;
    entry["sha256"] = file.sha256;
    object[file.name] = std::move(entry);
  }
  return object;
}

bool read_execute_request(const Json& value, ExecuteRequest& request, Problem& problem) {
  if (!value.is_object()) return malformed(problem, "the body is not a JSON object", "");
  for (const auto& [name, member] : value.items()) {
    if (name != "inputs" && name != "outputs" && name != "response" && name != "tag")
      return malformed(problem, "unknown member " + name.substr(0, 60), name.substr(0, 60));
  }
  if (!value.contains("inputs") || !value["inputs"].is_object())
    return malformed(problem, "there is no object `inputs`", "inputs");
  if (value.contains("tag") && !value["tag"].is_string())
    return malformed(problem, "tag is not a text", "tag");
  if (!read_wishes(value, problem)) return false;
  request.tag = value.value("tag", "");
  if (!read_mesh_input(value["inputs"], request, problem)) return false;
  request.parameters = value["inputs"];
  request.parameters.erase("mesh");
  return true;
}

}  // namespace sheetform::api
