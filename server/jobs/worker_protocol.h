// What the server and a job's child process say to each other. The child is not trusted: every message is
// checked.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sheetform_api/problem.h"

namespace sheetform::server {

// Descriptors of the child. 0 reads nothing, 1 and 2 go to the log of the attempt.
inline constexpr int kInputDescriptor = 3;  ///< the mesh, read-only
inline constexpr int kFolderDescriptor =
    4;  ///< the only folder (kExport: file) that the child may write into
inline constexpr int kStatusDescriptor = 5;   ///< lines of JSON from the child
inline constexpr int kRequestDescriptor = 6;  ///< one JSON text for the child

inline constexpr std::size_t kStatusLineBytes = 64 * 1024;

enum class WorkerMode { kDecompose, kInspect, kProbe, kExport, kSweep };

struct WorkerRequest {
  WorkerMode mode = WorkerMode::kDecompose;
  std::string name;  ///< display name of the mesh
  api::Json parameters = api::Json::object();
  int threads = 1;
  std::uint64_t memory = 0, file_bytes = 0;
  int cpu_seconds = 0;
  int wall_seconds = 0;  ///< after which a sweep ends with what it has; 0: none
  bool sandbox = true;
  int parent = 0;  ///< the process that the child must not outlive; 0: whichever started it
};
std::string to_text(const WorkerRequest& request);
/// Throws nlohmann's exceptions on anything else than to_text's answer.
WorkerRequest worker_request_from(const std::string& text);

struct WorkerFile {
  std::string name, media_type;
};

/// One line from the child; exactly one member is set.
struct WorkerMessage {
  struct Progress {
    double fraction = 0;
    std::string stage, message;
  };
  struct Result {
    std::vector<WorkerFile> files;
    api::Json report, notes;
  };
  std::optional<Progress> progress;
  std::optional<api::Problem> problem;
  std::optional<Result> result;
  std::optional<WorkerFile> exported;  ///< answer of kExport: what the file is
  api::Json mesh;                      ///< answer of kInspect
  api::Json probe;                     ///< answer of kProbe
};
std::string to_line(const WorkerMessage& message);
/// None when the line is no such message: wrong shape, strange names, numbers out of range.
std::optional<WorkerMessage> message_from_line(std::string_view line);

/// Names of files that a result may hold: lower-case letters, digits, dot, dash, underscore; no leading dot.
bool is_output_name(std::string_view name);

}  // namespace sheetform::server
