#include "server/http/request_head.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "server/base/identity.h"
#include "server/http/field_text.h"

namespace sheetform::server {
namespace {

using api::ProblemType;

constexpr std::array<std::string_view, 7> kMethods{"GET",   "HEAD",   "POST",   "PUT",
                                                   "PATCH", "DELETE", "OPTIONS"};
constexpr std::size_t kQueryPairs = 64;
constexpr std::size_t kLengthDigits = 15;

bool is_token_char(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
         std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
}
bool is_token(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), is_token_char);
}
bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool fail(HeadError& error, std::string detail, ProblemType type = ProblemType::kMalformedRequest) {
  error = {type, std::move(detail)};
  return false;
}

int hex_value(char c) {
  if (is_digit(c)) return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// Takes the next line, which must end with CR LF, off `bytes`.
bool take_line(std::string_view& bytes, std::string_view& line) {
  const std::size_t end = bytes.find("\r\n");
  if (end == std::string_view::npos) return false;
  line = bytes.substr(0, end);
  bytes.remove_prefix(end + 2);
  return line.find('\n') == std::string_view::npos && line.find('\r') == std::string_view::npos;
}

bool has_strange_segment(std::string_view path) {
  for (std::size_t begin = 1; begin <= path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    const std::string_view segment = path.substr(begin, end - begin);
    if (segment == "." || segment == ".." || (segment.empty() && end != path.size())) return true;
    begin = end + 1;
  }
  return false;
}

bool read_target(std::string_view target, RequestHead& head, HeadError& error) {
  if (target.size() > kTargetBytes)
    return fail(error, "the address is longer than " + std::to_string(kTargetBytes) + " bytes",
                ProblemType::kUriTooLong);
  if (target.empty() || target[0] != '/') return fail(error, "the address must be a path");
  for (const char c : target)
    if (is_control(c) || c == ' ' || c == '#' || static_cast<unsigned char>(c) >= 0x80)
      return fail(error, "the address holds a character that must be escaped");
  const std::size_t mark = target.find('?');
  const std::string_view path = target.substr(0, mark);
  if (path.size() > kPathBytes)
    return fail(error, "the path is longer than " + std::to_string(kPathBytes) + " bytes",
                ProblemType::kUriTooLong);
  if (mark != std::string_view::npos) head.query = target.substr(mark + 1);
  if (!percent_decode(path, false, head.path)) return fail(error, "the path holds a broken escape");
  for (const char c : head.path)
    if (is_control(c)) return fail(error, "the path holds a control character");
  if (has_strange_segment(head.path)) {
    error.fix = "mend the address: write each / once and no dots between; is a variable of your shell empty?";
    error.detail = "the path holds an empty or a dot segment";
    return false;
  }
  return true;
}

bool read_request_line(std::string_view line, RequestHead& head, HeadError& error) {
  const std::size_t first = line.find(' ');
  const std::size_t second = first == std::string_view::npos ? first : line.find(' ', first + 1);
  if (second == std::string_view::npos || line.find(' ', second + 1) != std::string_view::npos)
    return fail(error, "the first line is not METHOD PATH VERSION");
  const std::string_view method = line.substr(0, first), version = line.substr(second + 1);
  if (!is_token(method)) return fail(error, "the method is malformed");
  if (version.size() != 8 || version.substr(0, 5) != "HTTP/" || !is_digit(version[5]) || version[6] != '.' ||
      !is_digit(version[7]))
    return fail(error, "the version is malformed");
  if (version != "HTTP/1.1" && version != "HTTP/1.0")
    return fail(error, "the version is not spoken here", ProblemType::kUnsupportedVersion);
  if (std::find(kMethods.begin(), kMethods.end(), method) == kMethods.end())
    return fail(error, "the method is not known here", ProblemType::kNotImplementedMethod);
  head.method = method;
  head.minor_version = version[7] - '0';
  return read_target(line.substr(first + 1, second - first - 1), head, error);
}

bool read_field(std::string_view line, RequestHead& head, HeadError& error) {
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos || !is_token(line.substr(0, colon)))
    return fail(error, "a header field is malformed");
  const std::string_view value = trimmed(line.substr(colon + 1));
  for (const char c : value)
    if (is_control(c) && c != '\t') return fail(error, "a header field holds a control character");
  if (head.fields.size() == kHeadFields)
    return fail(error, "there are more than " + std::to_string(kHeadFields) + " header fields",
                ProblemType::kHeadersTooLarge);
  head.fields.emplace_back(lower(line.substr(0, colon)), value);
  return true;
}

std::size_t count_fields(const RequestHead& head, std::string_view name) {
  return static_cast<std::size_t>(
      std::count_if(head.fields.begin(), head.fields.end(), [&](const auto& f) { return f.first == name; }));
}

bool read_content_length(RequestHead& head, HeadError& error) {
  const std::string text = head.field("content-length");
  if (text.empty() || text.size() > kLengthDigits || !std::all_of(text.begin(), text.end(), is_digit))
    return fail(error, "Content-Length is not one number");
  head.content_length = std::stoull(text);
  return true;
}

/// What decides where the body ends must be said once and in one way.
bool read_framing(RequestHead& head, HeadError& error) {
  const std::size_t lengths = count_fields(head, "content-length"),
                    codings = count_fields(head, "transfer-encoding");
  if (lengths > 1 || codings > 1 || (lengths == 1 && codings == 1))
    return fail(error, "the length of the body is given more than once");
  if (codings == 1) {
    if (head.minor_version == 0) return fail(error, "HTTP/1.0 has no Transfer-Encoding");
    if (lower(head.field("transfer-encoding")) != "chunked")
      return fail(error, "only Transfer-Encoding: chunked is known", ProblemType::kNotImplementedMethod);
    head.chunked = true;
  }
  if (lengths == 1 && !read_content_length(head, error)) return false;
  const bool bodyless = head.method == "GET" || head.method == "HEAD" || head.method == "OPTIONS";
  if (bodyless && head.has_body()) return fail(error, "a " + head.method + " request has no body");
  return true;
}

bool read_expectation(RequestHead& head, HeadError& error) {
  if (!head.has("expect") || head.minor_version == 0) return true;
  if (lower(head.field("expect")) != "100-continue") return fail(error, "Expect is not understood");
  head.expects_continue = true;
  return true;
}

bool check_host(const RequestHead& head, HeadError& error) {
  const std::size_t hosts = count_fields(head, "host");
  if (hosts > 1) return fail(error, "there is more than one Host");
  if (hosts == 0 && head.minor_version == 1) return fail(error, "there is no Host");
  return true;
}

}  // namespace

bool RequestHead::has(std::string_view name) const { return count_fields(*this, name) > 0; }

std::string RequestHead::field(std::string_view name) const {
  std::string value;
  bool first = true;
  for (const auto& [n, v] : fields) {
    if (n != name) continue;
    value += (first ? "" : ", ") + v;
    first = false;
  }
  return value;
}

std::size_t find_head_end(std::string_view bytes, std::size_t search_from) {
  const std::size_t end = bytes.find("\r\n\r\n", search_from < 3 ? 0 : search_from - 3);
  return end == std::string_view::npos ? end : end + 4;
}

bool parse_request_head(std::string_view bytes, RequestHead& head, HeadError& error) {
  head = RequestHead();
  if (bytes.size() > kHeadBytes)
    return fail(error, "the head is larger than " + std::to_string(kHeadBytes) + " bytes",
                ProblemType::kHeadersTooLarge);
  if (bytes.find('\0') != std::string_view::npos) return fail(error, "the head holds a zero byte");
  std::string_view line;
  if (!take_line(bytes, line)) return fail(error, "a line does not end with CR LF");
  if (!read_request_line(line, head, error)) return false;
  for (;;) {
    if (!take_line(bytes, line)) return fail(error, "a line does not end with CR LF");
    if (line.empty()) break;
    if (line[0] == ' ' || line[0] == '\t') return fail(error, "a header field goes on over several lines");
    if (!read_field(line, head, error)) return false;
  }
  return check_host(head, error) && read_framing(head, error) && read_expectation(head, error);
}

bool percent_decode(std::string_view text, bool form, std::string& decoded) {
  decoded.clear();
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%') {
      const int high = i + 2 < text.size() ? hex_value(text[i + 1]) : -1;
      const int low = i + 2 < text.size() ? hex_value(text[i + 2]) : -1;
      if (high < 0 || low < 0) return false;
      decoded += static_cast<char>(high * 16 + low);
      i += 2;
    } else {
      decoded += form && text[i] == '+' ? ' ' : text[i];
    }
  }
  return true;
}

std::string percent_encode(std::string_view text, std::string_view kept) {
  std::string out;
  for (const char c : text) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || kept.find(c) != std::string_view::npos)
      out += c;
    else
      out += "%" + to_hex(std::string_view(&c, 1));
  }
  return out;
}

bool parse_query(std::string_view text, Query& query) {
  query.clear();
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('&'), text.size());
    const std::string_view pair = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (pair.empty()) continue;
    const std::size_t equals = std::min(pair.find('='), pair.size());
    std::string name, value;
    if (!percent_decode(pair.substr(0, equals), true, name) ||
        !percent_decode(pair.substr(std::min(equals + 1, pair.size())), true, value))
      return false;
    if (std::any_of(name.begin(), name.end(), is_control) ||
        std::any_of(value.begin(), value.end(), is_control))
      return false;
    if (query.size() == kQueryPairs) return false;
    query.emplace_back(std::move(name), std::move(value));
  }
  return true;
}

}  // namespace sheetform::server
