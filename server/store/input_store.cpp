#include "server/store/input_store.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>
#include <system_error>

#include "server/base/identity.h"
#include "server/store/store_error.h"

namespace sheetform::server {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kBuffer = 1 << 18;
constexpr std::size_t kDirect = 1 << 16;  // pieces of this size are worth a call each
constexpr int kPartFolders = 256;         // named by the first byte of a digest

[[noreturn]] void refuse(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

void write_all(int fd, std::string_view bytes) {
  if (!write_whole(fd, bytes)) refuse("the upload could not be written");
}

void sync_or_end(int fd, const char* what) {
  if (::fsync(fd) != 0) end_after_storage_failure(std::string("fsync of ") + what);
}

void sync_folder(const fs::path& folder) {
  const Descriptor d(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!d.valid()) refuse("a folder of the store could not be opened");
  sync_or_end(d.get(), "a folder");
}

std::int64_t changed_at(const fs::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return INT64_MAX;
  return static_cast<std::int64_t>(status.st_mtim.tv_sec) * 1'000'000 + status.st_mtim.tv_nsec / 1000;
}

}  // namespace

Upload::Upload(const fs::path& spool_folder)
    : path_(spool_folder / (make_uuid() + ".part")),
      file_(::open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600)) {
  if (!file_.valid()) refuse("the upload could not be begun");
}

Upload::~Upload() {
  if (!path_.empty()) ::unlink(path_.c_str());
}

void Upload::add(std::string_view bytes) {
  hash_.add(bytes);
  bytes_ += bytes.size();
  if (buffer_.empty() && bytes.size() >= kDirect) return write_all(file_.get(), bytes);
  buffer_.append(bytes);
  if (buffer_.size() >= kBuffer) flush();
}

void Upload::flush() {
  write_all(file_.get(), buffer_);
  buffer_.clear();
}

const std::string& Upload::finish() {
  flush();
  if (digest_.empty()) digest_ = hash_.finish();
  return digest_;
}

InputStore::InputStore(const fs::path& data) : spool_(data / "spool"), folder_(data / "blobs" / "in") {
  fs::create_directories(spool_);
  fs::create_directories(folder_);
  for (const fs::directory_entry& entry : fs::directory_iterator(spool_))
    if (entry.path().extension() == ".part") fs::remove(entry.path());
  try {
    make_part_folders();
  } catch (const std::system_error& e) {
    if (e.code() != std::errc::no_space_on_device) throw;  // what is stored can be read on a full disk
  }
  // The folders must outlive a power cut as well as what is put into them.
  for (const fs::path& folder : {folder_.parent_path(), data}) sync_folder(folder);
}

fs::path InputStore::path_of(const std::string& digest) const {
  const std::string hex = to_hex(digest);
  return folder_ / hex.substr(0, 2) / hex;
}

/// All at once, so that no upload waits for a folder. One that is there already may have been made by a
/// server that was killed before it could sync it.
void InputStore::make_part_folders() const {
  for (int i = 0; i < kPartFolders; ++i) {
    const fs::path part = folder_ / to_hex(std::string(1, static_cast<char>(i)));
    if (::mkdir(part.c_str(), 0700) != 0 && errno != EEXIST) refuse("the upload could not be stored");
  }
  sync_folder(folder_);
}

/// False when there is such a file already.
bool InputStore::name(const Upload& upload, const fs::path& target) const {
  int linked = ::link(upload.path_.c_str(), target.c_str());
  if (linked != 0 && errno == ENOENT) {  // the disk was full when the server started
    make_part_folders();
    linked = ::link(upload.path_.c_str(), target.c_str());
  }
  if (linked != 0 && errno != EEXIST) refuse("the upload could not be stored");
  return linked == 0;
}

void InputStore::keep(Upload& upload) {
  const fs::path target = path_of(upload.finish());
  if (::fdatasync(upload.file_.get()) != 0) {
    if (errno == ENOSPC || errno == EDQUOT) refuse("the upload could not be stored");
    end_after_storage_failure("fdatasync of an upload");
  }
  // The same bytes that are there already are fresh again: the collector leaves them to the job that comes
  // now.
  if (!name(upload, target) && ::utimensat(AT_FDCWD, target.c_str(), nullptr, 0) != 0)
    refuse("the upload could not be stored");
  sync_folder(target.parent_path());
}

Descriptor InputStore::open(const std::string& digest) const {
  Descriptor input(::open(path_of(digest).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  if (!input.valid() && errno != ENOENT)
    throw std::system_error(errno, std::generic_category(), "an uploaded mesh could not be opened");
  return input;
}

void InputStore::drop(const std::string& digest) { ::unlink(path_of(digest).c_str()); }

std::vector<std::string> InputStore::older_than(std::int64_t oldest, std::size_t limit) const {
  std::vector<std::string> list;
  std::error_code gone;
  for (const fs::directory_entry& part : fs::directory_iterator(folder_, gone)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(part.path(), gone)) {
      std::string digest;
      if (list.size() < limit && from_hex(entry.path().filename().string(), digest) &&
          changed_at(entry.path()) < oldest)
        list.push_back(digest);
    }
  }
  return list;
}

}  // namespace sheetform::server
