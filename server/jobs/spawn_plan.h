// How a process of ours is begun: which descriptors it gets, and that it gets nothing else. Internal to
// jobs/.
#pragma once
#include <spawn.h>

#include <string>

#include "server/base/descriptor.h"

namespace sheetform::server {

/// A copy of `fd` that no number of a child's table collides with. Throws std::system_error.
Descriptor high_copy(int fd);

/// What a child is given, by the numbers of worker_protocol.h; -1: nothing to be read there.
struct ChildDescriptors {
  int log = -1;  ///< 1 and 2
  int input = -1, folder = -1, status = -1, request = -1;
};

/// The actions and attributes of posix_spawn, freed at the end.
class SpawnPlan {
 public:
  SpawnPlan();
  ~SpawnPlan();
  SpawnPlan(const SpawnPlan&) = delete;
  SpawnPlan& operator=(const SpawnPlan&) = delete;

  /// fd -1: /dev/null.
  void give(int fd, int as);
  void give_all(const ChildDescriptors& descriptors);
  /// Starts `program command` in a process group of its own. Throws std::system_error.
  pid_t start(const std::string& program, std::string command);

 private:
  posix_spawn_file_actions_t actions_;
  posix_spawnattr_t attributes_;
};

}  // namespace sheetform::server
