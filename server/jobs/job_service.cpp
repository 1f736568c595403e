#include "server/jobs/job_service.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/statvfs.h>

#include <system_error>
#include <thread>

#include "server/base/file_output.h"
#include "server/base/identity.h"
#include "server/base/log.h"
#include "server/base/version.h"
#include "sheetform_api/parameter_schema.h"

namespace sheetform::server {
namespace {

namespace fs = std::filesystem;
using api::ProblemType;

constexpr auto kLockPatience = std::chrono::seconds(3);

/// False when somebody else has it for longer. A server that was killed while it began a job leaves a child
/// that has the lock, too, until it has become the job's program: on a busy machine that takes a moment.
bool wait_for_lock(int fd) {
  const auto until = SteadyClock::now() + kLockPatience;
  while (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
    if (SteadyClock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

/// One server a data folder: the lock is held until the process ends, however it ends.
Descriptor lock_folder(const fs::path& data) {
  try {
    make_folder_synced(data);
  } catch (const SyncError& e) {
    end_after_storage_failure(e.what());
  }
  Descriptor lock(::open((data / ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
  if (!lock.valid())
    throw std::system_error(errno, std::generic_category(), "the data folder " + data.string());
  if (!wait_for_lock(lock.get()))
    throw Refusal(ProblemType::kConflict, "another sheetform server uses the data folder " + data.string(),
                  "stop it, or choose another folder with --data");
  return lock;
}

fs::path fresh_folder(const fs::path& path) {
  std::error_code ignored;
  fs::remove_all(path, ignored);
  fs::create_directories(path);
  return path;
}

RunnerParts parts_of(JobStore& jobs, BlobStore& blobs, InputStore& inputs, EventBus& bus,
                     const ServiceOptions& options, std::shared_mutex& content) {
  return {jobs,    blobs,           inputs,        bus, options.limits, fresh_folder(options.data / "work"),
          content, options.sandbox, options.worker};
}

int inspections_at_once() { return std::max(2, static_cast<int>(std::thread::hardware_concurrency())); }

/// Another program than our own may not have one.
std::unique_ptr<Nursery> nursery_of(const ServiceOptions& options) {
  return options.worker == kOwnProgram ? std::make_unique<Nursery>(options.worker) : nullptr;
}

/// Everything that decides the bytes of a result.
std::string reuse_key(const NewJob& job) {
  Sha256 hash;
  for (const std::string* part : {&job.process, &job.version, &job.parameters, &job.input}) {
    hash.add(std::to_string(part->size()) + ":");
    hash.add(*part);
  }
  return hash.finish();
}

std::string fingerprint_of(Upload& upload, const Submission& s) {
  return sha256(api::dump(s.parameters) + "\n" + s.tag + "\n" + upload.finish());
}

/// A key of an idempotent request that is being worked on.
class KeyInProgress {
 public:
  KeyInProgress(std::mutex& mutex, std::set<std::string>& keys, const Submission& s)
      : mutex_(mutex), keys_(keys) {
    if (s.idempotency_key.empty()) return;
    key_ = std::to_string(s.principal) + " " + s.route + " " + s.idempotency_key;
    const std::lock_guard lock(mutex_);
    if (!keys_.insert(key_).second) {
      key_.clear();
      throw Refusal(ProblemType::kIdempotencyInProgress,
                    "a request with this Idempotency-Key is still being worked on",
                    "wait a second and ask again", "Idempotency-Key");
    }
  }
  ~KeyInProgress() {
    if (key_.empty()) return;
    const std::lock_guard lock(mutex_);
    keys_.erase(key_);
  }
  KeyInProgress(const KeyInProgress&) = delete;
  KeyInProgress& operator=(const KeyInProgress&) = delete;

 private:
  std::mutex& mutex_;
  std::set<std::string>& keys_;
  std::string key_;
};

[[noreturn]] void refuse_full_disk() {
  throw Refusal(ProblemType::kDiskFull, "the server has too little free disk space for another job",
                "try again later, or remove old jobs");
}

api::Json parsed_or_null(const std::string& text) {
  return text.empty() ? api::Json() : api::Json::parse(text);
}

/// Text of a report without what only the curve needs. Throws Refusal when the sweep has no such point.
std::string report_of_point(const JobRecord& sweep, const std::string& point) {
  const api::Json report = parsed_or_null(sweep.report);
  for (api::Json entry : report.value("curve", api::Json::array())) {
    if (entry.value("point", "") != point) continue;
    entry.erase("point");
    return api::dump(entry);
  }
  throw Refusal(ProblemType::kNoSuchOutput, "the sweep has no point " + point.substr(0, 60),
                "see `curve` in its report for the points");
}

/// Whether a job with the same key may be answered with the result of this one: a sweep whose time ran out
/// may find more the next time.
bool complete(const JobRecord& job) {
  return job.process != api::kSweep || !parsed_or_null(job.report).contains("missing");
}

/// Its result is found again under a key of its own: but for the finest one, it need not be the one that a
/// job with that tolerance alone would have found.
NewJob point_of_sweep(const JobRecord& sweep, const std::string& point, Microseconds keep) {
  NewJob job;
  job.id = make_uuid();
  job.principal = sweep.principal;
  job.process = api::kDecompose;
  job.version = sweep.version;
  api::Json parameters = parsed_or_null(sweep.parameters);
  for (const double tolerance : parameters.at(api::kTolerance).get<std::vector<double>>())
    if (api::number_text(tolerance) == point) parameters[api::kTolerance] = tolerance;
  job.parameters = api::dump(parameters);
  job.tag = sweep.tag;
  job.input = sweep.input;
  job.input_name = sweep.input_name;
  job.input_info = sweep.input_info;
  job.reuse_key = sha256(reuse_key(job) + sweep.parameters);
  job.created = now_us();
  job.expires = job.created + keep;
  return job;
}

}  // namespace

Refusal::Refusal(ProblemType type, std::string detail, std::string fix, std::string where)
    : Refusal(make_problem(type, std::move(detail), std::move(fix), std::move(where))) {}

JobService::JobService(ServiceOptions options)
    : options_(std::move(options)),
      lock_(lock_folder(options_.data)),
      jobs_(options_.data / "sheetform.db"),
      blobs_(options_.data / "blobs.db"),
      inputs_(options_.data),
      nursery_(nursery_of(options_)),
      inspector_(options_.limits, inspections_at_once(), options_.sandbox, options_.worker, nursery_.get()),
      exporter_(options_.limits, blobs_, options_.sandbox, options_.worker),
      pool_(parts_of(jobs_, blobs_, inputs_, bus_, options_, content_)) {
  const int recovered = jobs_.recover();
  if (recovered > 0) log_info("jobs that were running wait again", {{"jobs", recovered}});
}

JobService::~JobService() { drain(std::chrono::seconds(0)); }

void JobService::start() { pool_.start(options_.limits.slots); }

void JobService::drain(std::chrono::seconds grace) {
  draining_ = true;
  pool_.drain(SteadyClock::now() + grace);
}

std::uint64_t JobService::free_bytes() const {
  struct statvfs space {};
  if (::statvfs(options_.data.c_str(), &space) != 0) return 0;
  return static_cast<std::uint64_t>(space.f_bavail) * space.f_frsize;
}

void JobService::check_admission(std::int64_t principal) const {
  const ServiceLimits& l = options_.limits;
  if (draining_)
    throw Refusal(ProblemType::kDraining, "the server is about to stop", "try again in a minute");
  if (free_bytes() < l.free_bytes) refuse_full_disk();
  if (jobs_.waiting(std::nullopt) >= l.queued_jobs || jobs_.waiting(principal) >= l.queued_jobs_each) {
    api::Problem p = make_problem(ProblemType::kQueueFull, "too many jobs are waiting", "try again later");
    p.limit = std::min(l.queued_jobs, l.queued_jobs_each);
    throw Refusal(p);
  }
}

std::unique_ptr<Upload> JobService::begin_upload() const { return std::make_unique<Upload>(inputs_.spool()); }

std::optional<Submitted> JobService::earlier(const Submission& s, const std::string& fingerprint) const {
  if (s.idempotency_key.empty()) return std::nullopt;
  const auto known = jobs_.find_idempotency(s.principal, s.route, s.idempotency_key);
  if (!known) return std::nullopt;
  if (known->fingerprint != fingerprint)
    throw Refusal(ProblemType::kIdempotencyMismatch,
                  "this Idempotency-Key came with another mesh or other parameters", "use a new key",
                  "Idempotency-Key");
  const std::optional<JobRecord> job = jobs_.find(known->job);
  if (!job) return std::nullopt;  // removed since; the request starts a new one
  return Submitted{*job, true};
}

Submitted JobService::submit(Upload& upload, const Submission& s) {
  const KeyInProgress key(keys_mutex_, keys_in_progress_, s);
  const std::string fingerprint = fingerprint_of(upload, s);
  if (const std::optional<Submitted> before = earlier(s, fingerprint)) return *before;
  const Inspection inspection = inspector_.inspect(upload.descriptor(), s.name, s.parameters);
  if (inspection.problem) throw Refusal(*inspection.problem);
  try {
    return accept(upload, s, fingerprint, inspection);
  } catch (const std::system_error& e) {
    if (e.code().value() == ENOSPC || e.code().value() == EDQUOT) refuse_full_disk();
    throw;
  } catch (const StoreError& e) {
    if (e.kind() == StoreFailure::kFull) refuse_full_disk();
    throw;
  }
}

NewJob JobService::new_job(Upload& upload, const Submission& s, const std::string& fingerprint,
                           const Inspection& inspection) const {
  NewJob job;
  job.id = make_uuid();
  job.principal = s.principal;
  job.process = s.process;
  job.version = kVersion;
  job.parameters = api::dump(s.parameters);
  job.tag = s.tag;
  job.input = upload.finish();
  job.input_bytes = static_cast<std::int64_t>(upload.bytes());
  job.input_name = s.name;
  api::Json info = inspection.mesh;
  info["sha256"] = to_hex(job.input);
  info["bytes"] = job.input_bytes;
  job.input_info = api::dump(info);
  job.reuse_key = reuse_key(job);
  job.created = now_us();
  job.expires = job.created + options_.limits.keep_results;
  job.idempotency_key = s.idempotency_key;
  job.route = s.route;
  job.fingerprint = fingerprint;
  return job;
}

Submitted JobService::accept(Upload& upload, const Submission& s, const std::string& fingerprint,
                             const Inspection& inspection) {
  const std::shared_lock lock(content_);
  inputs_.keep(upload);
  const NewJob job = new_job(upload, s, fingerprint, inspection);
  std::optional<JobRecord> accepted;
  if (!s.refresh)
    if (const std::optional<JobRecord> source = jobs_.find_reusable(s.principal, job.reuse_key))
      if (complete(*source)) accepted = jobs_.accept_reused(job, source->id);
  if (!accepted) accepted = jobs_.accept(job);
  bus_.publish(job.id);
  pool_.wake();
  return {*accepted, false};
}

Submitted JobService::open_point(const JobRecord& sweep, const std::string& point) {
  const ResultPart part{api::point_file(point, {}), report_of_point(sweep, point)};
  const NewJob job = point_of_sweep(sweep, point, options_.limits.keep_results);
  const std::shared_lock lock(content_);
  if (const std::optional<JobRecord> opened = jobs_.find_reusable(sweep.principal, job.reuse_key))
    return {*opened, true};
  const std::optional<JobRecord> accepted = jobs_.accept_reused(job, sweep.id, part);
  if (!accepted) throw Refusal(ProblemType::kNoSuchJob, "the sweep was removed meanwhile");
  bus_.publish(job.id);
  return {*accepted, false};
}

std::shared_ptr<const ExportedFile> JobService::export_result(const JobRecord& job, const ExportWish& wish) {
  return exporter_.make(jobs_.outputs(job.seq), to_json(wish, options_.profiles));
}

JobRecord JobService::job(const std::string& id, std::optional<std::int64_t> principal) const {
  std::optional<JobRecord> job;
  if (is_uuid(id)) job = jobs_.find(id);
  if (!job || (principal && job->principal != *principal))
    throw Refusal(ProblemType::kNoSuchJob, "there is no job " + id.substr(0, 60),
                  "see /api/v1/jobs; old jobs are removed after a while");
  return *job;
}

api::StatusInfo JobService::status(const JobRecord& job) const {
  api::StatusInfo s;
  s.id = job.id;
  s.process = job.process;
  s.state = job.state;
  s.message = job.message;
  s.stage = job.stage;
  s.progress = job.progress;
  s.created = job.created;
  s.updated = job.updated;
  s.started = job.started;
  s.finished = job.finished;
  s.attempt = job.attempt;
  s.tag = job.tag;
  s.reused_from = job.reused_from;
  s.mesh = job.input_info;
  s.parameters = job.parameters;
  s.report = job.report;
  if (!job.problem.empty() && job.state == JobState::kFailed)
    s.problem = api::problem_from_json(parsed_or_null(job.problem));
  if (job.state == JobState::kAccepted) s.queue_position = jobs_.queue_position(job);
  const std::optional<LiveProgress> live = bus_.live(job.id);
  if (job.state == JobState::kRunning && live && live->attempt == job.attempt) {
    s.progress = live->percent;
    s.stage = live->stage;
    s.message = live->message;
  }
  return s;
}

api::StatusInfo JobService::status_at(const JobRecord& job, const JobEvent& event) const {
  JobRecord then = job;
  then.state = event.state;
  then.progress = event.progress;
  then.stage = event.stage;
  then.message = event.message;
  then.updated = event.at;
  if (!api::is_terminal(event.state)) {
    then.finished.reset();
    then.report.clear();
  }
  api::StatusInfo s = status(then);
  // What is live now was not so then.
  s.progress = event.progress;
  s.stage = event.stage;
  s.message = event.message;
  return s;
}

JobRecord JobService::dismiss(const JobRecord& job) {
  const DismissOutcome outcome = jobs_.dismiss(job.id, now_us() + options_.limits.keep_dismissed);
  if (outcome == DismissOutcome::kNoSuchJob)
    throw Refusal(ProblemType::kNoSuchJob, "there is no job " + job.id);
  pool_.stop_job(job.id);
  if (outcome == DismissOutcome::kDismissed) {
    bus_.publish(job.id);
    return *jobs_.find(job.id);
  }
  bus_.publish_removed(job.id, job.principal);
  JobRecord removed = job;
  removed.state = JobState::kDismissed;
  removed.message = "removed";
  return removed;
}

JobRecord JobService::finish(const JobRecord& job) {
  if (job.process != api::kSweep)
    throw Refusal(ProblemType::kConflict, "the job is no sweep, it has no points to keep",
                  "DELETE cancels it");
  const bool runs = job.state == JobState::kRunning;
  if (job.state != JobState::kSuccessful && !(runs && pool_.finish_job(job.id)))
    throw Refusal(ProblemType::kConflict, std::string("the job is ") + api::to_string(job.state),
                  "only a sweep that runs can end with what it has; DELETE cancels one that waits");
  return *jobs_.find(job.id);
}

JobRecord JobService::retry(const JobRecord& job) {
  if (!jobs_.retry(job.id, now_us() + options_.limits.keep_results))
    throw Refusal(ProblemType::kConflict, std::string("the job is ") + api::to_string(job.state),
                  "only failed and dismissed jobs can be run again; to compute anew, send the mesh with "
                  "cache=refresh");
  bus_.publish(job.id);
  pool_.wake();
  return *jobs_.find(job.id);
}

JobRecord JobService::wait_for_change(JobRecord job, bool until_end, std::chrono::seconds limit) {
  const auto until = SteadyClock::now() + limit;
  const JobState before = job.state;
  for (std::uint64_t seen = bus_.newest();;) {
    const std::optional<JobRecord> now = jobs_.find(job.id);
    if (!now) return job;
    job = *now;
    if (api::is_terminal(job.state) || (!until_end && job.state != before)) return job;
    if (!bus_.wait(job.id, seen, until)) return job;
  }
}

}  // namespace sheetform::server
