#include "sheetform_api/json_text.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <set>
#include <vector>

namespace sheetform::api {
namespace {

/// Looks at the events of the parser before a value is built.
class Limits {
 public:
  bool operator()(int depth, Json::parse_event_t event, const Json& parsed) {
    if (depth > kJsonDepth) fail("nests deeper than " + std::to_string(kJsonDepth) + " levels");
    if (event == Json::parse_event_t::object_start) keys_.emplace_back();
    if (event == Json::parse_event_t::object_end && !keys_.empty()) keys_.pop_back();
    if (event == Json::parse_event_t::key && !keys_.empty() &&
        !keys_.back().insert(parsed.get<std::string>()).second)
      fail("names the member \"" + parsed.get<std::string>() + "\" twice");
    return why_.empty();
  }
  const std::string& why() const { return why_; }

 private:
  void fail(std::string why) {
    if (why_.empty()) why_ = std::move(why);
  }
  std::vector<std::set<std::string>> keys_;
  std::string why_;
};

/// Depth is checked before parsing too: the parser builds nothing for a bomb of brackets.
bool too_deep(std::string_view text) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '\\') ++i;
      if (c == '"') quoted = false;
    } else if (c == '"') {
      quoted = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kJsonDepth) return true;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

bool read_digits(std::string_view& text, std::size_t count, int& value) {
  if (text.size() < count) return false;
  const auto [end, error] = std::from_chars(text.data(), text.data() + count, value);
  if (error != std::errc() || end != text.data() + count || text[0] == '-') return false;
  text.remove_prefix(count);
  return true;
}

bool read_char(std::string_view& text, char wanted) {
  if (text.empty() || std::toupper(static_cast<unsigned char>(text[0])) != wanted) return false;
  text.remove_prefix(1);
  return true;
}

bool read_fraction(std::string_view& text, std::int64_t& microseconds) {
  microseconds = 0;
  if (text.empty() || text[0] != '.') return true;
  text.remove_prefix(1);
  std::int64_t unit = 100000;
  std::size_t digits = 0;
  for (; digits < text.size() && text[digits] >= '0' && text[digits] <= '9'; ++digits, unit /= 10)
    microseconds += unit * (text[digits] - '0');
  text.remove_prefix(digits);
  return digits > 0;
}

bool read_offset(std::string_view text, int& minutes) {
  minutes = 0;
  if (text.size() == 1) return read_char(text, 'Z');
  const int sign = text.empty() ? 0 : text[0] == '+' ? 1 : text[0] == '-' ? -1 : 0;
  if (sign == 0) return false;
  text.remove_prefix(1);
  int h = 0, m = 0;
  if (!read_digits(text, 2, h) || !read_char(text, ':') || !read_digits(text, 2, m) || !text.empty())
    return false;
  minutes = sign * (h * 60 + m);
  return h < 24 && m < 60;
}

}  // namespace

bool parse_json(std::string_view text, Json& value, std::string& why) {
  if (too_deep(text)) {
    why = "nests deeper than " + std::to_string(kJsonDepth) + " levels";
    return false;
  }
  Limits limits;
  const auto callback = [&limits](int depth, Json::parse_event_t event, Json& parsed) {
    return limits(depth, event, parsed);
  };
  try {
    value = Json::parse(text.begin(), text.end(), callback);
  } catch (const Json::parse_error& e) {
    why = "is not JSON at byte " + std::to_string(e.byte);
    return false;
  } catch (const Json::exception&) {
    why = "is not usable JSON";
    return false;
  }
  why = limits.why();
  return why.empty();
}

std::string dump(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }
std::string dump(const OrderedJson& value) {
  return value.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}
std::string number_text(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::string dump_pretty(const Json& value) {
  return value.dump(1, ' ', false, Json::error_handler_t::replace);
}

std::string rfc3339(std::int64_t microseconds) {
  std::int64_t seconds = microseconds / 1000000, rest = microseconds % 1000000;
  if (rest < 0) {
    rest += 1000000;
    --seconds;
  }
  const std::time_t time = seconds;
  std::tm utc{};
  gmtime_r(&time, &utc);
  char text[64];
  std::snprintf(text, sizeof text, "%04d-%02d-%02dT%02d:%02d:%02d.%03dZ", utc.tm_year + 1900, utc.tm_mon + 1,
                utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec, static_cast<int>(rest / 1000));
  return text;
}

bool parse_rfc3339(std::string_view text, std::int64_t& microseconds) {
  int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0, offset = 0;
  std::int64_t fraction = 0;
  const bool read = read_digits(text, 4, year) && read_char(text, '-') && read_digits(text, 2, month) &&
                    read_char(text, '-') && read_digits(text, 2, day) && read_char(text, 'T') &&
                    read_digits(text, 2, hour) && read_char(text, ':') && read_digits(text, 2, minute) &&
                    read_char(text, ':') && read_digits(text, 2, second) && read_fraction(text, fraction) &&
                    read_offset(text, offset);
  if (!read || month < 1 || month > 12 || day < 1 || day > 31 || hour > 23 || minute > 59 || second > 60)
    return false;
  std::tm utc{};
  utc.tm_year = year - 1900;
  utc.tm_mon = month - 1;
  utc.tm_mday = day;
  utc.tm_hour = hour;
  utc.tm_min = minute - offset;
  utc.tm_sec = second;
  microseconds = static_cast<std::int64_t>(timegm(&utc)) * 1000000 + fraction;
  return true;
}

}  // namespace sheetform::api
