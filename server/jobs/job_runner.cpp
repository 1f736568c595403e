#include "server/jobs/job_runner.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <sys/statvfs.h>

#include <mutex>
#include <system_error>

#include "server/base/log.h"
#include "server/jobs/refusal.h"
#include "sheetform_api/process.h"

namespace sheetform::server {
namespace {

namespace fs = std::filesystem;

constexpr int kPersistEvery = 5;     // percent; finer progress is live only
constexpr int kHandOver = 10;        // seconds for a sweep whose time is up to hand over what it has
constexpr int kPublishAgain = 2000;  // milliseconds until a result that the store refused is tried again
constexpr int kPublishTries = 5;     // of a result that the disk refuses for another reason than lack of room

/// A folder that is gone when its owner is.
class AttemptFolder {
 public:
  AttemptFolder(const fs::path& work, const ClaimedJob& claimed)
      : path_(work / (claimed.job.id + "-" + std::to_string(claimed.job.attempt))) {
    fs::remove_all(path_);
    fs::create_directories(path_);
    folder_.reset(::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!folder_.valid()) throw std::system_error(errno, std::generic_category(), "folder of the attempt");
  }
  ~AttemptFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  AttemptFolder(const AttemptFolder&) = delete;
  AttemptFolder& operator=(const AttemptFolder&) = delete;
  int descriptor() const { return folder_.get(); }

 private:
  fs::path path_;
  Descriptor folder_;
};

/// What the child has said so far.
class Listener {
 public:
  Listener(const RunnerParts& parts, const ClaimedJob& claimed) : parts_(parts), claimed_(claimed) {}

  void operator()(const WorkerMessage& m) {
    if (m.problem) problem = m.problem;
    if (m.result) result = m.result;
    if (m.progress) take_progress(*m.progress);
  }

  std::optional<api::Problem> problem;
  std::optional<WorkerMessage::Result> result;
  std::string stage;

 private:
  void take_progress(const WorkerMessage::Progress& p) {
    // 100 is for the published result alone.
    const int percent = std::min(99, static_cast<int>(p.fraction * 100));
    const bool keep = p.stage != stage || percent >= kept_ + kPersistEvery;
    stage = p.stage;
    if (keep) keep_progress(percent, p);
    parts_.bus.progress(claimed_.job.id, {claimed_.job.attempt, percent, p.stage, p.message}, keep);
  }

  /// A full disk takes no progress; the job goes on all the same.
  void keep_progress(int percent, const WorkerMessage::Progress& p) {
    try {
      parts_.jobs.report_progress(claimed_, percent, p.stage, p.message);
      kept_ = percent;
    } catch (const StoreError& e) {
      log_warning("progress could not be stored", {{"job", claimed_.job.id}, {"reason", e.what()}});
    }
  }

  const RunnerParts& parts_;
  const ClaimedJob& claimed_;
  int kept_ = -1;
};

ChildTask task_for(const RunnerParts& parts, const ClaimedJob& claimed, int input, int folder,
                   const AttemptWishes& wishes) {
  const ServiceLimits& l = parts.limits;
  ChildTask task;
  task.program = parts.program;
  task.input = input;
  task.folder = folder;
  task.request.mode = claimed.job.process == api::kSweep ? WorkerMode::kSweep : WorkerMode::kDecompose;
  task.request.name = claimed.job.input_name;
  task.request.parameters = api::Json::parse(claimed.job.parameters);
  task.request.threads = l.threads;
  task.request.memory = l.job_memory;
  task.request.file_bytes = l.result_bytes;
  const int more = task.request.mode == WorkerMode::kSweep ? kHandOver : 0;
  if (more > 0) task.request.wall_seconds = l.job_seconds;
  task.request.cpu_seconds = (l.job_seconds + more) * l.threads + 10;
  task.request.sandbox = parts.sandbox;
  task.wall = std::chrono::seconds(l.job_seconds + more);
  task.stall = std::chrono::seconds(l.stall_seconds);
  task.stop = &wishes.stop;
  task.enough = &wishes.enough;
  return task;
}

/// Opens a file that the child wrote: a regular file with one name, no link.
Descriptor open_output(int folder, const std::string& name, std::uint64_t& bytes) {
  Descriptor file(::openat(folder, name.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK));
  struct stat status {};
  if (!file.valid() || ::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode) || status.st_nlink != 1)
    throw std::runtime_error("the job's process named a file that is not there: " + name);
  bytes = static_cast<std::uint64_t>(status.st_size);
  return file;
}

std::vector<StoredOutput> store_outputs(const RunnerParts& parts, int folder,
                                        const WorkerMessage::Result& result) {
  if (result.files.empty() || result.files.size() > static_cast<std::size_t>(parts.limits.result_files))
    throw std::runtime_error("the job's process named " + std::to_string(result.files.size()) + " files");
  std::vector<StoredOutput> stored;
  std::uint64_t total = 0;
  for (const WorkerFile& file : result.files) {
    for (const StoredOutput& other : stored)
      if (other.name == file.name)
        throw std::runtime_error("the job's process named a file twice: " + file.name);
    std::uint64_t bytes = 0;
    const Descriptor descriptor = open_output(folder, file.name, bytes);
    total += bytes;
    if (total > parts.limits.result_bytes)
      throw Refusal(api::ProblemType::kMeshLimitExceeded,
                    "the files of the result have more than " +
                        std::to_string(parts.limits.result_bytes >> 20) + " MiB",
                    "raise e_max or simplify the mesh, so that there are fewer strips", file.name);
    stored.push_back({file.name, file.media_type, parts.blobs.put_file(descriptor.get(), bytes),
                      static_cast<std::int64_t>(bytes)});
  }
  return stored;
}

std::string summary_of(const api::Json& report) {
  if (const auto curve = report.find("curve"); curve != report.end()) {
    const std::size_t missing = report.value("missing", api::Json::array()).size();
    const std::size_t all = curve->size() + missing;
    return "curve of " + (missing > 0 ? std::to_string(curve->size()) + " of " : std::string()) +
           std::to_string(all) + (all == 1 ? " tolerance" : " tolerances") +
           (report.value("stopped", false) ? ", stopped"
            : missing > 0                  ? ", time ran out"
                                           : "");
  }
  const int parts = report.value("patches", 0);
  return std::to_string(parts) + (parts == 1 ? " part" : " parts") +
         (report.value("e_max_met", true) ? "" : ", tolerance not met everywhere");
}

/// Content first, then the row that names it: a row without its content cannot exist. The log before it, too:
/// who is told of the success finds it.
void publish(const RunnerParts& parts, const ClaimedJob& claimed, int folder,
             const WorkerMessage::Result& result, const AttemptEnd& end) {
  const std::shared_lock lock(parts.content);
  const std::vector<StoredOutput> outputs = store_outputs(parts, folder, result);
  api::Json report = result.report;
  report["notes"] = result.notes;
  parts.jobs.end_attempt(claimed, end);
  parts.jobs.succeed(claimed, outputs, api::dump(report), summary_of(report));
}

/// When a job that waits again may run. One that was interrupted keeps its place in the line: it is not its
/// fault.
Microseconds next_start(const ClaimedJob& claimed, const Verdict& verdict) {
  return verdict.counted_as == Requeue::kInterruption ? claimed.job.run_after : now_us() + verdict.delay;
}

void act(const RunnerParts& parts, const ClaimedJob& claimed, const Verdict& verdict) {
  const std::string id = claimed.job.id;
  switch (verdict.action) {
    case Verdict::Action::kFail:
      parts.jobs.fail(claimed, api::dump(api::to_json(verdict.problem)), verdict.problem.detail,
                      verdict.counted_as);
      break;
    case Verdict::Action::kRequeue:
      parts.jobs.requeue(claimed, verdict.counted_as, next_start(claimed, verdict),
                         "waiting again: " + verdict.problem.detail);
      break;
    case Verdict::Action::kPublish:
    case Verdict::Action::kDrop:
      break;
  }
}

/// Why the store does not take the result now; nothing when it is published.
std::optional<StoreFailure> try_publish(const RunnerParts& parts, const ClaimedJob& claimed, int folder,
                                        const WorkerMessage::Result& result, const AttemptEnd& end) {
  try {
    publish(parts, claimed, folder, result, end);
    return std::nullopt;
  } catch (const StoreError& e) {
    if (e.kind() == StoreFailure::kRefused) throw;
    log_warning("a result waits for the store", {{"job", claimed.job.id}, {"reason", e.what()}});
    return e.kind();
  }
}

/// Publishes, or turns a failure to do so into another verdict. A result that has been computed is not thrown
/// away because the disk is full: it waits until there is room, or until the attempt is stopped. A disk that
/// refuses it again and again is another matter.
Verdict publish_or_judge(const RunnerParts& parts, const ClaimedJob& claimed, int folder,
                         const WorkerMessage::Result& result, const AttemptEnd& end, const StopSignal& stop,
                         Verdict verdict) {
  try {
    int refused = 0;
    while (const std::optional<StoreFailure> why = try_publish(parts, claimed, folder, result, end)) {
      if (why == StoreFailure::kDisk && ++refused == kPublishTries)
        return judge_disk(claimed.job, parts.limits, free_bytes(parts));
      pollfd stopped{stop.descriptor(), POLLIN, 0};
      if (::poll(&stopped, 1, kPublishAgain) == 0) continue;
      verdict.action = Verdict::Action::kRequeue;
      verdict.outcome = "io";
      verdict.problem.detail =
          why == StoreFailure::kFull ? "the server's disk is full" : "the store could not take the result";
      verdict.counted_as = Requeue::kInterruption;
      return verdict;
    }
  } catch (const Refusal& e) {
    verdict.action = Verdict::Action::kFail;
    verdict.outcome = "failed";
    verdict.problem = e.problem();
  } catch (const std::runtime_error& e) {
    verdict.action = Verdict::Action::kFail;
    verdict.outcome = "failed";
    verdict.problem.type = api::ProblemType::kAlgorithmFailed;
    verdict.problem.detail = e.what();
    verdict.problem.fix = "please report this mesh; other parameters may avoid it";
  }
  return verdict;
}

/// The mesh of a job; none when the attempt has ended for want of it. Only a mesh that is not there ends the
/// job, not a lack of descriptors.
Descriptor open_input(const RunnerParts& parts, const ClaimedJob& claimed) {
  Verdict verdict;
  try {
    Descriptor input = parts.inputs.open(claimed.job.input);
    if (input.valid()) return input;
    verdict.problem.type = api::ProblemType::kStorage;
    verdict.problem.detail = "the uploaded mesh is not in the store any more";
    verdict.problem.fix = "upload it again";
  } catch (const std::system_error& e) {
    log_error("a job could not be started", {{"job", claimed.job.id}, {"reason", e.what()}});
    verdict = judge_attempt(ChildReport{}, {}, false, StopReason::kNone, claimed.job, "", parts.limits,
                            free_bytes(parts));
  }
  act(parts, claimed, verdict);
  return {};
}

void log_end(const ClaimedJob& claimed, const Verdict& verdict, const ChildReport& report) {
  log_info("job attempt ended", {{"job", claimed.job.id},
                                 {"attempt", claimed.job.attempt},
                                 {"outcome", verdict.outcome},
                                 {"signal", report.signal},
                                 {"exit", report.exit_status},
                                 {"cpuMs", report.cpu_ms},
                                 {"peakRss", report.peak_rss}});
}

}  // namespace

std::uint64_t free_bytes(const RunnerParts& parts) {
  struct statvfs space {};
  if (::statvfs(parts.work.c_str(), &space) != 0) return 0;
  return static_cast<std::uint64_t>(space.f_bavail) * space.f_frsize;
}

void run_attempt(const RunnerParts& parts, const ClaimedJob& claimed, const AttemptWishes& wishes) {
  const Descriptor input = open_input(parts, claimed);
  if (!input.valid()) return;
  const AttemptFolder folder(parts.work, claimed);
  Listener listener(parts, claimed);
  ChildTask task = task_for(parts, claimed, input.get(), folder.descriptor(), wishes);
  task.on_message = [&listener](const WorkerMessage& m) { listener(m); };
  const ChildReport report = run_child(task);
  Verdict verdict = judge_attempt(report, listener.problem, listener.result.has_value(), wishes.reason,
                                  claimed.job, listener.stage, parts.limits, free_bytes(parts));
  const auto end = [&] {
    return AttemptEnd{verdict.outcome,    report.log,      report.signal,
                      report.exit_status, report.peak_rss, report.cpu_ms};
  };
  if (verdict.action == Verdict::Action::kPublish)
    verdict =
        publish_or_judge(parts, claimed, folder.descriptor(), *listener.result, end(), wishes.stop, verdict);
  if (verdict.action != Verdict::Action::kPublish) parts.jobs.end_attempt(claimed, end());
  act(parts, claimed, verdict);
  log_end(claimed, verdict, report);
}

}  // namespace sheetform::server
