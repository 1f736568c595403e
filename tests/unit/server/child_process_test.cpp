#include "server/jobs/child_process.h"

#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

extern "C" {  // which glibc 2.36 forgets
#include <sys/pidfd.h>
}

namespace {
bool no_descriptors = false;
}

/// Stands in for that of the C library in the whole program.
extern "C" int pidfd_open(pid_t pid, unsigned int flags) noexcept {
  if (no_descriptors) {
    errno = EMFILE;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_pidfd_open, pid, flags));
}

namespace sheetform::server {
namespace {

TEST(RunChild, AChildThatCannotBeWatchedIsPutDown) {
  ChildTask task;
  task.program = SHEETFORM_FAKE_WORKER;
  no_descriptors = true;
  const ChildReport report = run_child(task);
  no_descriptors = false;
  EXPECT_EQ(report.ending, ChildEnding::kNotStarted);
  EXPECT_NE(report.log.find("pidfd_open"), std::string::npos) << report.log;
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
  EXPECT_EQ(errno, ECHILD);
}

}  // namespace
}  // namespace sheetform::server
