// Uploaded meshes by content, as files: the job's child process reads them through a descriptor.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "server/base/descriptor.h"
#include "server/base/digest.h"

namespace sheetform::server {

/// An upload on its way to stable storage. Dropping it removes the bytes.
class Upload {
 public:
  /// Throws std::system_error (ENOSPC and the like).
  explicit Upload(const std::filesystem::path& spool_folder);
  ~Upload();
  Upload(const Upload&) = delete;
  Upload& operator=(const Upload&) = delete;

  void add(std::string_view bytes);  ///< throws std::system_error
  std::uint64_t bytes() const { return bytes_; }
  int descriptor() const { return file_.get(); }
  /// Ends the writing; the SHA-256 of all bytes.
  const std::string& finish();

 private:
  friend class InputStore;
  std::filesystem::path path_;
  Descriptor file_;
  Sha256 hash_;
  std::string digest_, buffer_;
  std::uint64_t bytes_ = 0;
  void flush();
};

class InputStore {
 public:
  /// Makes the folders below `data` and removes what unfinished uploads left.
  explicit InputStore(const std::filesystem::path& data);

  const std::filesystem::path& spool() const { return spool_; }
  /// Puts a finished upload under its digest: data synced, linked, folder synced, in this order. A failed
  /// sync ends the process. Throws std::system_error when the disk is full.
  void keep(Upload& upload);
  /// Read-only; not valid when there is none. Throws std::system_error when that cannot be told.
  Descriptor open(const std::string& digest) const;
  void drop(const std::string& digest);
  /// Digests of files last changed before `oldest` (microseconds since 1970), at most `limit`.
  std::vector<std::string> older_than(std::int64_t oldest, std::size_t limit) const;

 private:
  std::filesystem::path path_of(const std::string& digest) const;
  void make_part_folders() const;
  bool name(const Upload& upload, const std::filesystem::path& target) const;

  std::filesystem::path spool_, folder_;
};

}  // namespace sheetform::server
