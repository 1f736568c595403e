#include "sheetform/progress.h"

#include <algorithm>
#include <cmath>

namespace sheetform {
namespace {

// What a tolerance costs beside others: measured on five meshes, 6 % to 0.6 %.
double work_of(double e_max) { return std::pow(e_max, -0.6); }

}  // namespace

RunContext part_of(const RunContext& whole, double begin, double end) {
  RunContext part = whole;
  if (whole.progress)
    part.progress = [&whole, begin, end, reached = begin](Stage stage, double fraction,
                                                          const std::string& message) mutable {
      reached = std::max(reached, begin + (end - begin) * fraction);  // steps of a stage come again
      whole.progress(stage, reached, message);
    };
  return part;
}

RunContext by_tolerance(const RunContext& whole, const std::vector<double>& e_max, const std::size_t& at) {
  if (e_max.size() < 2) return whole;
  std::vector<double> reached{0};
  for (double e : e_max) reached.push_back(reached.back() + work_of(e));
  for (double& r : reached) r /= reached.back();
  RunContext part = whole;
  if (whole.progress)
    part.progress = [&whole, reached, &at](Stage stage, double fraction, const std::string& message) {
      const std::size_t k = std::min(at, reached.size() - 2);
      whole.progress(stage, reached[k] + (reached[k + 1] - reached[k]) * fraction,
                     "tolerance " + std::to_string(k + 1) + " of " + std::to_string(reached.size() - 1) +
                         (message.empty() ? "" : ", " + message));
    };
  return part;
}

RunContext SharedProgress::part(int index) {
  RunContext part = whole_;
  if (whole_.progress)
    part.progress = [this, index](Stage stage, double fraction, const std::string& message) {
      tell(index, stage, fraction, message);
    };
  return part;
}

void SharedProgress::tell(int index, Stage stage, double fraction, const std::string& message) {
  const std::lock_guard lock(mutex_);
  const double more = std::max(fraction - reached_[index], 0.0);  // steps of a stage come again
  reached_[index] += more, sum_ += more;
  const double mean = std::min(sum_ / static_cast<double>(reached_.size()), 1.0);
  whole_.progress(stage, begin_ + (end_ - begin_) * mean, message);
}

}  // namespace sheetform
