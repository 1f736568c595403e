// Jobs and results as they travel: OGC statusInfo with our extensions.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sheetform_api/json_text.h"
#include "sheetform_api/problem.h"

namespace sheetform::api {

struct Link {
  std::string href, rel, type, title;
};
Json to_json(const Link& link);
Json to_json(const std::vector<Link>& links);

enum class JobState { kAccepted, kRunning, kSuccessful, kFailed, kDismissed };
const char* to_string(JobState state);
std::optional<JobState> job_state_from(std::string_view text);
inline bool is_terminal(JobState s) { return s != JobState::kAccepted && s != JobState::kRunning; }

/// What was understood of an uploaded mesh; lengths in units of the file.
struct MeshInfo {
  std::string name;  ///< display name of the upload, may be empty
  std::int64_t bytes = 0;
  std::string sha256;  ///< hexadecimal
  std::string format;  ///< obj, stl, ply, off
  std::int64_t vertices = 0, faces = 0;
  std::array<double, 3> box_min{}, box_max{};
  double scale = 1;                      ///< millimetres for one unit, as in force
  std::int64_t seams = 0, keep_out = 0;  ///< strokes of the guides that came with it
};
Json to_json(const MeshInfo& info);
MeshInfo mesh_info_from_json(const Json& value);

struct StatusInfo {
  std::string id, process;
  JobState state = JobState::kAccepted;
  std::string message, stage;
  int progress = 0;                       ///< percent
  std::int64_t created = 0, updated = 0;  ///< microseconds since 1970
  std::optional<std::int64_t> started, finished;
  int attempt = 0;
  std::optional<std::int64_t> queue_position;  ///< 1 is next
  std::string tag, reused_from;
  std::string mesh;                ///< JSON text of to_json(MeshInfo), or empty
  std::string parameters, report;  ///< JSON texts of objects, or empty
  std::optional<Problem> problem;
};
/// The JSON text of a job, on one line, with the links that fit its state. `root` is the path of the API, as
/// "/api/v1". What is kept as text goes in as it stands: lists of jobs are asked for all the time, and
/// reading it only to write it again took most of their time.
std::string status_text(const StatusInfo& status, const std::string& root);
/// The JSON text of an array; each item is a JSON text.
std::string array_text(const std::vector<std::string>& items);

struct ResultFile {
  std::string name, media_type, title;
  std::int64_t bytes = 0;
  std::string sha256;  ///< hexadecimal
};
/// The results document: one member a file, in the order given.
OrderedJson results_document(const std::vector<ResultFile>& files, const std::string& job_path);

/// An OGC execute request after reading.
struct ExecuteRequest {
  std::string mesh_base64, mesh_name;
  Json parameters = Json::object();  ///< inputs other than mesh
  std::string tag;
};
/// Reads the JSON of an execute request. On failure returns false and fills `problem`.
bool read_execute_request(const Json& value, ExecuteRequest& request, Problem& problem);

}  // namespace sheetform::api
