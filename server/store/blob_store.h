// Results by content: chunks in a database file of their own, so that a large result never delays an upload.
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace sheetform::server {

class BlobStore {
 public:
  /// Opens or creates the file. Throws StoreError.
  explicit BlobStore(const std::filesystem::path& path);
  ~BlobStore();
  BlobStore(const BlobStore&) = delete;
  BlobStore& operator=(const BlobStore&) = delete;

  /// Stores the first `bytes` bytes of an open file under their SHA-256; reads it twice and checks both
  /// times. On return the bytes are on stable storage. Throws StoreError, and std::runtime_error when the
  /// file changes or ends.
  std::string put_file(int fd, std::uint64_t bytes);
  /// Up to `count` bytes from `offset`; shorter only at the end. Empty when there is no such blob or offset.
  std::string read(const std::string& digest, std::uint64_t offset, std::uint64_t count) const;
  bool has(const std::string& digest) const;
  /// Removes a blob, a few chunks at a time.
  void drop(const std::string& digest);
  /// Digests that are stored (whole or in part), in their order, after `after`.
  std::vector<std::string> digests(const std::string& after, int limit) const;
  /// Gives freed pages back to the file system.
  void shrink();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sheetform::server
