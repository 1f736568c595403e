// Retention, quota, and the collection of content that nothing names any more.
#include "server/base/log.h"
#include "server/jobs/job_service.h"

namespace sheetform::server {
namespace {

constexpr int kBatch = 200;
constexpr Microseconds kFresh = kHour;  // younger content may belong to a job that is just being accepted

}  // namespace

void JobService::keep_quota() {
  const auto quota = static_cast<std::int64_t>(options_.limits.stored_bytes);
  if (quota == 0) return;
  while (jobs_.stored_bytes() > quota) {
    const std::vector<std::string> oldest = jobs_.oldest_finished(kBatch / 10);
    if (oldest.empty()) return;
    for (const std::string& id : oldest) {
      if (const std::optional<std::int64_t> owner = jobs_.remove(id)) bus_.publish_removed(id, *owner);
    }
    log_info("jobs were removed to keep the quota", {{"jobs", oldest.size()}});
    collect_unused();
  }
}

/// Rows first, content after: what is left by a crash in between is collected by the next run. Each removal
/// waits for those that are storing content, and looks again; accepts and results wait for one removal at
/// most.
void JobService::collect_unused() {
  const auto drop_unknown = [this](const std::string& digest) {
    const std::unique_lock lock(content_);
    if (jobs_.knows_blob(digest)) return;
    inputs_.drop(digest);
    blobs_.drop(digest);
  };
  for (;;) {
    const std::vector<std::string> unused = jobs_.unused_blobs(now_us(), kBatch);
    for (const std::string& digest : unused) {
      const std::unique_lock lock(content_);
      if (!jobs_.remove_blob_row(digest)) continue;
      inputs_.drop(digest);
      blobs_.drop(digest);
    }
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
  keep_quota();
  collect_unused();
  blobs_.shrink();
}

}  // namespace sheetform::server
