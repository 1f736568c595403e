#include "server/store/waiting_line.h"

#include <algorithm>

namespace sheetform::server {

void WaitingLine::leave(std::int64_t seq, const Place& place) {
  const std::pair entry(place.run_after, seq);
  line_.erase(std::lower_bound(line_.begin(), line_.end(), entry));
  if (const auto count = each_.find(place.principal); --count->second == 0) each_.erase(count);
  places_.erase(seq);
}

void WaitingLine::put(std::int64_t seq, std::optional<Place> place) {
  const std::lock_guard lock(mutex_);
  if (const auto before = places_.find(seq); before != places_.end()) leave(seq, Place(before->second));
  if (!place) return;
  places_.emplace(seq, *place);
  const std::pair entry(place->run_after, seq);
  line_.insert(std::upper_bound(line_.begin(), line_.end(), entry), entry);
  ++each_[place->principal];
}

std::int64_t WaitingLine::position(Microseconds run_after, std::int64_t seq) const {
  const std::lock_guard lock(mutex_);
  return std::upper_bound(line_.begin(), line_.end(), std::pair(run_after, seq)) - line_.begin();
}

std::int64_t WaitingLine::size(std::optional<std::int64_t> principal) const {
  const std::lock_guard lock(mutex_);
  if (!principal) return static_cast<std::int64_t>(line_.size());
  const auto count = each_.find(*principal);
  return count == each_.end() ? 0 : count->second;
}

}  // namespace sheetform::server
