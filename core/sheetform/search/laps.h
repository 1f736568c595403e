// How long the stages of a run take.
#pragma once
#include <chrono>
#include <map>
#include <string>
#include <utility>

#include "sheetform/base/run_context.h"

namespace sheetform {

/// A stopwatch that adds up the seconds of each stage.
class Laps {
 public:
  /// The time since the last lap was this stage's.
  void lap(Stage stage) {
    const auto now = Clock::now();
    seconds_[to_string(stage)] += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }
  /// The seconds since the last time; stages that took none are named too.
  std::map<std::string, double> take() {
    for (Stage stage : {Stage::kField, Stage::kTrace, Stage::kInsert}) seconds_[to_string(stage)] += 0;
    return std::exchange(seconds_, {});
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::map<std::string, double> seconds_;
  Clock::time_point last_ = Clock::now();
};

}  // namespace sheetform
