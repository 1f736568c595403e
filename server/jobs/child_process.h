// One child process a task: started with its descriptors and nothing else, watched until it is gone.
#pragma once
#include <atomic>
#include <functional>
#include <string>

#include "server/base/clock.h"
#include "server/base/descriptor.h"
#include "server/jobs/nursery.h"
#include "server/jobs/worker_protocol.h"

namespace sheetform::server {

/// An event that another thread can raise and poll() can see.
class StopSignal {
 public:
  StopSignal();
  void raise();
  bool raised() const { return raised_; }
  int descriptor() const { return event_.get(); }

 private:
  Descriptor event_;
  std::atomic<bool> raised_{false};
};

inline constexpr const char* kOwnProgram = "/proc/self/exe";

struct ChildTask {
  std::string program = kOwnProgram;  ///< called with the one argument `worker`
  Nursery* nursery = nullptr;         ///< begins the child in place of `program`, when there is one
  int input = -1;                     ///< descriptor of the mesh, may be -1
  int folder = -1;                    ///< descriptor of the folder to write into, may be -1
  WorkerRequest request;
  std::chrono::seconds wall{900}, stall{120};
  const StopSignal* stop = nullptr;  ///< asks the child to end; killed half a second later
  const StopSignal* enough =
      nullptr;  ///< asks it to end with the result that it has; within a quarter of a second
  std::function<void(const WorkerMessage&)> on_message;
};

enum class ChildEnding { kExited, kSignalled, kTimedOut, kStalled, kStopped, kFlooded, kNotStarted };

struct ChildReport {
  ChildEnding ending = ChildEnding::kNotStarted;
  int exit_status = 0, signal = 0;
  std::int64_t peak_rss = 0, cpu_ms = 0;  ///< bytes, milliseconds
  std::string log;                        ///< what it wrote to stdout and stderr, at most 256 KiB
  int bad_lines = 0;
};

/// Starts this program's own `worker` command and waits for its end. on_message is called on this thread. The
/// child dies with the calling thread. Never throws for what the child does.
ChildReport run_child(const ChildTask& task);

}  // namespace sheetform::server
