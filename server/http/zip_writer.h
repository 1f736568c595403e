// A zip archive of files that are there already, made while it is sent: nothing is compressed, so every
// byte's place is known beforehand, and the whole has a length.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace sheetform::server {

struct ZipMember {
  std::string name;
  std::uint64_t bytes = 0;
  std::uint32_t crc = 0;
  std::function<std::string(std::uint64_t offset, std::uint64_t most)> read;
};

/// CRC-32 of more bytes after those that gave `before` (0 at the start).
std::uint32_t crc32_of(std::string_view bytes, std::uint32_t before = 0);

class ZipArchive {
 public:
  /// seconds: time of all members, since 1970. Sizes below 4 GiB.
  ZipArchive(std::vector<ZipMember> members, std::int64_t seconds);
  std::uint64_t length() const { return length_; }
  /// Some bytes from `offset` on, at least one.
  std::string read(std::uint64_t offset, std::uint64_t most) const;

 private:
  std::vector<ZipMember> members_;
  std::vector<std::string> heads_;     ///< local header of each member
  std::vector<std::uint64_t> begins_;  ///< of each local header
  std::string directory_;
  std::uint64_t length_ = 0;
};

}  // namespace sheetform::server
