#include "sheetform/blueprint/zip.h"

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <set>

#include "sheetform/base/error.h"

namespace sheetform {
namespace {

void put(std::string& out, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out += static_cast<char>((value >> (8 * i)) & 0xFF);
}

bool harmless(const std::string& name) {
  const bool letters = std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
           c == '-' || c == '_' || c == '/';
  });
  return letters && !name.empty() && name.size() < 200 && name.front() != '/' &&
         name.find("..") == std::string::npos;
}

// window_bits < 0: a bare deflate stream, else one with zlib's header.
std::string compress(const std::string& content, int window_bits) {
  z_stream stream{};
  if (deflateInit2(&stream, 6, Z_DEFLATED, window_bits, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw Error(ErrorCode::kInternal, "zlib does not start");
  std::string out(deflateBound(&stream, static_cast<uLong>(content.size())), '\0');
  std::string input = content;  // zlib's interface is not const
  stream.next_in = reinterpret_cast<Bytef*>(input.data());
  stream.avail_in = static_cast<uInt>(input.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const int code = deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  if (code != Z_STREAM_END) throw Error(ErrorCode::kInternal, "zlib does not finish");
  return out;
}

constexpr std::uint64_t kDosTime = 0, kDosDate = 0x21;  // 1980-01-01 00:00

// What the local and the central header have in common.
void put_common(std::string& out, std::uint32_t crc, std::size_t packed, std::size_t size, std::size_t name) {
  put(out, 20, 2), put(out, 0, 2), put(out, 8, 2), put(out, kDosTime, 2), put(out, kDosDate, 2);
  put(out, crc, 4), put(out, packed, 4), put(out, size, 4), put(out, name, 2), put(out, 0, 2);
}

}  // namespace

std::string write_zip(const std::vector<ZipEntry>& entries) {
  std::string out, directory;
  std::set<std::string> seen;
  for (const ZipEntry& e : entries) {
    if (!harmless(e.name) || !seen.insert(e.name).second)
      throw Error(ErrorCode::kInternal, "a file name that no archive may hold", e.name);
    const std::string packed = compress(e.content, -15);
    const auto crc = static_cast<std::uint32_t>(
        crc32(0, reinterpret_cast<const Bytef*>(e.content.data()), static_cast<uInt>(e.content.size())));
    const std::size_t offset = out.size();
    put(out, 0x04034b50, 4), put_common(out, crc, packed.size(), e.content.size(), e.name.size());
    out += e.name + packed;
    put(directory, 0x02014b50, 4), put(directory, 20, 2),
        put_common(directory, crc, packed.size(), e.content.size(), e.name.size());
    put(directory, 0, 2), put(directory, 0, 2), put(directory, 0, 2), put(directory, 0, 4),
        put(directory, offset, 4);
    directory += e.name;
    if (out.size() + directory.size() > 0xF0000000u)
      throw Error(ErrorCode::kInternal, "an archive of more than 4 GB");
  }
  const std::size_t start = out.size();
  out += directory;
  put(out, 0x06054b50, 4), put(out, 0, 2), put(out, 0, 2), put(out, entries.size(), 2),
      put(out, entries.size(), 2);
  put(out, directory.size(), 4), put(out, start, 4), put(out, 0, 2);
  return out;
}

std::string file_name_of(const std::string& text) {
  std::string out;
  for (char c : text) {
    const bool good =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
    out += good ? c : '_';
  }
  return out.empty() ? "_" : out.substr(0, 80);
}

std::string deflated(const std::string& content) { return compress(content, 15); }

}  // namespace sheetform
