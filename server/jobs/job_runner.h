// One attempt of one job: its folder, its child process, what its end means, the publication of its result.
#pragma once
#include <filesystem>
#include <shared_mutex>

#include "server/jobs/child_process.h"
#include "server/jobs/event_bus.h"
#include "server/jobs/service_limits.h"
#include "server/store/blob_store.h"
#include "server/store/input_store.h"
#include "server/store/job_store.h"

namespace sheetform::server {

/// What every attempt works with. All outlive the runner.
struct RunnerParts {
  JobStore& jobs;
  BlobStore& blobs;
  InputStore& inputs;
  EventBus& bus;
  const ServiceLimits& limits;
  std::filesystem::path work;  ///< folder of the attempts' folders
  std::shared_mutex& content;  ///< shared while content is stored that no row names yet
  bool sandbox = true;
  std::string program;  ///< of the child
};

/// Why an attempt was stopped from outside.
enum class StopReason { kNone, kDismissed, kDrain };

/// What others may wish of an attempt while it runs.
struct AttemptWishes {
  StopSignal stop, enough;  ///< to end it; to end a sweep with the points that it has
  std::atomic<StopReason> reason{StopReason::kNone};  ///< after `stop`: who asked for it
};

/// Runs the attempt to its end and writes what came of it.
void run_attempt(const RunnerParts& parts, const ClaimedJob& claimed, const AttemptWishes& wishes);

/// What an attempt's end means for the job. A pure function, so that the table can be tested. free_bytes: of
/// the disk at that time.
struct Verdict {
  enum class Action { kPublish, kFail, kRequeue, kDrop };
  Action action = Action::kFail;
  Requeue counted_as = Requeue::kError;
  api::Problem problem;    ///< for kFail
  Microseconds delay = 0;  ///< for kRequeue
  std::string outcome;     ///< one word for the history
};
Verdict judge_attempt(const ChildReport& report, const std::optional<api::Problem>& told, bool has_result,
                      StopReason reason, const JobRecord& job, const std::string& stage,
                      const ServiceLimits& limits, std::uint64_t free_bytes);
/// The same for a disk that refuses what the job or its result needs: it may start again, but not for ever.
/// While the disk has less room than a result may take, that is no fault of the job, and it waits.
Verdict judge_disk(const JobRecord& job, const ServiceLimits& limits, std::uint64_t free_bytes);
/// Free space where the attempts work; 0 when that cannot be told.
std::uint64_t free_bytes(const RunnerParts& parts);

}  // namespace sheetform::server
