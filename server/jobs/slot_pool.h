// The thread pool: each slot takes a job, supervises its process, takes the next.
#pragma once
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "server/jobs/job_runner.h"

namespace sheetform::server {

class SlotPool {
 public:
  explicit SlotPool(RunnerParts parts) : parts_(std::move(parts)) {}
  ~SlotPool();
  SlotPool(const SlotPool&) = delete;
  SlotPool& operator=(const SlotPool&) = delete;

  void start(int slots);
  /// New work may be there.
  void wake();
  /// Ends the process of a job that a user dismissed.
  void stop_job(const std::string& id);
  /// Asks a sweep to end with the points that it has; false when it does not run. Waits for a slot that is
  /// just taking it.
  bool finish_job(const std::string& id);
  /// No new jobs; those that run get until `deadline`, then they are stopped and wait again. Returns when all
  /// slots have ended. May be called once.
  void drain(SteadyClock::time_point deadline);
  int running() const;

 private:
  void run_slot();
  /// Takes the next job and runs it to its end; false when there is none.
  bool take_one();
  /// Claims a job and puts it among the running, with how its attempt is told to stop.
  std::optional<ClaimedJob> claim(const std::shared_ptr<AttemptWishes>& wishes);
  void run_one(const ClaimedJob& claimed, const std::shared_ptr<AttemptWishes>& running);
  void put_back(const ClaimedJob& claimed);
  void wait_for_work(std::unique_lock<std::mutex>& lock);
  void stop_all();
  static void stop_for_drain(AttemptWishes& job);

  RunnerParts parts_;
  mutable std::mutex mutex_;
  std::condition_variable work_, ended_, entered_;
  std::uint64_t wakes_ = 0;
  int claiming_ = 0;  ///< slots whose job may be said to run in the store, but is not yet in running_
  bool draining_ = false, stop_now_ = false;
  std::map<std::string, std::shared_ptr<AttemptWishes>> running_;
  std::vector<std::thread> threads_;
};

}  // namespace sheetform::server
