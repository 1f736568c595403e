// Preloaded into a server (LD_PRELOAD): writes down, in the order in which they happen, the calls that change
// files on the disk of TRACE_FOLDER, the syncs, and the beginnings of what is sent to clients. power.py
// replays that log with everything dropped that was not synced. The jobs' processes do not inherit it.
//   TRACE_FILE=FILE      the log: records of Head and its bytes, see power.py
//   TRACE_FOLDER=FOLDER  what is traced
// Calls inside of the C library (fopen's open) are not seen: whether all was seen is checked by power.py,
// which compares the replay of the whole log with the real files.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string>
#include <string_view>

namespace {

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

/// Letters of the log's records.
enum class Op : char {
  kFile = 'f',      ///< a new file: inode, path
  kFolder = 'd',    ///< a new folder: inode, path
  kLink = 'l',      ///< another name: inode, path
  kRename = 'r',    ///< path, new path
  kRemove = 'u',    ///< path
  kWrite = 'w',     ///< inode, offset, bytes
  kTruncate = 't',  ///< inode, offset is the size
  kSync = 's',      ///< inode, path (that of a folder names it)
  kSend = 'o',      ///< descriptor of a client, the beginning of what goes there
};

struct __attribute__((packed)) Head {
  char op;
  std::uint64_t inode, offset;
  std::uint32_t first, second;  ///< bytes that follow
};

constexpr std::size_t kSendBytes = 8192;  // the head of an answer and a status document

/// One change at a time, so that the log has the order of the disk.
std::recursive_mutex& order() {
  static auto* const mutex = new std::recursive_mutex;
  return *mutex;
}

int log_file() {
  static const int fd = [] {
    const char* path = std::getenv("TRACE_FILE");
    if (path == nullptr) return -1;
    const int low =
        next<int(const char*, int, ...)>("open64")(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    return ::fcntl(low, F_DUPFD_CLOEXEC, 500);  // out of the way of those that the server numbers itself
  }();
  return fd;
}

void record(Op op, std::uint64_t inode, std::uint64_t offset, std::string_view first,
            std::string_view second = {}) {
  const int before = errno;
  Head head{static_cast<char>(op), inode, offset, static_cast<std::uint32_t>(first.size()),
            static_cast<std::uint32_t>(second.size())};
  std::string bytes(reinterpret_cast<const char*>(&head), sizeof head);
  bytes.append(first).append(second);
  static auto* const real = next<ssize_t(int, const void*, size_t)>("write");
  if (real(log_file(), bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) std::abort();
  errno = before;
}

std::string path_of(int fd) {
  char path[PATH_MAX];
  const ssize_t size = ::readlink(("/proc/self/fd/" + std::to_string(fd)).c_str(), path, sizeof path);
  return size < 0 ? std::string() : std::string(path, static_cast<std::size_t>(size));
}

/// The absolute path that `path` means for a call on `folder`.
std::string absolute(int folder, const char* path) {
  if (path[0] == '/') return path;
  char here[PATH_MAX];
  if (folder == AT_FDCWD) return std::string(::getcwd(here, sizeof here)) + "/" + path;
  return path_of(folder) + "/" + path;
}

bool traced(const std::string& path) {
  static const std::string folder = [] {
    const char* named = std::getenv("TRACE_FOLDER");
    return named == nullptr ? std::string("/nowhere") : std::string(named);
  }();
  return log_file() >= 0 && path.size() >= folder.size() && path.compare(0, folder.size(), folder) == 0;
}

struct stat status_of(int fd) {
  struct stat s {};
  ::fstat(fd, &s);
  return s;
}

struct stat status_of(const std::string& path) {
  struct stat s {};
  ::lstat(path.c_str(), &s);
  return s;
}

/// An open, which may make or empty a file.
int traced_open(int folder, const char* path, int flags, mode_t mode) {
  static auto* const real = next<int(int, const char*, int, ...)>("openat64");
  const bool changes = (flags & (O_CREAT | O_TRUNC)) != 0 && (flags & O_TMPFILE) != O_TMPFILE;
  const std::string whole = changes ? absolute(folder, path) : std::string();
  if (!changes || !traced(whole)) return real(folder, path, flags, mode);
  const std::lock_guard lock(order());
  const bool there = ::faccessat(AT_FDCWD, whole.c_str(), F_OK, AT_SYMLINK_NOFOLLOW) == 0;
  const int fd = real(folder, path, flags, mode);
  if (fd < 0) return fd;
  const std::uint64_t inode = status_of(fd).st_ino;
  if (!there)
    record(Op::kFile, inode, 0, whole);
  else if ((flags & O_TRUNC) != 0)
    record(Op::kTruncate, inode, 0, {});
  return fd;
}

/// A call on a descriptor that changes or syncs a file; `note` writes it down when the call went well.
template <class Call, class Note>
auto traced_call(int fd, Call&& real, Note&& note) {
  const std::string path = path_of(fd);
  if (!traced(path)) return real();
  const std::lock_guard lock(order());
  const auto answer = real();
  if (answer >= 0) note(answer, static_cast<std::uint64_t>(status_of(fd).st_ino), path);
  return answer;
}

/// A call that changes names.
template <class Call, class Note>
int traced_names(const std::string& path, Call&& real, Note&& note) {
  if (!traced(path)) return real();
  const std::lock_guard lock(order());
  const int answer = real();
  if (answer == 0) note();
  return answer;
}

void note_send(int fd, const void* data, size_t size) {
  if (log_file() < 0 || !S_ISSOCK(status_of(fd).st_mode)) return;
  const std::lock_guard lock(order());
  record(Op::kSend, static_cast<std::uint64_t>(fd), 0,
         {static_cast<const char*>(data), std::min(size, kSendBytes)});
}

/// The third argument of open, which is there when a file may be made.
mode_t mode_of(int flags, va_list list) { return (flags & O_CREAT) != 0 ? va_arg(list, mode_t) : 0; }

ssize_t traced_pwrite(int fd, const void* data, size_t size, off_t at) {
  static auto* const real = next<ssize_t(int, const void*, size_t, off_t)>("pwrite64");
  return traced_call(
      fd, [&] { return real(fd, data, size, at); },
      [&](ssize_t put, std::uint64_t inode, const std::string&) {
        record(Op::kWrite, inode, static_cast<std::uint64_t>(at),
               {static_cast<const char*>(data), static_cast<std::size_t>(put)});
      });
}

template <class Call>
int traced_sync(int fd, Call&& real) {
  return traced_call(
      fd, real, [](int, std::uint64_t inode, const std::string& path) { record(Op::kSync, inode, 0, path); });
}

int traced_truncate(int fd, off_t size) {
  static auto* const real = next<int(int, off_t)>("ftruncate64");
  return traced_call(
      fd, [&] { return real(fd, size); },
      [&](int, std::uint64_t inode, const std::string&) {
        record(Op::kTruncate, inode, static_cast<std::uint64_t>(size), {});
      });
}

template <class Call>
int traced_remove(const std::string& path, Call&& real) {
  return traced_names(path, real, [&] { record(Op::kRemove, 0, 0, path); });
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list list;
  va_start(list, flags);
  const mode_t mode = mode_of(flags, list);
  va_end(list);
  return traced_open(AT_FDCWD, path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  va_list list;
  va_start(list, flags);
  const mode_t mode = mode_of(flags, list);
  va_end(list);
  return traced_open(AT_FDCWD, path, flags, mode);
}
int openat(int folder, const char* path, int flags, ...) {
  va_list list;
  va_start(list, flags);
  const mode_t mode = mode_of(flags, list);
  va_end(list);
  return traced_open(folder, path, flags, mode);
}
int openat64(int folder, const char* path, int flags, ...) {
  va_list list;
  va_start(list, flags);
  const mode_t mode = mode_of(flags, list);
  va_end(list);
  return traced_open(folder, path, flags, mode);
}

ssize_t write(int fd, const void* data, size_t size) {
  static auto* const real = next<ssize_t(int, const void*, size_t)>("write");
  return traced_call(
      fd, [&] { return real(fd, data, size); },
      [&](ssize_t put, std::uint64_t inode, const std::string&) {
        const off_t end = ::lseek(fd, 0, SEEK_CUR);
        record(Op::kWrite, inode, static_cast<std::uint64_t>(end - put),
               {static_cast<const char*>(data), static_cast<std::size_t>(put)});
      });
}
ssize_t pwrite(int fd, const void* data, size_t size, off_t at) { return traced_pwrite(fd, data, size, at); }
ssize_t pwrite64(int fd, const void* data, size_t size, off64_t at) {
  return traced_pwrite(fd, data, size, at);
}
int ftruncate(int fd, off_t size) noexcept { return traced_truncate(fd, size); }
int ftruncate64(int fd, off64_t size) noexcept { return traced_truncate(fd, size); }

int fsync(int fd) {
  static auto* const real = next<int(int)>("fsync");
  return traced_sync(fd, [&] { return real(fd); });
}
int fdatasync(int fd) {
  static auto* const real = next<int(int)>("fdatasync");
  return traced_sync(fd, [&] { return real(fd); });
}

int mkdir(const char* path, mode_t mode) noexcept {
  static auto* const real = next<int(const char*, mode_t)>("mkdir");
  const std::string whole = absolute(AT_FDCWD, path);
  return traced_names(
      whole, [&] { return real(path, mode); },
      [&] { record(Op::kFolder, status_of(whole).st_ino, 0, whole); });
}
int link(const char* from, const char* to) noexcept {
  static auto* const real = next<int(const char*, const char*)>("link");
  const std::string whole = absolute(AT_FDCWD, to);
  return traced_names(
      whole, [&] { return real(from, to); }, [&] { record(Op::kLink, status_of(whole).st_ino, 0, whole); });
}
int rename(const char* from, const char* to) noexcept {
  static auto* const real = next<int(const char*, const char*)>("rename");
  const std::string whole = absolute(AT_FDCWD, to);
  return traced_names(
      whole, [&] { return real(from, to); },
      [&] { record(Op::kRename, 0, 0, absolute(AT_FDCWD, from), whole); });
}
int unlink(const char* path) noexcept {
  static auto* const real = next<int(const char*)>("unlink");
  return traced_remove(absolute(AT_FDCWD, path), [&] { return real(path); });
}
int rmdir(const char* path) noexcept {
  static auto* const real = next<int(const char*)>("rmdir");
  return traced_remove(absolute(AT_FDCWD, path), [&] { return real(path); });
}
int remove(const char* path) noexcept {
  static auto* const real = next<int(const char*)>("remove");
  return traced_remove(absolute(AT_FDCWD, path), [&] { return real(path); });
}
int unlinkat(int folder, const char* path, int flags) noexcept {
  static auto* const real = next<int(int, const char*, int)>("unlinkat");
  return traced_remove(absolute(folder, path), [&] { return real(folder, path, flags); });
}

ssize_t send(int fd, const void* data, size_t size, int flags) {
  static auto* const real = next<ssize_t(int, const void*, size_t, int)>("send");
  note_send(fd, data, size);  // before it goes: the promise is made here at the latest
  return real(fd, data, size, flags);
}

}  // extern "C"
