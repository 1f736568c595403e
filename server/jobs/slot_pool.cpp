#include "server/jobs/slot_pool.h"

#include "server/base/log.h"

namespace sheetform::server {
namespace {

constexpr auto kPoll = std::chrono::seconds(2);  // the truth behind every missed wake
constexpr auto kAfterFailure = std::chrono::seconds(1);

/// Counts those who are at something, and tells when one is no more.
class Counted {
 public:
  Counted(std::mutex& mutex, int& count, std::condition_variable& changed)
      : mutex_(mutex), count_(count), changed_(changed) {
    const std::lock_guard lock(mutex_);
    ++count_;
  }
  ~Counted() {
    const std::lock_guard lock(mutex_);
    --count_;
    changed_.notify_all();
  }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;

 private:
  std::mutex& mutex_;
  int& count_;
  std::condition_variable& changed_;
};

}  // namespace

SlotPool::~SlotPool() { drain(SteadyClock::now()); }

void SlotPool::start(int slots) {
  for (int i = 0; i < slots; ++i) threads_.emplace_back([this] { run_slot(); });
}

void SlotPool::wake() {
  const std::lock_guard lock(mutex_);
  ++wakes_;
  work_.notify_all();
}

void SlotPool::stop_job(const std::string& id) {
  const std::lock_guard lock(mutex_);
  const auto found = running_.find(id);
  if (found == running_.end()) return;
  found->second->reason = StopReason::kDismissed;
  found->second->stop.raise();
}

bool SlotPool::finish_job(const std::string& id) {
  std::unique_lock lock(mutex_);
  entered_.wait_for(lock, kPoll, [&] { return claiming_ == 0 || running_.count(id) > 0; });
  const auto found = running_.find(id);
  if (found == running_.end()) return false;
  found->second->enough.raise();
  return true;
}

int SlotPool::running() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(running_.size());
}

void SlotPool::stop_for_drain(AttemptWishes& job) {
  StopReason none = StopReason::kNone;
  job.reason.compare_exchange_strong(none, StopReason::kDrain);
  job.stop.raise();
}

void SlotPool::stop_all() {
  stop_now_ = true;
  for (auto& [id, job] : running_) stop_for_drain(*job);
}

void SlotPool::drain(SteadyClock::time_point deadline) {
  {
    std::unique_lock lock(mutex_);
    draining_ = true;
    work_.notify_all();
    ended_.wait_until(lock, deadline, [this] { return running_.empty(); });
    stop_all();
  }
  for (std::thread& t : threads_) t.join();
  threads_.clear();
}

void SlotPool::wait_for_work(std::unique_lock<std::mutex>& lock) {
  const std::uint64_t seen = wakes_;
  work_.wait_for(lock, kPoll, [&] { return draining_ || wakes_ != seen; });
}

void SlotPool::run_slot() {
  std::unique_lock lock(mutex_);
  std::uint64_t seen = wakes_;
  while (!draining_) {
    lock.unlock();
    bool took = false, failed = false;
    try {
      took = take_one();
    } catch (const std::exception& e) {
      log_error("a slot failed", {{"reason", e.what()}});
      failed = true;
    }
    lock.lock();
    if (failed)
      work_.wait_for(lock, kAfterFailure, [this] { return draining_; });
    else if (!took && seen == wakes_)
      wait_for_work(lock);
    seen = wakes_;
  }
}

/// While the disk is full not even that can be written: tried again until it can, or the next start does it.
void SlotPool::put_back(const ClaimedJob& claimed) {
  for (;;) {
    const bool full = free_bytes(parts_) < parts_.limits.result_bytes;
    try {
      parts_.jobs.requeue(
          claimed, full ? Requeue::kNoRoom : Requeue::kError, now_us() + (full ? 2 : 10) * kSecond,
          full ? "waiting again: the server's disk is full" : "waiting again: the server had a problem");
      return;
    } catch (const StoreError& e) {
      log_error("a job could not be put back", {{"job", claimed.job.id}, {"reason", e.what()}});
    }
    std::unique_lock lock(mutex_);
    if (work_.wait_for(lock, kPoll, [this] { return draining_; })) return;
  }
}

bool SlotPool::take_one() {
  const auto wishes = std::make_shared<AttemptWishes>();  // may fail, so before there is a job
  const std::optional<ClaimedJob> claimed = claim(wishes);
  if (claimed) run_one(*claimed, wishes);
  return claimed.has_value();
}

std::optional<ClaimedJob> SlotPool::claim(const std::shared_ptr<AttemptWishes>& wishes) {
  const Counted claiming(mutex_, claiming_, entered_);
  std::optional<ClaimedJob> claimed = parts_.jobs.claim(now_us());
  if (!claimed) return claimed;
  const std::lock_guard lock(mutex_);
  running_[claimed->job.id] = wishes;
  if (stop_now_) stop_for_drain(*wishes);
  return claimed;
}

void SlotPool::run_one(const ClaimedJob& claimed, const std::shared_ptr<AttemptWishes>& running) {
  parts_.bus.publish(claimed.job.id);
  // Dismissed between the claim and the entry above: nobody would stop it any more.
  const std::optional<JobRecord> job = parts_.jobs.find(claimed.job.id);
  try {
    if (job && job->state == JobState::kRunning) run_attempt(parts_, claimed, *running);
  } catch (const std::exception& e) {
    log_error("an attempt failed", {{"job", claimed.job.id}, {"reason", e.what()}});
    put_back(claimed);
  }
  {
    const std::lock_guard lock(mutex_);
    // A retry may have put its own entry there meanwhile.
    const auto mine = running_.find(claimed.job.id);
    if (mine != running_.end() && mine->second == running) running_.erase(mine);
    ended_.notify_all();
  }
  parts_.bus.forget(claimed.job.id);
  parts_.bus.publish(claimed.job.id);
}

}  // namespace sheetform::server
