// So many requests a minute, for each who asks: a bucket that fills evenly.
#pragma once
#include <map>
#include <mutex>
#include <string>

#include "server/base/clock.h"

namespace sheetform::server {

class RateLimit {
 public:
  /// per_minute 0: no limit.
  explicit RateLimit(int per_minute) : per_minute_(per_minute) {}
  /// Takes one; false when the bucket of `who` is empty.
  bool take(const std::string& who, SteadyClock::time_point now = SteadyClock::now());

 private:
  struct Bucket {
    double left = 0;
    SteadyClock::time_point filled{};
  };
  int per_minute_;
  std::mutex mutex_;
  std::map<std::string, Bucket> buckets_;
};

}  // namespace sheetform::server
