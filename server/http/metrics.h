// Figures for Prometheus, counted as requests pass.
#pragma once
#include <array>
#include <map>
#include <mutex>
#include <string>
#include <tuple>

namespace sheetform::server {

class Metrics {
 public:
  /// route: the template, never a path of a stranger.
  void count_request(const std::string& route, const std::string& method, int status, double seconds,
                     std::uint64_t bytes_in, std::uint64_t bytes_out);
  /// Lines of the text format 0.0.4.
  std::string text() const;

 private:
  static constexpr std::array<double, 8> kBounds{0.001, 0.005, 0.02, 0.1, 0.5, 2, 10, 60};
  struct Histogram {
    std::array<std::uint64_t, kBounds.size() + 1> counts{};
    double sum = 0;
  };
  mutable std::mutex mutex_;
  std::map<std::tuple<std::string, std::string, int>, std::uint64_t> requests_;
  std::map<std::string, Histogram> seconds_;
  std::uint64_t bytes_in_ = 0, bytes_out_ = 0;
};

/// "# TYPE ..." and the value: one gauge or counter without labels.
std::string metric_line(const std::string& name, const std::string& type, const std::string& help,
                        double value);

}  // namespace sheetform::server
