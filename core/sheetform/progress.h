// Progress of a run that is made of other runs. Internal to the facade.
#pragma once
#include <mutex>
#include <vector>

#include "sheetform/base/run_context.h"

namespace sheetform {

/// The context of one part of a run: its progress fills [begin, end) of the whole, which has to live as long.
RunContext part_of(const RunContext& whole, double begin, double end);

/// The context of a run for several tolerances, of which the one at `at` is worked on: its progress fills its
/// own stretch of the whole. Both have to live as long.
RunContext by_tolerance(const RunContext& whole, const std::vector<double>& e_max, const std::size_t& at);

/// Progress of parts that run side by side: their mean fills [begin, end) of the whole. It is told from the
/// threads that they run on, one at a time.
class SharedProgress {
 public:
  /// whole has to live as long.
  SharedProgress(const RunContext& whole, int parts, double begin, double end)
      : whole_(whole), reached_(parts, 0), begin_(begin), end_(end) {}
  /// The context of one of them, which this has to outlive.
  RunContext part(int index);

 private:
  void tell(int index, Stage stage, double fraction, const std::string& message);
  const RunContext& whole_;
  std::mutex mutex_;
  std::vector<double> reached_;  // by part
  double sum_ = 0;               // of these
  double begin_, end_;
};

}  // namespace sheetform
