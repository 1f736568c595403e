#include "server/http/zip_writer.h"

#include <algorithm>
#include <array>
#include <ctime>

namespace sheetform::server {
namespace {

constexpr std::uint16_t kVersion20 = 20, kUtf8Names = 0x0800;

std::string little(std::uint64_t value, int bytes) {
  std::string out;
  for (int i = 0; i < bytes; ++i) out += static_cast<char>(value >> (8 * i));
  return out;
}

/// Date and time as MS-DOS wrote them: two-second steps since 1980.
std::string dos_time(std::int64_t seconds) {
  const std::time_t time = seconds;
  std::tm utc{};
  gmtime_r(&time, &utc);
  const int clock = utc.tm_hour << 11 | utc.tm_min << 5 | utc.tm_sec / 2;
  const int date = std::max(0, utc.tm_year - 80) << 9 | (utc.tm_mon + 1) << 5 | utc.tm_mday;
  return little(static_cast<std::uint64_t>(clock), 2) + little(static_cast<std::uint64_t>(date), 2);
}

/// What local header and directory entry have in common.
std::string common(const ZipMember& m, const std::string& time) {
  return little(kVersion20, 2) + little(kUtf8Names, 2) + little(0, 2) + time + little(m.crc, 4) +
         little(m.bytes, 4) + little(m.bytes, 4) + little(m.name.size(), 2) + little(0, 2);
}

std::string local_header(const ZipMember& m, const std::string& time) {
  return little(0x04034b50, 4) + common(m, time) + m.name;
}

std::string directory_entry(const ZipMember& m, const std::string& time, std::uint64_t begin) {
  return little(0x02014b50, 4) + little(kVersion20, 2) + common(m, time) + little(0, 2) + little(0, 2) +
         little(0, 2) + little(0, 4) + little(begin, 4) + m.name;
}

std::string directory_end(std::size_t members, std::uint64_t bytes, std::uint64_t begin) {
  return little(0x06054b50, 4) + little(0, 4) + little(members, 2) + little(members, 2) + little(bytes, 4) +
         little(begin, 4) + little(0, 2);
}

constexpr std::array<std::uint32_t, 256> make_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t value = i;
    for (int bit = 0; bit < 8; ++bit) value = value & 1 ? 0xedb88320u ^ value >> 1 : value >> 1;
    table[i] = value;
  }
  return table;
}
constexpr std::array<std::uint32_t, 256> kCrcTable = make_table();

}  // namespace

std::uint32_t crc32_of(std::string_view bytes, std::uint32_t before) {
  std::uint32_t value = ~before;
  for (const char c : bytes) value = kCrcTable[(value ^ static_cast<unsigned char>(c)) & 0xff] ^ value >> 8;
  return ~value;
}

ZipArchive::ZipArchive(std::vector<ZipMember> members, std::int64_t seconds) : members_(std::move(members)) {
  const std::string time = dos_time(seconds);
  for (const ZipMember& m : members_) {
    begins_.push_back(length_);
    heads_.push_back(local_header(m, time));
    directory_ += directory_entry(m, time, length_);
    length_ += heads_.back().size() + m.bytes;
  }
  directory_ += directory_end(members_.size(), directory_.size(), length_);
  length_ += directory_.size();
}

std::string ZipArchive::read(std::uint64_t offset, std::uint64_t most) const {
  const std::uint64_t directory_begin = length_ - directory_.size();
  if (offset >= directory_begin) return directory_.substr(offset - directory_begin, most);
  const auto next = std::upper_bound(begins_.begin(), begins_.end(), offset);
  const auto i = static_cast<std::size_t>(next - begins_.begin()) - 1;
  const std::uint64_t at = offset - begins_[i];
  if (at < heads_[i].size()) return heads_[i].substr(at, most);
  const std::uint64_t inside = at - heads_[i].size();
  return members_[i].read(inside, std::min(most, members_[i].bytes - inside));
}

}  // namespace sheetform::server
