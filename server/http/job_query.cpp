#include "server/http/job_query.h"

#include <charconv>
#include <cmath>

#include "server/base/digest.h"
#include "server/base/identity.h"
#include "server/jobs/job_service.h"

namespace sheetform::server {
namespace {

constexpr int kDefaultLimit = 10, kLargestLimit = 10'000;
constexpr double kLongest = 1e9;  // seconds

[[noreturn]] void refuse(const char* name, const std::string& fix) {
  throw Refusal(api::ProblemType::kInvalidQueryParameter, std::string(name) + " is malformed", fix, name);
}

template <class Number>
Number number_of(const char* name, const std::string& text, Number low, Number high) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value >= low && value <= high))
    refuse(name, "give a number from " + api::number_text(low) + " to " + api::number_text(high));
  return value;
}

std::vector<JobState> states_of(const std::string& text) {
  std::vector<JobState> states;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::optional<JobState> state = api::job_state_from(text.substr(at, end - at));
    if (!state)
      refuse("status", "give some of accepted, running, successful, failed, dismissed, separated by commas");
    states.push_back(*state);
    at = end + 1;
  }
  return states;
}

std::optional<Microseconds> moment_of(const std::string& text) {
  if (text.empty() || text == "..") return std::nullopt;
  std::int64_t at = 0;
  if (!api::parse_rfc3339(text, at))
    refuse("datetime", "give 2026-11-01T00:00:00Z, or two such times with / between");
  return at;
}

void read_interval(const std::string& text, JobFilter& filter) {
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) {
    filter.created_from = filter.created_to = moment_of(text);
    return;
  }
  filter.created_from = moment_of(text.substr(0, slash));
  filter.created_to = moment_of(text.substr(slash + 1));
}

/// The filters that a cursor belongs to: those of another list are refused.
std::string filter_mark(const Exchange& x) {
  std::string all;
  for (const char* name : {"status", "processID", "type", "datetime", "minDuration", "maxDuration", "tag"})
    all += x.parameter(name).value_or("\x01") + "\n";
  return to_hex(sha256(all)).substr(0, 8);
}

// A cursor: direction and filters, created, id. Letters keep the two directions apart.
constexpr char kOlder = 'o', kNewer = 'n';

void read_cursor(const Exchange& x, const std::string& text, JobFilter& filter) {
  const std::size_t first = text.find('_'), second = text.find('_', first + 1);
  std::int64_t created = 0;
  const bool known = !text.empty() && (text[0] == kOlder || text[0] == kNewer);
  if (!known || first == std::string::npos || second == std::string::npos ||
      text.substr(1, first - 1) != filter_mark(x) || !is_uuid(text.substr(second + 1)) ||
      std::from_chars(text.data() + first + 1, text.data() + second, created).ptr != text.data() + second)
    refuse("cursor", "follow the links next and prev of a page; do not change its filters");
  // Not by one conditional expression: GCC 12 copies the string in it byte by byte.
  std::pair<Microseconds, std::string> place(created, text.substr(second + 1));
  if (text[0] == kOlder)
    filter.after = std::move(place);
  else
    filter.before = std::move(place);
}

std::string page_query(const Exchange& x, char direction, const JobRecord& from) {
  std::string query;
  for (const auto& [name, value] : x.query)
    if (name != "cursor") query += percent_encode(name) + "=" + percent_encode(value) + "&";
  return query + "cursor=" + direction + filter_mark(x) + "_" + std::to_string(from.created) + "_" + from.id;
}

}  // namespace

JobFilter job_filter(const Exchange& x) {
  JobFilter filter;
  filter.principal = x.visible();
  filter.limit =
      number_of("limit", x.parameter("limit").value_or(std::to_string(kDefaultLimit)), 1, kLargestLimit);
  if (const auto v = x.parameter("status")) filter.states = states_of(*v);
  if (const auto v = x.parameter("processID")) filter.process = *v;
  if (const auto v = x.parameter("type"); v && *v != "process")
    refuse("type", "the only type of job is process");
  if (const auto v = x.parameter("datetime")) read_interval(*v, filter);
  if (const auto v = x.parameter("minDuration"))
    filter.min_seconds = number_of("minDuration", *v, 0.0, kLongest);
  if (const auto v = x.parameter("maxDuration"))
    filter.max_seconds = number_of("maxDuration", *v, 0.0, kLongest);
  if (const auto v = x.parameter("tag")) filter.tag = *v;
  if (const auto v = x.parameter("cursor")) read_cursor(x, *v, filter);
  return filter;
}

std::string next_page_query(const Exchange& x, const JobRecord& last) { return page_query(x, kOlder, last); }

std::string previous_page_query(const Exchange& x, const JobRecord& first) {
  return page_query(x, kNewer, first);
}

}  // namespace sheetform::server
