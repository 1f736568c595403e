// The head of a request, read strictly (RFC 9112): whatever two programs could understand in two ways is
// refused.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sheetform_api/problem.h"

namespace sheetform::server {

inline constexpr std::size_t kHeadBytes = 16 * 1024;
inline constexpr std::size_t kHeadFields = 64;
inline constexpr std::size_t kTargetBytes = 4096;
inline constexpr std::size_t kPathBytes = 512;

/// Names and values of a query or form, decoded, in their order.
using Query = std::vector<std::pair<std::string, std::string>>;

struct RequestHead {
  std::string method;  ///< one of GET HEAD POST PUT PATCH DELETE OPTIONS
  std::string path;    ///< decoded; begins with '/', no control characters, no empty or dot segments inside
  std::string query;   ///< as sent, without '?'
  int minor_version = 1;
  std::vector<std::pair<std::string, std::string>> fields;  ///< names in lower case
  std::optional<std::uint64_t> content_length;
  bool chunked = false;
  bool expects_continue = false;

  bool has_body() const { return chunked || content_length.value_or(0) > 0; }
  bool has(std::string_view name) const;
  /// Value of the only field of this name; empty when there is none. Several are joined by ", ".
  std::string field(std::string_view name) const;
};

struct HeadError {
  api::ProblemType type = api::ProblemType::kMalformedRequest;
  std::string detail;
  std::string fix = {};  ///< empty: the usual one
};

/// bytes: everything up to and including the empty line. False: `error` says why.
bool parse_request_head(std::string_view bytes, RequestHead& head, HeadError& error);

/// Place after the empty line that ends a head, or npos.
std::size_t find_head_end(std::string_view bytes, std::size_t search_from = 0);

/// Decodes %XX, and '+' as a space when `form`. False for a broken escape.
bool percent_decode(std::string_view text, bool form, std::string& decoded);
/// The reverse: everything but letters, digits and the characters of `kept` as %XX.
std::string percent_encode(std::string_view text, std::string_view kept = "-._~,:");
/// Splits at '&' and '='. False for broken escapes, control characters, and more than 64 pairs.
bool parse_query(std::string_view text, Query& query);

}  // namespace sheetform::server
