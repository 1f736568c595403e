// Time as the store keeps it: wall clock for what people see and for expiry, never for time-outs.
#pragma once
#include <chrono>
#include <cstdint>

namespace sheetform::server {

using Microseconds = std::int64_t;  ///< since 1970, UTC

inline constexpr Microseconds kSecond = 1'000'000;
inline constexpr Microseconds kHour = 3600 * kSecond;
inline constexpr Microseconds kDay = 24 * kHour;

inline Microseconds now_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// The clock of time-outs; never steps.
using SteadyClock = std::chrono::steady_clock;

}  // namespace sheetform::server
