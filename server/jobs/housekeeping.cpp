// Retention, quota, and the collection of content that nothing names any more.
#include "server/base/log.h"
#include "server/jobs/job_service.h"

namespace sheetform::server {
namespace {

constexpr int kBatch = 200;
constexpr Microseconds kFresh = kHour;  // younger content may belong to a job that is just being accepted

}  // namespace

/// Whatever is stored is told on the bus afterwards.
void JobService::keep_quota() {
  const std::uint64_t newest = bus_.newest();
  if (newest == quota_kept_at_) return;
  quota_kept_at_ = newest;
  remove_over_quota();
}

void JobService::remove_over_quota() {
  const auto quota = static_cast<std::int64_t>(options_.limits.stored_bytes);
  if (quota == 0) return;
  for (std::int64_t excess = jobs_.stored_bytes() - quota; excess > 0;) {
    const std::vector<std::string> oldest = jobs_.oldest_finished(kBatch);
    if (oldest.empty()) return;
    std::size_t removed = 0;
    for (; removed < oldest.size() && excess > 0; ++removed) excess -= remove_with_content(oldest[removed]);
    log_info("jobs were removed to keep the quota", {{"jobs", removed}});
  }
}

/// Bytes that are free by it: of what no other job names.
std::int64_t JobService::remove_with_content(const std::string& id) {
  const std::optional<JobRecord> job = jobs_.find(id);
  if (!job) return 0;
  std::vector<StoredOutput> content = jobs_.outputs(job->seq);
  content.push_back({{}, {}, job->input, jobs_.input_bytes(job->input)});
  if (!jobs_.remove(id)) return 0;  // somebody runs it again
  bus_.publish_removed(id, job->principal);
  std::int64_t freed = 0;
  for (const StoredOutput& one : content)
    if (drop_unused(one.digest)) freed += one.bytes;
  return freed;
}

/// Waits for those that are storing content, and looks again; accepts and results wait for one removal at
/// most.
bool JobService::drop_unused(const std::string& digest) {
  const std::unique_lock lock(content_);
  if (!jobs_.remove_blob_row(digest)) return false;
  inputs_.drop(digest);
  blobs_.drop(digest);
  return true;
}

/// Rows first, content after: what is left by a crash in between is collected by the next run.
void JobService::collect_unused() {
  const auto drop_unknown = [this](const std::string& digest) {
    const std::unique_lock lock(content_);
    if (jobs_.knows_blob(digest)) return;
    inputs_.drop(digest);
    blobs_.drop(digest);
  };
  for (;;) {
    const std::vector<std::string> unused = jobs_.unused_blobs(now_us(), kBatch);
    for (const std::string& digest : unused) drop_unused(digest);
    if (unused.size() < static_cast<std::size_t>(kBatch)) break;
  }
  for (const std::string& digest : inputs_.older_than(now_us() - kFresh, kBatch)) drop_unknown(digest);
  std::string after;
  for (std::vector<std::string> page; !(page = blobs_.digests(after, kBatch)).empty(); after = page.back())
    for (const std::string& digest : page) drop_unknown(digest);
}

void JobService::keep_house() {
  const Microseconds now = now_us();
  for (std::vector<RemovedJob> gone; !(gone = jobs_.remove_expired(now, kBatch)).empty();)
    for (const RemovedJob& job : gone) bus_.publish_removed(job.id, job.principal);
  jobs_.forget_idempotency(now - options_.limits.keep_idempotency);
  remove_over_quota();
  collect_unused();
  blobs_.shrink();
}

}  // namespace sheetform::server
