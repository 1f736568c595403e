// One file as an answer: tags, conditions, ranges, names.
#pragma once
#include <functional>
#include <limits>

#include "server/http/exchange.h"

namespace sheetform::server {

/// A file to be sent: its content by place, and what is known about it.
struct Download {
  std::string filename, media_type, digest;
  std::uint64_t bytes = 0;
  std::optional<std::int64_t>
      modified;  ///< seconds since 1970; none: the address may give another file later
  std::function<std::string(std::uint64_t offset, std::uint64_t most)> read;
  bool inline_wanted = false;  ///< to be shown instead of saved, where the type is a harmless one
};

/// The whole file, the range asked for, 304, 412 or 416. The tag is strong: the digest.
Answer send_download(const Exchange& x, const Download& d);

/// inline=1 in the query. Throws Refusal when it is neither 0 nor 1.
bool wants_inline(const Exchange& x);

}  // namespace sheetform::server
