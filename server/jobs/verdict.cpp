// The table from a child's end to the job's next state.
#include <signal.h>

#include <algorithm>
#include <cstring>

#include "server/jobs/job_runner.h"
#include "server/mapping/errors.h"

namespace sheetform::server {
namespace {

using Action = Verdict::Action;

constexpr Microseconds kUntilRoom = 2 * kSecond;
constexpr const char* kLess = "simplify the mesh, allow a larger tolerance (e_max), or choose less effort";

api::Problem too_long(const ServiceLimits& limits) {
  return make_problem(api::ProblemType::kTimeLimit,
                      "the job took longer than " + std::to_string(limits.job_seconds) + " s", kLess);
}

Verdict failure(std::string outcome, Requeue counted_as, api::Problem what) {
  Verdict v;
  v.action = Action::kFail;
  v.outcome = std::move(outcome);
  v.counted_as = counted_as;
  v.problem = std::move(what);
  return v;
}

/// 1 s, 4 s, 16 s, ... five minutes at most.
Microseconds backoff(int failures) {
  Microseconds delay = kSecond;
  for (int i = 0; i < failures && delay < 300 * kSecond; ++i) delay *= 4;
  return std::min(delay, 300 * kSecond);
}

/// Waits again while `used` starts are fewer than `allowed`, else fails with `what`.
Verdict again(std::string outcome, Requeue reason, int used, int allowed, api::Problem what) {
  if (used + 1 >= allowed) return failure(std::move(outcome), reason, std::move(what));
  Verdict v;
  v.action = Action::kRequeue;
  v.outcome = std::move(outcome);
  v.counted_as = reason;
  v.delay = reason == Requeue::kInterruption ? 0 : backoff(used);
  v.problem = std::move(what);
  return v;
}

std::string starts(int count) { return std::to_string(count) + (count == 1 ? " start" : " starts"); }

Verdict after_signal(int signal, const JobRecord& job, const std::string& stage,
                     const ServiceLimits& limits) {
  if (signal == SIGXCPU)
    return failure("time", Requeue::kError,
                   make_problem(api::ProblemType::kTimeLimit, "the job used up its processor time", kLess));
  const std::string where = stage.empty() ? std::string("before its first stage") : "in stage " + stage;
  if (signal == SIGKILL)  // not by us: the machine ran out of memory
    return again(
        "memory", Requeue::kCrash, job.crashes, limits.crashes,
        make_problem(api::ProblemType::kMemoryLimit,
                     "the machine ended the job's process " + where + ", most likely for lack of memory",
                     "simplify the mesh"));
  api::Problem p = make_problem(api::ProblemType::kWorkerCrashed,
                                "the job's process died of signal " + std::to_string(signal) + " (" +
                                    ::strsignal(signal) + ") " + where + ", after " + starts(job.crashes + 1),
                                "please report this mesh; other parameters may avoid it");
  p.where = stage;
  return again("crash", Requeue::kCrash, job.crashes, limits.crashes, std::move(p));
}

Verdict after_exit(int status, const std::optional<api::Problem>& told, bool has_result, const JobRecord& job,
                   const ServiceLimits& limits, std::uint64_t free_bytes) {
  if (status == kExitOk && has_result) {
    Verdict v;
    v.action = Action::kPublish;
    v.outcome = "success";
    return v;
  }
  if (told && told->type == api::ProblemType::kTimeLimit)  // a sweep watches the clock itself
    return failure("time", Requeue::kError, too_long(limits));
  if (status == kExitInput && told) return failure("refused", Requeue::kError, *told);
  if (status == kExitMemory)
    return failure("memory", Requeue::kError,
                   make_problem(api::ProblemType::kMemoryLimit,
                                "the job needs more than " + std::to_string(limits.job_memory >> 20) + " MiB",
                                "simplify the mesh"));
  if (status == kExitIo) return judge_disk(job, limits, free_bytes);
  if (told) return failure("failed", Requeue::kError, *told);
  const std::string what =
      status == kExitOk ? "ended without a result" : "ended with status " + std::to_string(status);
  return failure("failed", Requeue::kError,
                 make_problem(api::ProblemType::kAlgorithmFailed, "the job's process " + what,
                              "please report this mesh; other parameters may avoid it"));
}

Verdict after_stop(StopReason reason, const JobRecord& job, const ServiceLimits& limits) {
  if (reason == StopReason::kDismissed) {
    Verdict v;
    v.action = Action::kDrop;
    v.outcome = "dismissed";
    return v;
  }
  return again(
      "interrupted", Requeue::kInterruption, job.interruptions, limits.interruptions,
      make_problem(api::ProblemType::kInternal, "the job was interrupted too often", "start it again"));
}

}  // namespace

Verdict judge_attempt(const ChildReport& report, const std::optional<api::Problem>& told, bool has_result,
                      StopReason reason, const JobRecord& job, const std::string& stage,
                      const ServiceLimits& limits, std::uint64_t free_bytes) {
  switch (report.ending) {
    case ChildEnding::kExited:
      return after_exit(report.exit_status, told, has_result, job, limits, free_bytes);
    case ChildEnding::kSignalled:
      return after_signal(report.signal, job, stage, limits);
    case ChildEnding::kStopped:
      return after_stop(reason, job, limits);
    case ChildEnding::kTimedOut:
      return failure("time", Requeue::kError, too_long(limits));
    case ChildEnding::kStalled:
      return failure(
          "time", Requeue::kError,
          make_problem(api::ProblemType::kTimeLimit,
                       "the job made no progress for " + std::to_string(limits.stall_seconds) + " s", kLess));
    case ChildEnding::kFlooded:
      return failure(
          "failed", Requeue::kError,
          make_problem(api::ProblemType::kAlgorithmFailed,
                       "the job's process flooded the server with messages", "please report this mesh"));
    case ChildEnding::kNotStarted:
      return again("not started", Requeue::kError, job.errors, limits.errors,
                   make_problem(api::ProblemType::kInternal, "the job's process could not be started",
                                "try again later"));
  }
  return {};
}

Verdict judge_disk(const JobRecord& job, const ServiceLimits& limits, std::uint64_t free_bytes) {
  Verdict v = again(
      "io", Requeue::kError, job.errors, limits.errors,
      make_problem(api::ProblemType::kStorage, "the job's files could not be written", "try again later"));
  if (free_bytes >= limits.result_bytes) return v;
  v.action = Action::kRequeue;
  v.counted_as = Requeue::kNoRoom;
  v.delay = kUntilRoom;
  v.problem.detail = "the server's disk is full";
  return v;
}

}  // namespace sheetform::server
