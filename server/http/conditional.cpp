#include "server/http/conditional.h"

#include <charconv>
#include <ctime>

#include "server/http/field_text.h"

namespace sheetform::server {
namespace {

/// One or more digits; numbers too large for 64 bits are the largest one (RFC 9110 lets last-pos be
/// anything).
bool read_position(std::string_view text, std::uint64_t& value) {
  if (text.empty()) return false;
  for (const char c : text)
    if (c < '0' || c > '9') return false;
  if (std::from_chars(text.data(), text.data() + text.size(), value).ec != std::errc()) value = UINT64_MAX;
  return true;
}

RangeChoice last_bytes(std::uint64_t count, std::uint64_t length) {
  if (count == 0 || length == 0) return {RangeChoice::Kind::kUnsatisfiable, {}};
  return {RangeChoice::Kind::kPart, {count >= length ? 0 : length - count, length - 1}};
}

/// Next tag of a list: W/"..." or "...". False at the end or when the list is malformed.
bool take_tag(std::string_view& list, std::string_view& tag, bool& weak) {
  while (!list.empty() && (list.front() == ' ' || list.front() == '\t' || list.front() == ','))
    list.remove_prefix(1);
  weak = list.substr(0, 2) == "W/";
  if (weak) list.remove_prefix(2);
  if (list.empty() || list.front() != '"') return false;
  const std::size_t end = list.find('"', 1);
  if (end == std::string_view::npos) return false;
  tag = list.substr(0, end + 1);
  list.remove_prefix(end + 1);
  return true;
}

constexpr const char* kDateForm = "%a, %d %b %Y %H:%M:%S GMT";

}  // namespace

RangeChoice choose_range(const std::string& field, std::uint64_t length) {
  std::string_view text = trimmed(field);
  const RangeChoice whole{RangeChoice::Kind::kWhole, {}};
  if (text.substr(0, 6) != "bytes=") return whole;
  text = trimmed(text.substr(6));
  const std::size_t dash = text.find('-');
  if (dash == std::string_view::npos || text.find(',') != std::string_view::npos) return whole;
  const std::string_view before = trimmed(text.substr(0, dash)), after = trimmed(text.substr(dash + 1));
  std::uint64_t first = 0, last = UINT64_MAX;
  if (before.empty()) return read_position(after, last) ? last_bytes(last, length) : whole;
  if (!read_position(before, first) || (!after.empty() && !read_position(after, last))) return whole;
  if (last < first) return whole;
  if (first >= length) return {RangeChoice::Kind::kUnsatisfiable, {}};
  return {RangeChoice::Kind::kPart, {first, std::min(last, length - 1)}};
}

bool names_tag(const std::string& field, const std::string& tag, bool weak) {
  if (trimmed(field) == "*") return true;
  std::string_view list = field, one;
  for (bool is_weak = false; take_tag(list, one, is_weak);)
    if (one == tag && (weak || !is_weak)) return true;
  return false;
}

Precondition check_preconditions(const RequestHead& head, const std::string& tag, std::int64_t modified) {
  if (head.has("if-match") && !names_tag(head.field("if-match"), tag, false)) return Precondition::kFailed;
  if (head.has("if-none-match"))
    return names_tag(head.field("if-none-match"), tag, true) ? Precondition::kNotModified : Precondition::kGo;
  if (head.has("if-modified-since")) {
    const std::optional<std::int64_t> since = parse_http_date(head.field("if-modified-since"));
    if (since && modified <= *since) return Precondition::kNotModified;
  }
  return Precondition::kGo;
}

std::string effective_range(const RequestHead& head, const std::string& tag) {
  if (!head.has("range")) return {};
  if (head.has("if-range") && trimmed(head.field("if-range")) != tag) return {};
  return head.field("range");
}

std::string http_date(std::int64_t seconds) {
  const std::time_t time = seconds;
  std::tm utc{};
  gmtime_r(&time, &utc);
  char text[64];
  return std::string(text, std::strftime(text, sizeof text, kDateForm, &utc));
}

std::optional<std::int64_t> parse_http_date(const std::string& text) {
  std::tm utc{};
  const char* end = ::strptime(text.c_str(), kDateForm, &utc);
  if (end == nullptr || *end != '\0') return std::nullopt;
  return timegm(&utc);
}

std::optional<int> preferred_wait(const std::string& field) {
  std::string_view list = field;
  while (!list.empty()) {
    const std::size_t end = std::min(list.find(','), list.size());
    const std::string_view one = trimmed(list.substr(0, end));
    list.remove_prefix(std::min(end + 1, list.size()));
    if (one.substr(0, 5) != "wait=") continue;
    int seconds = 0;
    const std::string_view digits = one.substr(5);
    const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), seconds);
    if (error != std::errc() || stop != digits.data() + digits.size() || seconds < 0) return std::nullopt;
    return seconds;
  }
  return std::nullopt;
}

}  // namespace sheetform::server
