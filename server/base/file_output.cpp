#include "server/base/file_output.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "server/base/descriptor.h"
#include "sheetform/base/error.h"

namespace sheetform::server {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const char* what, const fs::path& path) {
  throw FileError(std::string(what) + " " + path.string() + ": " + std::strerror(errno));
}

[[noreturn]] void refuse_sync(const fs::path& path) {
  throw SyncError("cannot sync " + path.string() + ": " + std::strerror(errno));
}

[[noreturn]] void unreadable(const std::string& what, const fs::path& path) {
  throw Error(ErrorCode::kUnreadableMesh, what, path.string(), "check the path");
}

fs::path temporary(const fs::path& folder, const OutputFile& file) {
  return folder / ("." + file.name + ".part" + std::to_string(::getpid()));
}

void remove_all_of(const std::vector<fs::path>& paths) {
  std::error_code ignored;
  for (const fs::path& p : paths) fs::remove(p, ignored);
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw FileError("cannot make the folder " + folder.string() + ": " + error.message());
}

void sync_file(const fs::path& path) {
  const Descriptor d(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  if (d.get() < 0 || ::fsync(d.get()) != 0) refuse_sync(path);
}

}  // namespace

void keep_files_private() { ::umask(S_IRWXG | S_IRWXO); }

void make_folder_synced(const fs::path& folder) {
  fs::path whole = fs::absolute(folder).lexically_normal();
  if (!whole.has_filename()) whole = whole.parent_path();
  std::vector<fs::path> names{whole};
  for (fs::path above = whole.parent_path(); !fs::exists(above); above = above.parent_path())
    names.push_back(above);
  make_folder(whole);
  for (const fs::path& name : names)
    if (::access(name.parent_path().c_str(), R_OK) == 0) sync_folder(name.parent_path());
}

void sync_folder(const fs::path& folder) {
  const Descriptor d(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (d.get() < 0 || ::fsync(d.get()) != 0) refuse_sync(folder);
}

void sync_tree(const fs::path& root) {
  sync_folder(root);
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root)) {
    if (entry.is_directory())
      sync_folder(entry.path());
    else
      sync_file(entry.path());
  }
}

std::string read_input_file(const fs::path& path, std::uint64_t limit) {
  const Descriptor d(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (d.get() < 0) unreadable(std::string("the file cannot be opened: ") + std::strerror(errno), path);
  struct stat status {};
  if (::fstat(d.get(), &status) != 0 || S_ISDIR(status.st_mode))
    unreadable("this is a folder, not a file", path);
  std::string bytes;
  char buffer[1 << 16];
  for (;;) {
    const ssize_t got = ::read(d.get(), buffer, sizeof buffer);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) unreadable(std::string("the file cannot be read: ") + std::strerror(errno), path);
    if (got == 0) return bytes;
    bytes.append(buffer, static_cast<std::size_t>(got));
    if (bytes.size() > limit)
      throw Error(ErrorCode::kLimitExceeded, "the file has more than " + std::to_string(limit >> 20) + " MiB",
                  path.string(), "simplify the mesh, or store it in a binary format");
  }
}

void write_synced(const fs::path& path, const std::string& content) {
  const Descriptor d(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0644));
  if (d.get() < 0) refuse("cannot write", path);
  if (!write_whole(d.get(), content)) refuse("cannot write", path);
  if (::fsync(d.get()) != 0) refuse_sync(path);
}

void write_files(const fs::path& folder, const std::vector<OutputFile>& files) {
  make_folder(folder);
  std::vector<fs::path> parts;
  try {
    for (const OutputFile& file : files) {
      parts.push_back(temporary(folder, file));
      write_synced(parts.back(), file.content);
    }
    for (std::size_t i = 0; i < files.size(); ++i)
      if (::rename(parts[i].c_str(), (folder / files[i].name).c_str()) != 0)
        refuse("cannot write", folder / files[i].name);
    sync_folder(folder);
  } catch (const FileError&) {
    remove_all_of(parts);
    throw;
  }
}

}  // namespace sheetform::server
