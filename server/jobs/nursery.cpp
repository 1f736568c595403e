#include "server/jobs/nursery.h"

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "server/base/log.h"
#include "server/jobs/sandbox.h"
#include "server/jobs/worker_command.h"
#include "server/jobs/worker_protocol.h"
#include "server/mapping/errors.h"

namespace sheetform::server {
namespace {

/// In the order of ChildDescriptors.
using Given = std::array<int, 5>;

/// One byte and the descriptors.
struct Parcel {
  char byte = 0;
  iovec data{&byte, 1};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(Given))> room{};
  msghdr message{};

  Parcel() {
    message.msg_iov = &data;
    message.msg_iovlen = 1;
    message.msg_control = room.data();
    message.msg_controllen = room.size();
  }
};

bool send_descriptors(int line, const Given& given) {
  Parcel parcel;
  cmsghdr* head = CMSG_FIRSTHDR(&parcel.message);
  head->cmsg_level = SOL_SOCKET;
  head->cmsg_type = SCM_RIGHTS;
  head->cmsg_len = CMSG_LEN(sizeof given);
  std::memcpy(CMSG_DATA(head), given.data(), sizeof given);
  ssize_t sent = 0;
  do sent = ::sendmsg(line, &parcel.message, MSG_NOSIGNAL);
  while (sent < 0 && errno == EINTR);
  return sent == 1;
}

/// False when the server has hung up.
bool receive_descriptors(int line, Given& given) {
  Parcel parcel;
  ssize_t got = 0;
  do got = ::recvmsg(line, &parcel.message, MSG_CMSG_CLOEXEC);
  while (got < 0 && errno == EINTR);
  const cmsghdr* head = got == 1 ? CMSG_FIRSTHDR(&parcel.message) : nullptr;
  if (head == nullptr || head->cmsg_type != SCM_RIGHTS || head->cmsg_len != CMSG_LEN(sizeof given))
    return false;
  std::memcpy(given.data(), CMSG_DATA(head), sizeof given);
  return true;
}

/// A copy of this process whose parent is the server. No library knows this call's flag; the process has one
/// thread, so that nothing is left locked in the copy.
pid_t copy_for_parent() {
  return static_cast<pid_t>(::syscall(SYS_clone, CLONE_PARENT | SIGCHLD, nullptr, nullptr, nullptr, nullptr));
}

void put_in_place(const Given& given) {
  Given high{};
  for (std::size_t i = 0; i < given.size(); ++i) high[i] = high_copy(given[i]).release();
  const auto [log, input, folder, status, request] = high;
  ::dup2(log, 1);
  ::dup2(log, 2);
  ::dup2(input, kInputDescriptor);
  ::dup2(folder, kFolderDescriptor);
  ::dup2(status, kStatusDescriptor);
  ::dup2(request, kRequestDescriptor);
  ::close_range(kRequestDescriptor + 1, ~0U, 0);
}

}  // namespace

Nursery::Nursery(const std::string& program) : nothing_(::open("/dev/null", O_RDONLY | O_CLOEXEC)) {
  int ends[2];
  if (!nothing_.valid() || ::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    throw std::system_error(errno, std::generic_category(), "nursery");
  line_.reset(ends[0]);
  const Descriptor first(ends[1]), other = high_copy(first.get());
  SpawnPlan plan;
  for (const int standard : {0, 1, 2}) plan.give(-1, standard);
  plan.give(other.get(), kInputDescriptor);
  for (const int unused : {kFolderDescriptor, kStatusDescriptor, kRequestDescriptor}) plan.give(-1, unused);
  pid_ = plan.start(program, "nursery");
}

Nursery::~Nursery() {
  line_.reset();
  ::kill(pid_, SIGKILL);
  while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) continue;
}

pid_t Nursery::begin(const ChildDescriptors& d) {
  Given given{d.log, d.input, d.folder, d.status, d.request};
  for (int& fd : given)
    if (fd < 0) fd = nothing_.get();
  const std::lock_guard lock(mutex_);
  if (!line_.valid()) return -1;
  pid_t pid = -1;
  if (!send_descriptors(line_.get(), given) ||
      ::recv(line_.get(), &pid, sizeof pid, 0) != static_cast<ssize_t>(sizeof pid)) {
    log_warning("the nursery is gone; children are started without it", {});
    line_.reset();
    return -1;
  }
  if (pid > 0) ::setpgid(pid, pid);  // whichever comes first, this or the child's own
  return pid;
}

int nursery_command() {
  const int line = kInputDescriptor;
  struct stat status {};
  if (::fstat(line, &status) != 0 || !S_ISSOCK(status.st_mode))
    throw Error(ErrorCode::kInvalidParameter, "`nursery` is started by the server only", "command line",
                "use `sheetform decompose`");
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  leave_network();  // once, and not by every copy
  for (Given given; receive_descriptors(line, given);) {
    const pid_t pid = copy_for_parent();
    if (pid == 0) {
      ::setpgid(0, 0);
      put_in_place(given);
      return worker_command();
    }
    for (const int fd : given) ::close(fd);
    if (::send(line, &pid, sizeof pid, MSG_NOSIGNAL) < 0) break;
  }
  return 0;
}

}  // namespace sheetform::server
