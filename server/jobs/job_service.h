// The service behind the API: stores, pool and rules in one place. Knows nothing of HTTP.
#pragma once
#include <memory>
#include <set>

#include "server/jobs/event_bus.h"
#include "server/jobs/exporter.h"
#include "server/jobs/inspector.h"
#include "server/jobs/refusal.h"
#include "server/jobs/service_limits.h"
#include "server/jobs/slot_pool.h"
#include "server/mapping/exports.h"
#include "sheetform_api/process.h"

namespace sheetform::server {

struct ServiceOptions {
  std::filesystem::path data;
  ServiceLimits limits;
  bool sandbox = true;
  std::string worker = kOwnProgram;  ///< program of the jobs' processes
  std::string profiles;              ///< the operator's own profiles of exports, JSON; empty: none
};

/// An upload with everything that decides about it.
struct Submission {
  std::int64_t principal = 0;
  std::string process = api::kDecompose;
  std::string name, tag;               ///< display name of the mesh; name of the job
  api::Json parameters;                ///< complete (understood_parameters, understood_sweep_parameters)
  std::string idempotency_key, route;  ///< key empty: none
  bool refresh = false;                ///< do not reuse an earlier result
};

struct Submitted {
  JobRecord job;
  bool replayed = false;  ///< the job of an earlier request with the same idempotency key
};

class JobService {
 public:
  /// Locks the data folder, opens the stores, recovers what the last process left. Throws StoreError,
  /// std::filesystem::filesystem_error, and Refusal when another server uses the folder.
  explicit JobService(ServiceOptions options);
  ~JobService();
  JobService(const JobService&) = delete;
  JobService& operator=(const JobService&) = delete;

  void start();
  /// No new jobs are taken or begun; running ones get `grace`.
  void drain(std::chrono::seconds grace);
  bool draining() const { return draining_; }
  /// Ends every wait for events.
  void end_waits() { bus_.wake_all(); }

  /// Throws Refusal when no upload can be taken now: draining, queue full, disk full.
  void check_admission(std::int64_t principal) const;
  std::unique_ptr<Upload> begin_upload() const;
  /// The accept protocol: when it returns, upload and job are on stable storage. Throws Refusal.
  Submitted submit(Upload& upload, const Submission& submission);

  /// One point of a finished sweep as a job of its own, with the result that the sweep has found; the same
  /// job when it was opened before. Throws Refusal.
  Submitted open_point(const JobRecord& sweep, const std::string& point);

  /// A job that this principal may see, or Refusal kNoSuchJob. principal none: every job.
  JobRecord job(const std::string& id, std::optional<std::int64_t> principal) const;
  /// For the wire, with live progress and place in the queue.
  api::StatusInfo status(const JobRecord& job) const;
  /// The status as it was at an event.
  api::StatusInfo status_at(const JobRecord& job, const JobEvent& event) const;
  /// Cancels or removes; the job as it is afterwards (as dismissed when it was removed).
  JobRecord dismiss(const JobRecord& job);
  /// Asks a running sweep to end with the points that it has found, or with the first one; the job as it is.
  /// Throws Refusal for any other job; a sweep that has just ended is fine.
  JobRecord finish(const JobRecord& job);
  JobRecord retry(const JobRecord& job);
  /// Waits until the job's revision differs, or (until_end) until it has ended; at most `limit`.
  JobRecord wait_for_change(JobRecord job, bool until_end, std::chrono::seconds limit);

  /// A file made from the result of a successful job, without computing it again. Throws Refusal.
  std::shared_ptr<const ExportedFile> export_result(const JobRecord& job, const ExportWish& wish);

  const JobStore& store() const { return jobs_; }
  JobStore& store() { return jobs_; }
  const BlobStore& blobs() const { return blobs_; }
  Descriptor open_input(const std::string& digest) const { return inputs_.open(digest); }
  EventBus& bus() { return bus_; }
  const EventBus& bus() const { return bus_; }
  const ServiceLimits& limits() const { return options_.limits; }
  const std::string& profiles() const { return options_.profiles; }
  int running() const { return pool_.running(); }
  std::uint64_t free_bytes() const;

  /// Removes what is over its time or quota, and content that nothing names. Called now and then, by the
  /// thread that also calls keep_quota().
  void keep_house();
  /// Removes the oldest finished jobs when all together need more than the quota; nothing when nothing was
  /// stored since the last call.
  void keep_quota();

 private:
  Submitted accept(Upload& upload, const Submission& s, const std::string& fingerprint,
                   const Inspection& inspection);
  NewJob new_job(Upload& upload, const Submission& s, const std::string& fingerprint,
                 const Inspection& inspection) const;
  std::optional<Submitted> earlier(const Submission& s, const std::string& fingerprint) const;
  void collect_unused();
  void remove_over_quota();
  std::int64_t remove_with_content(const std::string& id);
  bool drop_unused(const std::string& digest);

  ServiceOptions options_;
  Descriptor lock_;
  JobStore jobs_;
  BlobStore blobs_;
  InputStore inputs_;
  EventBus bus_;
  std::unique_ptr<Nursery> nursery_;
  Inspector inspector_;
  Exporter exporter_;
  std::shared_mutex content_;
  SlotPool pool_;
  std::atomic<bool> draining_{false};
  std::uint64_t quota_kept_at_ = 0;  ///< the newest change then
  mutable std::mutex keys_mutex_;
  std::set<std::string> keys_in_progress_;
};

}  // namespace sheetform::server
