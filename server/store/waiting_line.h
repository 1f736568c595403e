// The waiting jobs in their order, in memory: every upload is told its place, and every page of the list asks
// for a hundred places, which the database could only count.
#pragma once
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <vector>

#include "server/base/clock.h"

namespace sheetform::server {

/// Thread-safe. A place is found in O(log n), a change moves at most 16 bytes a waiting job.
class WaitingLine {
 public:
  struct Place {
    Microseconds run_after = 0;
    std::int64_t principal = 0;
  };

  /// Says where a job stands now; none when it does not wait.
  void put(std::int64_t seq, std::optional<Place> place);
  /// Number of jobs up to this one, itself included, whether it waits or not.
  std::int64_t position(Microseconds run_after, std::int64_t seq) const;
  /// Jobs that wait, of one principal or of all.
  std::int64_t size(std::optional<std::int64_t> principal) const;

 private:
  void leave(std::int64_t seq, const Place& place);

  mutable std::mutex mutex_;
  std::unordered_map<std::int64_t, Place> places_;           ///< by seq
  std::vector<std::pair<Microseconds, std::int64_t>> line_;  ///< run_after and seq, sorted
  std::map<std::int64_t, std::int64_t> each_;                ///< jobs of a principal
};

}  // namespace sheetform::server
