#include "server/jobs/sandbox.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <vector>

#include "server/base/descriptor.h"

namespace sheetform::server {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;  // their shadow memory needs terabytes of address space
#else
constexpr bool kSanitized = false;
#endif

void limit(__rlimit_resource what, std::uint64_t value) {
  const struct rlimit both { value, value };
  ::setrlimit(what, &both);
}

/// The kernel's out-of-memory killer takes this process before the server.
void offer_to_oom_killer() {
  const Descriptor file(::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC));
  if (file.valid() && ::write(file.get(), "1000", 4) != 4) return;  // not allowed here: no harm
}

constexpr std::uint64_t kWriting = LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_READ_FILE |
                                   LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_REMOVE_FILE;
/// Every right of the first version of Landlock.
constexpr std::uint64_t kAllRights = (LANDLOCK_ACCESS_FS_MAKE_SYM << 1) - 1;

bool close_files(int folder) {
  landlock_ruleset_attr rules{};
  rules.handled_access_fs = kAllRights;
  const Descriptor ruleset(static_cast<int>(::syscall(SYS_landlock_create_ruleset, &rules, sizeof rules, 0)));
  if (!ruleset.valid()) return false;
  landlock_path_beneath_attr below{};
  below.allowed_access = kWriting;
  below.parent_fd = folder;
  if (folder >= 0 &&
      ::syscall(SYS_landlock_add_rule, ruleset.get(), LANDLOCK_RULE_PATH_BENEATH, &below, 0) != 0 &&
      errno != EBADFD && errno != EINVAL)
    return false;
  return ::syscall(SYS_landlock_restrict_self, ruleset.get(), 0) == 0;
}

#if defined(__x86_64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#else
#error "the system calls of this architecture are not known; add them here"
#endif

constexpr long kForbidden[] = {SYS_socket,
                               SYS_socketpair,
                               SYS_connect,
                               SYS_bind,
                               SYS_listen,
                               SYS_accept,
                               SYS_accept4,
                               SYS_sendto,
                               SYS_sendmsg,
                               SYS_sendmmsg,
                               SYS_execve,
                               SYS_execveat,
#ifdef SYS_fork
                               SYS_fork,
                               SYS_vfork,
#endif
                               SYS_ptrace,
                               SYS_process_vm_readv,
                               SYS_process_vm_writev,
                               SYS_io_uring_setup,
                               SYS_io_uring_enter,
                               SYS_io_uring_register,
                               SYS_bpf,
                               SYS_perf_event_open,
                               SYS_userfaultfd,
                               SYS_keyctl,
                               SYS_add_key,
                               SYS_request_key,
                               SYS_mount,
                               SYS_umount2,
                               SYS_setns,
                               SYS_unshare,
                               SYS_pivot_root,
                               SYS_chroot,
                               SYS_kill,
                               SYS_tkill,
                               SYS_pidfd_send_signal,
                               SYS_pidfd_getfd,
                               SYS_rt_sigqueueinfo,
                               SYS_rt_tgsigqueueinfo,
                               SYS_open_by_handle_at,
                               SYS_name_to_handle_at,
                               SYS_kexec_load,
                               SYS_init_module,
                               SYS_finit_module,
                               SYS_delete_module,
                               SYS_reboot,
                               SYS_swapon,
                               SYS_swapoff,
                               SYS_sethostname,
                               SYS_setdomainname,
                               SYS_settimeofday,
                               SYS_clock_settime,
                               SYS_acct,
                               SYS_quotactl,
                               SYS_personality,
                               SYS_shmget,
                               SYS_msgget,
                               SYS_semget};

/// A filter of system calls, written down as the kernel's little machine takes it.
class Filter {
 public:
  void add(std::uint16_t code, std::uint32_t value, std::uint8_t yes = 0, std::uint8_t no = 0) {
    program_.push_back(sock_filter{code, yes, no, value});
  }
  void load(std::size_t offset) { add(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset)); }
  void answer(std::uint32_t value) { add(BPF_RET | BPF_K, value); }
  /// When the loaded word equals `value`: answer, else go on.
  void answer_if(std::uint32_t value, std::uint32_t what) {
    add(BPF_JMP | BPF_JEQ | BPF_K, value, 0, 1);
    answer(what);
  }
  bool install() {
    sock_fprog program{static_cast<unsigned short>(program_.size()), program_.data()};
    return ::syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, 0, &program) == 0;
  }

 private:
  std::vector<sock_filter> program_;
};

constexpr std::uint32_t kRefuse = SECCOMP_RET_ERRNO | EPERM;
constexpr std::size_t kFirstArgument =
    offsetof(seccomp_data, args);  // its low half, on little-endian machines

bool close_calls() {
  Filter f;
  f.load(offsetof(seccomp_data, arch));
  f.add(BPF_JMP | BPF_JEQ | BPF_K, kArchitecture, 1, 0);
  f.answer(SECCOMP_RET_KILL_PROCESS);
  f.load(offsetof(seccomp_data, nr));
#if defined(__x86_64__)
  f.add(BPF_JMP | BPF_JGE | BPF_K, 0x40000000, 0, 1);  // the x32 twins of all calls
  f.answer(SECCOMP_RET_KILL_PROCESS);
#endif
  for (const long call : kForbidden) f.answer_if(static_cast<std::uint32_t>(call), kRefuse);
  // The C library falls back to clone, whose flags can be seen from here: threads yes, processes no.
  f.answer_if(SYS_clone3, SECCOMP_RET_ERRNO | ENOSYS);
  f.add(BPF_JMP | BPF_JEQ | BPF_K, SYS_clone, 0, 4);
  f.load(kFirstArgument);
  f.add(BPF_JMP | BPF_JSET | BPF_K, CLONE_THREAD, 1, 0);
  f.answer(kRefuse);
  f.answer(SECCOMP_RET_ALLOW);
  // abort() raises its signal through tgkill; to this process only.
  f.add(BPF_JMP | BPF_JEQ | BPF_K, SYS_tgkill, 0, 3);
  f.load(kFirstArgument);
  f.add(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(::getpid()), 1, 0);
  f.answer(kRefuse);
  f.answer(SECCOMP_RET_ALLOW);
  return f.install();
}

/// Whether a call that must fail did fail with `EPERM` or `EACCES`.
bool refused(long answer) { return answer < 0 && (errno == EPERM || errno == EACCES); }

bool refused_open(const char* path, int flags) {
  const Descriptor file(::open(path, flags | O_CLOEXEC, 0600));
  return refused(file.get());
}

bool can_write_below(int folder) {
  const Descriptor file(::openat(folder, "probe", O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
  const bool good = file.valid() && ::write(file.get(), "x", 1) == 1;
  ::unlinkat(folder, "probe", 0);
  return good;
}

}  // namespace

SandboxLimits limits_of(const WorkerRequest& request) {
  return {request.memory, request.file_bytes, request.cpu_seconds, request.parent,
          request.mode != WorkerMode::kDecompose && request.mode != WorkerMode::kSweep};
}

void lower_process(const SandboxLimits& limits) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  // The parent died before the line above. In a container it may well be process 1.
  if (limits.parent > 0 && ::getppid() != limits.parent) ::_exit(70);
  ::prctl(PR_SET_DUMPABLE, 0);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_NOFILE, 64);
  if (limits.memory > 0 && !kSanitized) limit(RLIMIT_AS, limits.memory);
  if (limits.file_bytes > 0) limit(RLIMIT_FSIZE, limits.file_bytes);
  if (limits.cpu_seconds > 0) limit(RLIMIT_CPU, static_cast<std::uint64_t>(limits.cpu_seconds));
  ::signal(SIGXFSZ, SIG_IGN);  // writes past the limit fail with EFBIG instead
  ::setpriority(PRIO_PROCESS, 0, ::getpriority(PRIO_PROCESS, 0) + (limits.awaited ? 5 : 10));
  constexpr int kBestEffort = 2 << 13;
  ::syscall(SYS_ioprio_set, 1, 0, kBestEffort | 7);
  offer_to_oom_killer();
}

bool leave_network() {
  static bool left = false;  // also in the copies of a process that has left it
  left = left || ::unshare(CLONE_NEWNET) == 0;
  return left;
}

SandboxState close_in(int folder) {
  SandboxState state;
  state.network = leave_network();  // only with privileges; the filter below needs none
  ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  state.landlock = close_files(folder);
  state.seccomp = close_calls();
  return state;
}

api::Json probe_sandbox(int folder) {
  api::Json answer{{"read", refused_open("/etc/passwd", O_RDONLY)},
                   {"device", refused_open("/dev/zero", O_RDONLY)},
                   {"write", refused_open("/tmp/sheetform-probe", O_WRONLY | O_CREAT)},
                   {"socket", refused(::socket(AF_INET, SOCK_STREAM, 0))},
                   {"unixSocket", refused(::socket(AF_UNIX, SOCK_STREAM, 0))},
                   {"kill", refused(::kill(::getppid(), 0))},
                   {"writesBelowFolder", can_write_below(folder)}};
  char* const nothing[] = {nullptr};
  answer["exec"] = refused(::execve("/bin/true", nothing, nothing));
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  answer["fork"] = refused(child);
  answer["bigFile"] = [&] {
    const Descriptor file(::openat(folder, "probe-big", O_WRONLY | O_CREAT | O_CLOEXEC, 0600));
    const bool stopped = ::pwrite(file.get(), "x", 1, off_t{1} << 40) < 0 && errno == EFBIG;
    ::unlinkat(folder, "probe-big", 0);
    return stopped;
  }();
  return answer;
}

}  // namespace sheetform::server
