// Reading JSON of strangers and writing JSON of ours: bounded depth, no duplicate keys, never a throw on
// broken UTF-8.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace sheetform::api {

using Json = nlohmann::json;
using OrderedJson = nlohmann::ordered_json;

/// Deepest nesting that is read.
inline constexpr int kJsonDepth = 32;

/// Reads one JSON text. On failure returns false and says in `why` what is wrong and at which byte. A text
/// that nests deeper than kJsonDepth, or names a member twice, is refused. O(bytes).
bool parse_json(std::string_view text, Json& value, std::string& why);

/// One line; broken UTF-8 becomes U+FFFD.
std::string dump(const Json& value);
std::string dump(const OrderedJson& value);
/// Indented for people.
std::string dump_pretty(const Json& value);

/// The shortest text that reads back as the number: 0.02, 1e-05.
std::string number_text(double value);

/// RFC 3339 in UTC with milliseconds, e.g. "2026-11-22T09:24:00.000Z"; microseconds since 1970.
std::string rfc3339(std::int64_t microseconds);
/// The reverse, any number of fraction digits, Z or offset; false when it is no such time.
bool parse_rfc3339(std::string_view text, std::int64_t& microseconds);

}  // namespace sheetform::api
