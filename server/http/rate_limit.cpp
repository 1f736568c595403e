#include "server/http/rate_limit.h"

#include <algorithm>

namespace sheetform::server {
namespace {

constexpr std::size_t kMostBuckets = 10'000;

}  // namespace

bool RateLimit::take(const std::string& who, SteadyClock::time_point now) {
  if (per_minute_ <= 0) return true;
  const std::lock_guard lock(mutex_);
  const double full = per_minute_;
  // A full bucket is as good as none: whoever stayed away for a minute is forgotten.
  if (buckets_.size() > kMostBuckets)
    std::erase_if(buckets_, [&](const auto& b) { return now - b.second.filled > std::chrono::minutes(1); });
  const auto [found, fresh] = buckets_.try_emplace(who, Bucket{full, now});
  Bucket& b = found->second;
  const double minutes = std::chrono::duration<double>(now - b.filled).count() / 60;
  b.left = std::min(full, b.left + minutes * full);
  b.filled = now;
  if (b.left < 1) return false;
  b.left -= 1;
  return true;
}

}  // namespace sheetform::server
