// Threads that stay for the many short loops of one run. Internal to base/; see parallel_for.
#pragma once
#include <atomic>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

namespace sheetform {

/// Waits until `value` is no longer `old`: awake for about as long as a loop of a run takes, then asleep.
void wait_while(const std::atomic<int>& value, int old);

/// Threads that wait for tasks, awake for a while after each. To start a thread takes 54 to 116 us until it
/// works, and a run on a small mesh has two hundred loops of 1 ms.
class Crew {
 public:
  /// At most so many, each started when it is first needed.
  explicit Crew(int threads);
  /// No task may be under way.
  ~Crew();
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  /// Has one of the threads call the task; false when all have one, or there is no memory or
  /// thread for it. Throws nothing.
  bool begin(const std::function<void()>& task);

 private:
  enum State : int { kFree, kTaken, kHasTask, kEnds };
  struct Member {
    std::atomic<int> state{kFree};
    std::function<void()> task;
    std::thread thread;
    void run();
    void become(State next) { state = next, state.notify_one(); }
  };
  std::vector<std::unique_ptr<Member>> members_;
};

}  // namespace sheetform
