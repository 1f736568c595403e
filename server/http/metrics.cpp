#include "server/http/metrics.h"

#include <cstdint>
#include <sstream>

namespace sheetform::server {

void Metrics::count_request(const std::string& route, const std::string& method, int status, double seconds,
                            std::uint64_t bytes_in, std::uint64_t bytes_out) {
  const std::lock_guard lock(mutex_);
  ++requests_[{route, method, status}];
  Histogram& h = seconds_[route];
  std::size_t bucket = 0;
  while (bucket < kBounds.size() && seconds > kBounds[bucket]) ++bucket;
  ++h.counts[bucket];
  h.sum += seconds;
  bytes_in_ += bytes_in;
  bytes_out_ += bytes_out;
}

std::string Metrics::text() const {
  const std::lock_guard lock(mutex_);
  std::ostringstream out;
  out << "# HELP sheetform_http_requests_total Requests by route, method and status\n"
         "# TYPE sheetform_http_requests_total counter\n";
  for (const auto& [key, count] : requests_)
    out << "sheetform_http_requests_total{route=\"" << std::get<0>(key) << "\",method=\"" << std::get<1>(key)
        << "\",code=\"" << std::get<2>(key) << "\"} " << count << '\n';
  out << "# HELP sheetform_http_seconds Time to answer, by route\n# TYPE sheetform_http_seconds histogram\n";
  for (const auto& [route, h] : seconds_) {
    std::uint64_t below = 0;
    for (std::size_t i = 0; i < kBounds.size(); ++i) {
      below += h.counts[i];
      out << "sheetform_http_seconds_bucket{route=\"" << route << "\",le=\"" << kBounds[i] << "\"} " << below
          << '\n';
    }
    below += h.counts[kBounds.size()];
    out << "sheetform_http_seconds_bucket{route=\"" << route << "\",le=\"+Inf\"} " << below << '\n'
        << "sheetform_http_seconds_sum{route=\"" << route << "\"} " << h.sum << '\n'
        << "sheetform_http_seconds_count{route=\"" << route << "\"} " << below << '\n';
  }
  return out.str() +
         metric_line("sheetform_http_received_bytes_total", "counter", "Bytes of request bodies",
                     static_cast<double>(bytes_in_)) +
         metric_line("sheetform_http_sent_bytes_total", "counter", "Bytes of responses",
                     static_cast<double>(bytes_out_));
}

std::string metric_line(const std::string& name, const std::string& type, const std::string& help,
                        double value) {
  std::ostringstream out;
  out.precision(17);
  out << "# HELP " << name << ' ' << help << "\n# TYPE " << name << ' ' << type << '\n'
      << name << ' ' << value << '\n';
  return out.str();
}

}  // namespace sheetform::server
