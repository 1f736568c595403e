#include "server/cli/progress_display.h"

namespace sheetform::server {
namespace {

constexpr int kBarCells = 30;
constexpr std::size_t kMessageLength = 40;  // keeps the line within 80 columns and a bit

}  // namespace

double ProgressDisplay::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_).count();
}

void ProgressDisplay::show(const std::string& stage, double fraction, const std::string& message) {
  if (quiet_) return;
  const int percent = static_cast<int>(fraction * 100);
  const bool new_stage = stage != stage_;
  if (bar_) {
    const auto now = std::chrono::steady_clock::now();
    if (!new_stage && percent == percent_ && now - last_drawn_ < std::chrono::milliseconds(100)) return;
    last_drawn_ = now;
    draw_bar(stage, percent, message);
  } else if (new_stage || percent / 10 != percent_ / 10) {
    std::fprintf(out_, "%3d %% %-8s %6.1f s%s%s\n", percent, stage.c_str(), seconds(),
                 message.empty() ? "" : "  ", message.c_str());
    std::fflush(out_);
  }
  stage_ = stage;
  percent_ = percent;
}

void ProgressDisplay::draw_bar(const std::string& stage, int percent, const std::string& message) {
  const int full = percent * kBarCells / 100;
  const std::string bar = std::string(static_cast<std::size_t>(full), '#') +
                          std::string(static_cast<std::size_t>(kBarCells - full), '.');
  std::fprintf(out_, "\r[%s] %3d %% %-8s %6.1f s  %s\x1b[K", bar.c_str(), percent, stage.c_str(), seconds(),
               message.substr(0, kMessageLength).c_str());
  std::fflush(out_);
  drawn_ = true;
}

void ProgressDisplay::finish() {
  if (drawn_) std::fputs("\n", out_);
  drawn_ = false;
}

}  // namespace sheetform::server
