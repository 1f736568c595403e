#include "server/base/input_bundle.h"

#include <charconv>
#include <cstdio>

namespace sheetform::server {
namespace {

constexpr std::string_view kMark = "\nsheetform-field/1 ";  // 20 digits and a line end follow

static_assert(kMark.size() + 20 + 1 == kTailBytes);

}  // namespace

std::string after_mesh(std::uint64_t mesh_bytes, std::string_view field) {
  if (field.empty()) return {};
  char digits[24];
  std::snprintf(digits, sizeof digits, "%020llu", static_cast<unsigned long long>(mesh_bytes));
  return std::string(field) + std::string(kMark) + digits + "\n";
}

std::uint64_t mesh_bytes_of(std::uint64_t bytes, std::string_view tail) {
  if (bytes < kTailBytes || tail.size() < kTailBytes) return bytes;
  tail = tail.substr(tail.size() - kTailBytes);
  if (tail.substr(0, kMark.size()) != kMark || tail.back() != '\n') return bytes;
  std::uint64_t mesh = 0;
  const char *begin = tail.data() + kMark.size(), *end = tail.data() + kTailBytes - 1;
  const auto [stop, error] = std::from_chars(begin, end, mesh);
  const bool good = error == std::errc() && stop == end && mesh <= bytes - kTailBytes;
  return good ? mesh : bytes;
}

InputBundle split_bundle(std::string_view bytes) {
  const std::uint64_t mesh = mesh_bytes_of(bytes.size(), bytes);
  if (mesh == bytes.size()) return {bytes, {}};
  return {bytes.substr(0, mesh), bytes.substr(mesh, bytes.size() - mesh - kTailBytes)};
}

}  // namespace sheetform::server
