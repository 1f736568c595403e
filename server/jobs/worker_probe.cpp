#include "server/jobs/worker_probe.h"

#include <fcntl.h>

#include <filesystem>

#include "server/base/identity.h"
#include "server/jobs/child_process.h"

namespace sheetform::server {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kPatience{20};

bool whole(const api::Json& answer) {
  if (!answer.is_object() || answer.empty()) return false;
  for (const auto& [name, refused] : answer.items())
    if (refused != api::Json(true)) return false;
  return true;
}

}  // namespace

api::Json probe_worker(bool sandbox) {
  const fs::path folder = fs::temp_directory_path() / ("sheetform-probe-" + to_hex(random_bytes(8)));
  fs::create_directory(folder);
  const Descriptor descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  api::Json answer = api::Json::object();
  ChildTask task;
  task.folder = descriptor.get();
  task.request.mode = WorkerMode::kProbe;
  task.request.sandbox = sandbox;
  task.request.file_bytes = 1 << 20;
  task.wall = task.stall = kPatience;
  task.on_message = [&](const WorkerMessage& m) {
    if (!m.probe.is_null()) answer = m.probe;
  };
  run_child(task);
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  const bool good = whole(answer);
  answer["whole"] = good;
  return answer;
}

}  // namespace sheetform::server
