#include "server/jobs/spawn_plan.h"

#include <fcntl.h>
#include <signal.h>

#include <array>
#include <cerrno>
#include <system_error>

#include "server/jobs/worker_protocol.h"

namespace sheetform::server {
namespace {

constexpr int kFirstHighDescriptor = 16;  // above every number that the child is given

}  // namespace

Descriptor high_copy(int fd) {
  const int copy = ::fcntl(fd, F_DUPFD_CLOEXEC, kFirstHighDescriptor);
  if (copy < 0) throw std::system_error(errno, std::generic_category(), "dup");
  return Descriptor(copy);
}

SpawnPlan::SpawnPlan() {
  ::posix_spawn_file_actions_init(&actions_);
  ::posix_spawnattr_init(&attributes_);
  sigset_t none, all;
  ::sigemptyset(&none);
  ::sigfillset(&all);
  ::posix_spawnattr_setsigmask(&attributes_, &none);
  ::posix_spawnattr_setsigdefault(&attributes_, &all);
  ::posix_spawnattr_setpgroup(&attributes_, 0);
  ::posix_spawnattr_setflags(&attributes_,
                             POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
}

SpawnPlan::~SpawnPlan() {
  ::posix_spawn_file_actions_destroy(&actions_);
  ::posix_spawnattr_destroy(&attributes_);
}

void SpawnPlan::give(int fd, int as) {
  if (fd >= 0)
    ::posix_spawn_file_actions_adddup2(&actions_, fd, as);
  else
    ::posix_spawn_file_actions_addopen(&actions_, as, "/dev/null", O_RDONLY, 0);
}

void SpawnPlan::give_all(const ChildDescriptors& d) {
  give(-1, 0);
  give(d.log, 1);
  give(d.log, 2);
  give(d.input, kInputDescriptor);
  give(d.folder, kFolderDescriptor);
  give(d.status, kStatusDescriptor);
  give(d.request, kRequestDescriptor);
}

pid_t SpawnPlan::start(const std::string& path, std::string command) {
  ::posix_spawn_file_actions_addclosefrom_np(&actions_, kRequestDescriptor + 1);
  std::string program = "sheetform", arenas = "MALLOC_ARENA_MAX=2";
  std::array<char*, 3> arguments{program.data(), command.data(), nullptr};
  std::array<char*, 2> environment{arenas.data(), nullptr};
  pid_t pid = -1;
  const int error =
      ::posix_spawn(&pid, path.c_str(), &actions_, &attributes_, arguments.data(), environment.data());
  if (error != 0) throw std::system_error(error, std::generic_category(), "start of the child");
  return pid;
}

}  // namespace sheetform::server
