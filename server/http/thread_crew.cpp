#include "server/http/thread_crew.h"

#include <thread>

#include "server/base/log.h"

namespace sheetform::server {
namespace {

constexpr auto kIdleLife = std::chrono::seconds(10);

}  // namespace

ThreadCrew::~ThreadCrew() {
  std::unique_lock lock(mutex_);
  ending_ = true;
  work_.notify_all();
  changed_.wait(lock, [this] { return threads_ == 0; });
}

bool ThreadCrew::submit(std::function<void()> work) {
  const std::lock_guard lock(mutex_);
  if (ending_) return false;
  if (static_cast<std::size_t>(idle_) <= queue_.size()) {
    if (threads_ >= most_) return false;
    try {
      std::thread([this] { run(); }).detach();
    } catch (const std::system_error&) {
      return false;  // the machine has no more threads
    }
    ++threads_;
    ++idle_;
  }
  queue_.push_back(std::move(work));
  work_.notify_one();
  return true;
}

int ThreadCrew::busy() const {
  const std::lock_guard lock(mutex_);
  return threads_ - idle_;
}

bool ThreadCrew::wait_idle(std::chrono::steady_clock::time_point until) {
  std::unique_lock lock(mutex_);
  return changed_.wait_until(lock, until, [this] { return queue_.empty() && threads_ == idle_; });
}

void ThreadCrew::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    work_.wait_for(lock, kIdleLife, [this] { return !queue_.empty() || ending_; });
    if (queue_.empty()) break;  // nothing came for a while, or the end
    const std::function<void()> work = std::move(queue_.front());
    queue_.pop_front();
    --idle_;
    lock.unlock();
    try {
      work();
    } catch (const std::exception& e) {
      log_error("a connection's thread failed", {{"reason", e.what()}});
    }
    lock.lock();
    ++idle_;
    changed_.notify_all();
  }
  --idle_;
  --threads_;
  changed_.notify_all();
}

}  // namespace sheetform::server
