// Short children begun quickly. Loading the program costs several times the work of looking at a small mesh;
// the nursery has loaded it once, and each child is a copy of it. Still one process a mesh: a copy ends with
// its mesh, closes itself in as any other, and the nursery itself never sees a stranger's byte.
#pragma once
#include <mutex>
#include <string>

#include "server/jobs/spawn_plan.h"

namespace sheetform::server {

class Nursery {
 public:
  /// Starts `program nursery`. Must be called on a thread that lives as long as the children may: they die
  /// with it. Throws std::system_error.
  explicit Nursery(const std::string& program);
  ~Nursery();
  Nursery(const Nursery&) = delete;
  Nursery& operator=(const Nursery&) = delete;

  /// Begins a child of this process (not of the nursery), in a process group of its own, as SpawnPlan would
  /// with the command `worker`. Thread-safe. -1 when the nursery is gone.
  pid_t begin(const ChildDescriptors& descriptors);

 private:
  std::mutex mutex_;
  Descriptor line_, nothing_;
  pid_t pid_ = -1;
};

/// The other side: `sheetform nursery`, for the server only. Returns an exit status when the server has hung
/// up; in each copy, that of the worker.
int nursery_command();

}  // namespace sheetform::server
