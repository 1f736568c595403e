#include "server/jobs/event_bus.h"

#include <algorithm>

namespace sheetform::server {
namespace {

constexpr std::size_t kKept = 4096;
constexpr auto kLiveInterval = std::chrono::milliseconds(250);

}  // namespace

void EventBus::publish_locked(JobChange change) {
  ++newest_;
  changes_.push_back(std::move(change));
  if (changes_.size() > kKept) changes_.pop_front();
  condition_.notify_all();
}

void EventBus::publish(const std::string& job) {
  const std::lock_guard lock(mutex_);
  publish_locked({job, std::nullopt});
}

void EventBus::publish_removed(const std::string& job, std::int64_t principal) {
  const std::lock_guard lock(mutex_);
  publish_locked({job, principal});
}

void EventBus::progress(const std::string& job, const LiveProgress& live, bool now) {
  const std::lock_guard lock(mutex_);
  Entry& entry = live_[job];
  entry.live = live;
  const auto time = SteadyClock::now();
  if (!now && time - entry.published < kLiveInterval) return;
  entry.published = time;
  publish_locked({job, std::nullopt});
}

void EventBus::forget(const std::string& job) {
  const std::lock_guard lock(mutex_);
  live_.erase(job);
}

std::optional<LiveProgress> EventBus::live(const std::string& job) const {
  const std::lock_guard lock(mutex_);
  const auto found = live_.find(job);
  if (found == live_.end()) return std::nullopt;
  return found->second.live;
}

std::uint64_t EventBus::newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

bool EventBus::changed(const std::string& job, std::uint64_t seen) const {
  if (newest_ == seen) return false;
  const std::uint64_t fresh = newest_ - seen;
  if (job.empty() || fresh > changes_.size()) return true;
  return std::any_of(changes_.end() - static_cast<std::ptrdiff_t>(fresh), changes_.end(),
                     [&](const JobChange& change) { return change.job == job; });
}

bool EventBus::wait(const std::string& job, std::uint64_t& seen, SteadyClock::time_point until) {
  std::unique_lock lock(mutex_);
  const bool came = condition_.wait_until(lock, until, [&] { return closed_ || changed(job, seen); });
  seen = newest_;
  return came && !closed_;
}

std::optional<std::vector<JobChange>> EventBus::changed_since(std::uint64_t seen) const {
  const std::lock_guard lock(mutex_);
  const std::uint64_t fresh = newest_ - seen;
  if (fresh > changes_.size()) return std::nullopt;
  std::vector<JobChange> jobs;
  for (std::uint64_t i = 0; i < fresh; ++i) {
    const JobChange& change = changes_[changes_.size() - 1 - i];
    const auto later =
        std::find_if(jobs.begin(), jobs.end(), [&](const JobChange& j) { return j.job == change.job; });
    if (later == jobs.end())
      jobs.push_back(change);
    else if (!later->removed_of)  // the slot that ran it may tell of it after its removal
      later->removed_of = change.removed_of;
  }
  std::reverse(jobs.begin(), jobs.end());
  return jobs;
}

void EventBus::wake_all() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  condition_.notify_all();
}

}  // namespace sheetform::server
