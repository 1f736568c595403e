#include "server/base/input_bundle.h"

#include <charconv>
#include <cstdio>

namespace sheetform::server {
namespace {

constexpr std::size_t kDigits = 20;
// Digits and a line end follow.
constexpr std::string_view kFieldMark = "\nsheetform-field/1 ", kGuideMark = "\nsheetform-guide/1 ";
static_assert(kFieldMark.size() + kDigits + 1 == kTailBytes && kGuideMark.size() == kFieldMark.size());

std::string digits_of(std::uint64_t number) {
  char digits[24];
  std::snprintf(digits, sizeof digits, "%020llu", static_cast<unsigned long long>(number));
  return digits;
}

// The whole text has to be the number, and that no more than `most`.
bool read_number(std::string_view text, std::uint64_t most, std::uint64_t& number) {
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && stop == text.data() + text.size() && number <= most;
}

// Whether a bundle of `bytes` ends with a tail of this mark, and how long it says the mesh is.
bool read_tail(std::string_view mark, std::uint64_t bytes, std::string_view tail, std::uint64_t& mesh) {
  if (bytes < kTailBytes || tail.size() < kTailBytes) return false;
  tail = tail.substr(tail.size() - kTailBytes);
  return tail.substr(0, mark.size()) == mark && tail.back() == '\n' &&
         read_number(tail.substr(mark.size(), kDigits), bytes - kTailBytes, mesh);
}

}  // namespace

std::string after_mesh(std::uint64_t mesh_bytes, std::string_view field, std::string_view guides) {
  std::string text(field);
  if (!guides.empty()) text.append(guides).append(digits_of(field.size()));
  if (text.empty()) return text;
  return text.append(guides.empty() ? kFieldMark : kGuideMark).append(digits_of(mesh_bytes)) + "\n";
}

std::uint64_t mesh_bytes_of(std::uint64_t bytes, std::string_view tail) {
  std::uint64_t mesh = 0;
  const bool bundle = read_tail(kFieldMark, bytes, tail, mesh) || read_tail(kGuideMark, bytes, tail, mesh);
  return bundle ? mesh : bytes;
}

InputBundle split_bundle(std::string_view bytes) {
  std::uint64_t mesh = 0, field = 0;
  if (read_tail(kFieldMark, bytes.size(), bytes, mesh))
    return {bytes.substr(0, mesh), bytes.substr(mesh, bytes.size() - mesh - kTailBytes), {}};
  if (!read_tail(kGuideMark, bytes.size(), bytes, mesh)) return {bytes, {}, {}};
  const std::string_view both = bytes.substr(mesh, bytes.size() - mesh - kTailBytes);
  const std::size_t rest = both.size() < kDigits ? 0 : both.size() - kDigits;
  if (both.size() < kDigits || !read_number(both.substr(rest), rest, field)) return {bytes, {}, {}};
  return {bytes.substr(0, mesh), both.substr(0, field), both.substr(field, rest - field)};
}

}  // namespace sheetform::server
