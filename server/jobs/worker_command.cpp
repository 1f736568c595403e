#include "server/jobs/worker_command.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <new>

#include "server/base/descriptor.h"
#include "server/base/file_output.h"
#include "server/jobs/sandbox.h"
#include "server/jobs/worker_protocol.h"
#include "server/mapping/errors.h"
#include "server/mapping/exports.h"
#include "server/mapping/run.h"
#include "sheetform_api/parameter_schema.h"
#include "sheetform_api/process.h"

namespace sheetform::server {
namespace {

std::atomic<bool> stop_requested{false};
void request_stop(int) { stop_requested = true; }

// What a sweep has found is enough: it stops now, or with its first point.
std::atomic<bool> enough{false}, point_found{false};
void request_finish(int) {
  enough = true;
  if (point_found) stop_requested = true;
}

/// A failure of the disk below the child, told apart from all others by its exit status.
struct IoFailure {
  std::string what;
};

void send(const WorkerMessage& message) {
  if (!write_whole(kStatusDescriptor, to_line(message))) ::_exit(kExitOurs);  // nobody listens any more
}

std::string read_all(int fd) {
  std::string text;
  char buffer[4096];
  for (ssize_t got; (got = ::read(fd, buffer, sizeof buffer)) > 0;)
    text.append(buffer, static_cast<std::size_t>(got));
  return text;
}

/// The mesh's bytes, mapped; a file that shrinks meanwhile is not possible (nobody writes to kept inputs).
class MappedInput {
 public:
  explicit MappedInput(int fd) {
    struct stat status {};
    if (::fstat(fd, &status) != 0) throw IoFailure{"the input cannot be read"};
    size_ = static_cast<std::size_t>(status.st_size);
    if (size_ == 0) return;
    data_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, fd, 0);
    if (data_ == MAP_FAILED) throw std::bad_alloc();
  }
  ~MappedInput() {
    if (size_ > 0) ::munmap(data_, size_);
  }
  MappedInput(const MappedInput&) = delete;
  MappedInput& operator=(const MappedInput&) = delete;
  std::string_view bytes() const { return {static_cast<const char*>(data_), size_}; }

 private:
  void* data_ = nullptr;
  std::size_t size_ = 0;
};

/// A file that may not become so large: no fault of the disk, so another try would not help.
[[noreturn]] void refuse_size(const OutputFile& file) {
  struct rlimit limit {};
  ::getrlimit(RLIMIT_FSIZE, &limit);
  throw Error(ErrorCode::kLimitExceeded,
              "a file of the result would have " + std::to_string(file.content.size()) +
                  " bytes, the limit is " + std::to_string(limit.rlim_cur) + " bytes",
              file.name, "raise e_max or simplify the mesh, so that there are fewer strips");
}

void write_all(int fd, const OutputFile& file) {
  if (write_whole(fd, file.content)) return;
  if (errno == EFBIG) refuse_size(file);
  throw IoFailure{"cannot write " + file.name + ": " + std::strerror(errno)};
}

void write_below(const OutputFile& file) {
  const Descriptor d(::openat(kFolderDescriptor, file.name.c_str(),
                              O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (!d.valid()) throw IoFailure{"cannot write " + file.name + ": " + std::strerror(errno)};
  write_all(d.get(), file);
}

/// Progress as messages, at most twenty a second, but always when the stage changes.
class ProgressSender {
 public:
  void operator()(Stage stage, double fraction, const std::string& message) {
    const auto now = std::chrono::steady_clock::now();
    if (stage == stage_ && now - last_ < std::chrono::milliseconds(50)) return;
    stage_ = stage;
    last_ = now;
    WorkerMessage m;
    m.progress = WorkerMessage::Progress{std::min(1.0, std::max(0.0, fraction)), to_string(stage), message};
    send(m);
  }

 private:
  std::optional<Stage> stage_;
  std::chrono::steady_clock::time_point last_{};
};

RunContext context_of(const WorkerRequest& request) {
  RunContext context;
  context.cancelled = &stop_requested;
  context.threads = request.threads;
  context.progress = ProgressSender();
  return context;
}

void hand_over(const OutputFile& file, WorkerMessage::Result& result) {
  write_below(file);
  result.files.push_back({file.name, file.media_type});
}

void send_result(WorkerMessage::Result result) {
  WorkerMessage m;
  m.result = std::move(result);
  send(m);
}

void decompose_job(const WorkerRequest& request) {
  const MappedInput input(kInputDescriptor);
  RunContext context = context_of(request);
  const Outcome outcome = run_decomposition(input.bytes(), request.name, request.parameters, context);
  WorkerMessage::Result result;
  for (const OutputFile& file : outcome.files) hand_over(file, result);
  result.report = outcome.report;
  result.notes = outcome.notes;
  send_result(std::move(result));
}

/// The files of each point as soon as it is found, under names that begin with it; then the curve. When the
/// time is up, or when that is enough, what was found until then is the result.
void sweep_job(const WorkerRequest& request) {
  const MappedInput input(kInputDescriptor);
  RunContext context = context_of(request);
  if (request.wall_seconds > 0)
    context.deadline = std::chrono::steady_clock::now() + std::chrono::seconds(request.wall_seconds);
  WorkerMessage::Result result;
  const SweepOutcome outcome = run_sweep(
      input.bytes(), request.name, request.parameters,
      request.parameters.at(api::kTolerance).get<std::vector<double>>(), context,
      [&](SweepStep step) {
        for (OutputFile& file : step.outcome.files)
          hand_over({api::point_file(step.point, file.name), file.media_type, std::move(file.content)},
                    result);
        point_found = true;
        if (enough) stop_requested = true;
      },
      &enough);
  context.deadline.reset();
  context.cancelled = nullptr;
  context.report(Stage::kWrite, 0);
  for (const OutputFile& file : outcome.files) hand_over(file, result);
  result.report = {{"curve", outcome.curve}};
  if (!outcome.missing.empty()) result.report["missing"] = outcome.missing;
  if (outcome.stopped) result.report["stopped"] = true;
  result.notes = outcome.notes;
  send_result(std::move(result));
}

void inspect_job(const WorkerRequest& request) {
  const MappedInput input(kInputDescriptor);
  WorkerMessage m;
  m.mesh = api::to_json(inspect_mesh(input.bytes(), request.name, request.parameters));
  send(m);
}

/// The input holds ruled.obj and layout.json, one after the other.
void export_job(const WorkerRequest& request) {
  const MappedInput input(kInputDescriptor);
  const std::size_t split =
      std::min(request.parameters.at("objBytes").get<std::size_t>(), input.bytes().size());
  const OutputFile file =
      run_export(input.bytes().substr(0, split), input.bytes().substr(split), request.parameters);
  write_all(kFolderDescriptor, file);
  WorkerMessage m;
  m.exported = WorkerFile{file.name, file.media_type};
  send(m);
}

void probe_job(const SandboxState& state) {
  WorkerMessage m;
  m.probe = probe_sandbox(kFolderDescriptor);
  m.probe["landlock"] = state.landlock;
  m.probe["seccomp"] = state.seccomp;
  send(m);
}

void run_request(const WorkerRequest& request) {
  lower_process(limits_of(request));
  const SandboxState state = request.sandbox ? close_in(kFolderDescriptor) : SandboxState{};
  switch (request.mode) {
    case WorkerMode::kDecompose:
      return decompose_job(request);
    case WorkerMode::kSweep:
      return sweep_job(request);
    case WorkerMode::kInspect:
      return inspect_job(request);
    case WorkerMode::kExport:
      return export_job(request);
    case WorkerMode::kProbe:
      return probe_job(state);
  }
}

int tell(const api::Problem& problem, int status) {
  WorkerMessage m;
  m.problem = problem;
  send(m);
  return status;
}

int guarded_worker() {
  try {
    run_request(worker_request_from(read_all(kRequestDescriptor)));
    return kExitOk;
  } catch (const Error& e) {
    const int status = exit_status(e.code());
    return tell(to_problem(e), status == kExitUsage ? kExitInput : status);
  } catch (const std::bad_alloc&) {
    return kExitMemory;
  } catch (const IoFailure& e) {
    std::fprintf(stderr, "%s\n", e.what.c_str());
    return kExitIo;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return kExitOurs;
  }
}

}  // namespace

int worker_command() {
  if (::fcntl(kRequestDescriptor, F_GETFD) < 0 || ::fcntl(kStatusDescriptor, F_GETFD) < 0)
    throw Error(ErrorCode::kInvalidParameter, "`worker` is started by the server only", "command line",
                "use `sheetform decompose`");
  std::signal(SIGTERM, request_stop);
  std::signal(SIGUSR1, request_finish);
  std::signal(SIGPIPE, SIG_IGN);
  const int status = guarded_worker();
  std::fflush(nullptr);
  ::_exit(status);  // nothing is left to be done; the kernel frees faster than destructors
}

}  // namespace sheetform::server
