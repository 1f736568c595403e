// Progress for people: a bar that is redrawn on a terminal, plain lines elsewhere.
#pragma once
#include <chrono>
#include <cstdio>
#include <string>

namespace sheetform::server {

class ProgressDisplay {
 public:
  /// Writes to `out` (stderr). bar: redraw one line; otherwise a line at every new stage and every ten
  /// percent.
  ProgressDisplay(std::FILE* out, bool bar, bool quiet) : out_(out), bar_(bar), quiet_(quiet) {}
  ~ProgressDisplay() { finish(); }
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  void show(const std::string& stage, double fraction, const std::string& message);
  /// Ends the bar's line, so that what follows starts on a new one.
  void finish();
  double seconds() const;

 private:
  void draw_bar(const std::string& stage, int percent, const std::string& message);

  std::FILE* out_;
  bool bar_, quiet_, drawn_ = false;
  std::string stage_;
  int percent_ = -1;
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point last_drawn_{};
};

}  // namespace sheetform::server
