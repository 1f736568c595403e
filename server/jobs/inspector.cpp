#include "server/jobs/inspector.h"

#include "server/mapping/errors.h"

namespace sheetform::server {
namespace {

api::Problem problem_of(const ChildReport& report, const std::optional<api::Problem>& told) {
  using T = api::ProblemType;
  constexpr const char* kOther = "simplify the mesh or store it in another format";
  if (told) return *told;
  if (report.ending == ChildEnding::kTimedOut || report.ending == ChildEnding::kStalled)
    return make_problem(T::kUnreadableMesh, "reading the mesh took too long", kOther);
  if (report.ending == ChildEnding::kExited && report.exit_status == kExitMemory)
    return make_problem(T::kMemoryLimit, "reading the mesh needs too much memory", kOther);
  if (report.ending == ChildEnding::kNotStarted)
    return make_problem(T::kInternal, "the mesh could not be looked at");
  return make_problem(T::kUnreadableMesh, "the program that read the mesh died", kOther);
}

}  // namespace

Inspection Inspector::inspect(int fd, const std::string& name, const api::Json& parameters) {
  {
    std::unique_lock lock(mutex_);
    ended_.wait(lock, [this] { return free_ > 0; });
    --free_;
  }
  Inspection answer;
  std::optional<api::Problem> told;
  ChildTask task;
  task.program = program_;
  task.nursery = nursery_;
  task.input = fd;
  task.request.mode = WorkerMode::kInspect;
  task.request.name = name;
  task.request.parameters = parameters;
  task.request.memory = limits_.job_memory;
  task.request.file_bytes = 1;
  task.request.cpu_seconds = limits_.inspect_seconds;
  task.request.sandbox = sandbox_;
  task.wall = task.stall = std::chrono::seconds(limits_.inspect_seconds);
  task.on_message = [&](const WorkerMessage& m) {
    if (m.problem) told = m.problem;
    if (!m.mesh.is_null()) answer.mesh = m.mesh;
  };
  const ChildReport report = run_child(task);
  {
    const std::lock_guard lock(mutex_);
    ++free_;
    ended_.notify_one();
  }
  if (report.ending != ChildEnding::kExited || report.exit_status != kExitOk || answer.mesh.is_null()) {
    answer.mesh = nullptr;
    answer.problem = problem_of(report, told);
  }
  return answer;
}

}  // namespace sheetform::server
