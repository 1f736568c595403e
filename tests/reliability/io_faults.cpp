// Preloaded into a server (LD_PRELOAD): makes syncs and writes fail or slow, the disk full and the clock
// jump, without any privilege. What to do is told by the environment; the jobs' processes do not inherit it.
//
//   FAULT_SYNC=N       the N-th fsync or fdatasync of the process fails with EIO,
//   FAULT_WRITE=N      or its N-th write to a file of that disk,
//   FAULT_ERROR=E      with this error instead,
//   FAULT_FORM=FORM    "once", "torn" (half of it is written before), "on" (and all writes after it)
//                      or "kill" (SIGKILL after half of it),
//   FAULT_FIRED=FILE   and the path of the file is added to this one
//   FAULT_WRITES=FILE  the path of every file that is written is added to this one
//   FAULT_SLOW=N       every sync takes N milliseconds more
//   FAULT_FULL=FILE    while it exists, no space is free and no file can be written
//   FAULT_FOLDER=PATH  on the device of this
//   FAULT_CLOCK=FILE   eight bytes, a number of nanoseconds that is added to the wall clock
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

namespace {

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

std::atomic<long> syncs{0}, writes{0};

/// Adds a line with the path of `fd` to the file that the variable `name` names.
void note(const char* name, int fd) {
  const char* file = std::getenv(name);
  if (file == nullptr) return;
  static auto* const real = next<ssize_t(int, const void*, size_t)>("write");
  char path[PATH_MAX + 1] = "";
  const ssize_t size = ::readlink(("/proc/self/fd/" + std::to_string(fd)).c_str(), path, PATH_MAX);
  const int to = ::open(file, O_CREAT | O_WRONLY | O_APPEND | O_CLOEXEC, 0600);
  if (size < 0 || to < 0) std::abort();
  path[size] = '\n';
  if (real(to, path, static_cast<size_t>(size) + 1) != size + 1) std::abort();
  ::close(to);
}

/// Whether this sync is the one that fails, after the time that it takes.
bool sync_fails(int fd) {
  static const char* const slow = std::getenv("FAULT_SLOW");
  if (slow != nullptr) ::usleep(static_cast<useconds_t>(std::atol(slow)) * 1000);
  static const char* const wanted = std::getenv("FAULT_SYNC");
  if (wanted == nullptr || ++syncs != std::atol(wanted)) return false;
  note("FAULT_FIRED", fd);
  errno = EIO;
  return true;
}

bool disk_is_full() {
  static const char* const flag = std::getenv("FAULT_FULL");
  return flag != nullptr && ::access(flag, F_OK) == 0;
}

bool on_that_disk(int fd) {
  static const dev_t device = [] {
    struct stat s {};
    const char* folder = std::getenv("FAULT_FOLDER");
    return folder != nullptr && ::stat(folder, &s) == 0 ? s.st_dev : dev_t{0};
  }();
  struct stat s {};
  return fd > 2 && ::fstat(fd, &s) == 0 && S_ISREG(s.st_mode) && s.st_dev == device;
}

enum class Fate { kGood, kFails, kTorn, kKilled };

/// What becomes of this write by its number.
Fate fate_by_number(int fd) {
  static const char* const wanted = std::getenv("FAULT_WRITE");
  static const char* const form = std::getenv("FAULT_FORM");
  static const char* const all = std::getenv("FAULT_WRITES");
  if ((wanted == nullptr && all == nullptr) || !on_that_disk(fd)) return Fate::kGood;
  note("FAULT_WRITES", fd);
  if (wanted == nullptr) return Fate::kGood;
  const long after = ++writes - std::atol(wanted);
  const std::string_view how = form == nullptr ? "once" : form;
  if (after == 0) note("FAULT_FIRED", fd);
  if (how == "kill") return after == 0 ? Fate::kKilled : Fate::kGood;
  if (how == "torn") return after == 0 ? Fate::kTorn : after == 1 ? Fate::kFails : Fate::kGood;
  return after == 0 || (how == "on" && after > 0) ? Fate::kFails : Fate::kGood;
}

int error_told() {
  static const char* const told = std::getenv("FAULT_ERROR");
  return told == nullptr ? EIO : std::atoi(told);
}

/// real(bytes) of a write of `size` bytes, or what comes in its place.
template <class Call>
ssize_t written(int fd, size_t size, Call&& real) {
  const int before = errno;
  const bool full = disk_is_full() && on_that_disk(fd);
  const Fate fate = full ? Fate::kFails : fate_by_number(fd);
  errno = before;
  if (fate == Fate::kGood) return real(size);
  if (fate == Fate::kKilled) {
    if (size > 1 && real(size / 2) < 0) std::abort();
    ::raise(SIGKILL);
  }
  if (fate == Fate::kTorn && size > 1) return real(size / 2);
  errno = full ? ENOSPC : error_told();
  return -1;
}

std::int64_t clock_offset() {
  static const std::int64_t* const offset = [] {
    static const std::int64_t none = 0;
    const char* file = std::getenv("FAULT_CLOCK");
    const int fd = file == nullptr ? -1 : ::open(file, O_RDONLY | O_CLOEXEC);
    if (fd < 0) return &none;
    void* place = ::mmap(nullptr, sizeof(std::int64_t), PROT_READ, MAP_SHARED, fd, 0);
    ::close(fd);
    return place == MAP_FAILED ? &none : static_cast<const std::int64_t*>(place);
  }();
  return *static_cast<const volatile std::int64_t*>(offset);
}

}  // namespace

extern "C" {

int fsync(int fd) {
  static auto* const real = next<int(int)>("fsync");
  return sync_fails(fd) ? -1 : real(fd);
}

int fdatasync(int fd) {
  static auto* const real = next<int(int)>("fdatasync");
  return sync_fails(fd) ? -1 : real(fd);
}

ssize_t write(int fd, const void* data, size_t size) {
  static auto* const real = next<ssize_t(int, const void*, size_t)>("write");
  return written(fd, size, [&](size_t count) { return real(fd, data, count); });
}

ssize_t pwrite(int fd, const void* data, size_t size, off_t at) {
  static auto* const real = next<ssize_t(int, const void*, size_t, off_t)>("pwrite");
  return written(fd, size, [&](size_t count) { return real(fd, data, count, at); });
}

ssize_t pwrite64(int fd, const void* data, size_t size, off64_t at) { return pwrite(fd, data, size, at); }

int statvfs(const char* path, struct statvfs* space) noexcept {
  static auto* const real = next<int(const char*, struct statvfs*)>("statvfs");
  const int answer = real(path, space);
  if (disk_is_full()) space->f_bavail = space->f_bfree = 0;
  return answer;
}

int clock_gettime(clockid_t clock, struct timespec* now) noexcept {
  static auto* const real = next<int(clockid_t, struct timespec*)>("clock_gettime");
  const int answer = real(clock, now);
  if (clock != CLOCK_REALTIME || answer != 0) return answer;
  const std::int64_t moved = now->tv_sec * 1'000'000'000 + now->tv_nsec + clock_offset();
  now->tv_sec = moved / 1'000'000'000;
  now->tv_nsec = moved % 1'000'000'000;
  return answer;
}

}  // extern "C"
