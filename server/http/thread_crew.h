// Threads that come when there is work and go when there is none.
#pragma once
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>

namespace sheetform::server {

class ThreadCrew {
 public:
  explicit ThreadCrew(int most) : most_(most) {}
  /// Waits for all work to end.
  ~ThreadCrew();
  ThreadCrew(const ThreadCrew&) = delete;
  ThreadCrew& operator=(const ThreadCrew&) = delete;

  /// False when all threads are busy and no more may be started; the work is then not done.
  bool submit(std::function<void()> work);
  int busy() const;
  /// Waits until nothing is being done, at most until `until`; true when that is so.
  bool wait_idle(std::chrono::steady_clock::time_point until);

 private:
  void run();

  const int most_;
  mutable std::mutex mutex_;
  std::condition_variable work_, changed_;
  std::deque<std::function<void()>> queue_;
  int threads_ = 0, idle_ = 0;
  bool ending_ = false;
};

}  // namespace sheetform::server
