// The metadata of jobs: the one state machine, every arrow a guarded UPDATE (service notes in
// server/README.md).
#pragma once
#include <filesystem>
#include <map>
#include <memory>

#include "server/store/job_record.h"
#include "server/store/store_error.h"

namespace sheetform::server {

/// Which of its counters a start counts in. A disk without room is no fault of the job: it counts in none.
enum class Requeue { kInterruption, kCrash, kError, kNoRoom };
enum class DismissOutcome { kNoSuchJob, kDismissed, kRemoved };

/// Thread-safe. Everything throws StoreError. When a changing call returns, the change is on stable storage.
class JobStore {
 public:
  explicit JobStore(const std::filesystem::path& path);
  ~JobStore();
  JobStore(const JobStore&) = delete;
  JobStore& operator=(const JobStore&) = delete;

  // --- taking jobs in
  JobRecord accept(const NewJob& job);
  /// A job whose result is that of `source`, another successful job with the same reuse key, or a part of it:
  /// successful at once. None when that job is gone by now.
  std::optional<JobRecord> accept_reused(const NewJob& job, const std::string& source,
                                         const ResultPart& part = {});
  std::optional<IdempotencyRecord> find_idempotency(std::int64_t principal, const std::string& route,
                                                    const std::string& key) const;
  /// Newest successful job of this principal with this key.
  std::optional<JobRecord> find_reusable(std::int64_t principal, const std::string& reuse_key) const;

  // --- running them
  /// Takes the next ready job, fair among principals, then in order of arrival.
  std::optional<ClaimedJob> claim(Microseconds now);
  /// False when the attempt does not own the job any more. Also writes an event.
  bool report_progress(const ClaimedJob& claimed, int percent, const std::string& stage,
                       const std::string& message);
  /// Publishes the result; false when the attempt does not own the job any more, then nothing is stored.
  bool succeed(const ClaimedJob& claimed, const std::vector<StoredOutput>& outputs, const std::string& report,
               const std::string& message);
  bool fail(const ClaimedJob& claimed, const std::string& problem, const std::string& message,
            Requeue counted_as);
  bool requeue(const ClaimedJob& claimed, Requeue reason, Microseconds run_after, const std::string& message);
  void end_attempt(const ClaimedJob& claimed, const AttemptEnd& end);
  /// At start: what was running when the process died waits again. Returns the number of such jobs.
  int recover();

  // --- by users
  /// Cancels, or removes what has ended. expires: when a cancelled job is removed.
  DismissOutcome dismiss(const std::string& id, Microseconds expires);
  /// Failed or dismissed becomes accepted again, with all its counters at zero. False in any other state.
  bool retry(const std::string& id, Microseconds expires);

  // --- reading
  std::optional<JobRecord> find(const std::string& id) const;
  std::vector<JobRecord> list(const JobFilter& filter) const;
  std::int64_t queue_position(const JobRecord& job) const;
  std::vector<StoredOutput> outputs(std::int64_t seq) const;
  std::vector<JobEvent> events_after(std::int64_t seq, std::int64_t number) const;
  std::string attempt_log(std::int64_t seq) const;
  std::int64_t input_bytes(const std::string& digest) const;
  std::map<std::string, std::int64_t> counts() const;  ///< by name of the state
  std::int64_t waiting(std::optional<std::int64_t> principal) const;
  std::optional<Microseconds> oldest_waiting() const;
  /// Throws when the file cannot be read.
  void probe() const;

  // --- keeping house
  /// Removes jobs whose time is over, at most `limit`; returns them.
  std::vector<RemovedJob> remove_expired(Microseconds now, int limit);
  /// Oldest finished jobs, for the quota.
  std::vector<std::string> oldest_finished(int limit) const;
  /// Whose it was; none when there is no such job.
  std::optional<std::int64_t> remove(const std::string& id);
  std::int64_t stored_bytes() const;
  /// Blob rows that no job names, and their removal (again only when no job names them).
  std::vector<std::string> unused_blobs(Microseconds older_than, int limit) const;
  bool remove_blob_row(const std::string& digest);
  bool knows_blob(const std::string& digest) const;
  void forget_idempotency(Microseconds older_than);
  /// Whole-file check; empty when all is well.
  std::string check_integrity() const;
  void checkpoint();

  /// Number of the owner of this name; made when it is new.
  std::int64_t principal_id(const std::string& name);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sheetform::server
