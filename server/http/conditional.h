// Conditional and range requests (RFC 9110, 13 and 14), by hand: the stock server must never see a Range.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "server/base/clock.h"
#include "server/http/request_head.h"

namespace sheetform::server {

/// Bytes first..last of a file, both included.
struct ByteRange {
  std::uint64_t first = 0, last = 0;
  std::uint64_t length() const { return last - first + 1; }
};

struct RangeChoice {
  enum class Kind { kWhole, kPart, kUnsatisfiable };
  Kind kind = Kind::kWhole;
  ByteRange range;
};

/// What a Range field asks of a file of `length` bytes. Anything but one range of bytes means the whole file.
RangeChoice choose_range(const std::string& field, std::uint64_t length);

/// Whether a list of entity tags (or "*") names this strong tag. weak: W/ tags count too (for If-None-Match).
bool names_tag(const std::string& field, const std::string& tag, bool weak);

enum class Precondition { kGo, kNotModified, kFailed };
/// If-Match, If-None-Match, If-Modified-Since, in the order of RFC 9110, 13.2.2. modified: seconds since
/// 1970.
Precondition check_preconditions(const RequestHead& head, const std::string& tag, std::int64_t modified);
/// The Range field when it counts: If-Range, if there, must name the tag (a date never does: seconds are too
/// coarse).
std::string effective_range(const RequestHead& head, const std::string& tag);

/// "Sun, 06 Nov 1994 08:49:37 GMT"
std::string http_date(std::int64_t seconds);
std::optional<std::int64_t> parse_http_date(const std::string& text);

/// Value of `wait` in Prefer, none when absent or malformed.
std::optional<int> preferred_wait(const std::string& field);

}  // namespace sheetform::server
