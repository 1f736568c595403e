#include "sheetform/blueprint/text.h"

#include <charconv>
#include <cmath>
#include <cstdint>

#include "sheetform/base/error.h"

namespace sheetform {
namespace {

constexpr char32_t kReplacement = 0xFFFD;

void require_finite(double value) {
  if (!std::isfinite(value)) throw Error(ErrorCode::kInternal, "a number to be written is not finite");
}

void append_utf8(std::string& out, char32_t c) {
  if (c < 0x80) {
    out += static_cast<char>(c);
  } else if (c < 0x800) {
    out += static_cast<char>(0xC0 | (c >> 6));
    out += static_cast<char>(0x80 | (c & 0x3F));
  } else if (c < 0x10000) {
    out += static_cast<char>(0xE0 | (c >> 12));
    out += static_cast<char>(0x80 | ((c >> 6) & 0x3F));
    out += static_cast<char>(0x80 | (c & 0x3F));
  } else {
    out += static_cast<char>(0xF0 | (c >> 18));
    out += static_cast<char>(0x80 | ((c >> 12) & 0x3F));
    out += static_cast<char>(0x80 | ((c >> 6) & 0x3F));
    out += static_cast<char>(0x80 | (c & 0x3F));
  }
}

// The next character of `text`, which it shortens; kReplacement for what is no UTF-8 (one byte is taken
// then).
char32_t take_utf8(std::string_view& text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::uint8_t first = byte(0);
  std::size_t length = 1;
  char32_t c = first, least = 0;
  if (first >= 0xF0 && first < 0xF8)
    length = 4, c = first & 0x07, least = 0x10000;
  else if (first >= 0xE0 && first < 0xF0)
    length = 3, c = first & 0x0F, least = 0x800;
  else if (first >= 0xC0 && first < 0xE0)
    length = 2, c = first & 0x1F, least = 0x80;
  bool good = first < 0x80 || (length > 1 && text.size() >= length);
  for (std::size_t i = 1; good && i < length; ++i) {
    good = (byte(i) & 0xC0) == 0x80;
    c = (c << 6) | (byte(i) & 0x3F);
  }
  good = good && c >= least && c <= 0x10FFFF && !(c >= 0xD800 && c <= 0xDFFF);
  text.remove_prefix(good ? length : 1);
  return good ? c : kReplacement;
}

bool allowed_in_xml(char32_t c) {
  return c == 0x9 || c == 0xA || c == 0xD || (c >= 0x20 && c != 0xFFFE && c != 0xFFFF);
}

}  // namespace

void append_exact(std::string& out, double value) {
  require_finite(value);
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value == 0 ? 0.0 : value).ptr;
  out.append(buffer, end);
}

void append_rounded(std::string& out, double value, int decimals) {
  require_finite(value);
  char buffer[400];
  const auto end =
      std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::fixed, decimals).ptr;
  std::string_view digits(buffer, static_cast<std::size_t>(end - buffer));
  if (digits.find('.') != std::string_view::npos) {
    while (digits.back() == '0') digits.remove_suffix(1);
    if (digits.back() == '.') digits.remove_suffix(1);
  }
  out += digits == "-0" ? std::string_view("0") : digits;
}

std::string exact(double value) {
  std::string out;
  append_exact(out, value);
  return out;
}

std::string rounded(double value, int decimals) {
  std::string out;
  append_rounded(out, value, decimals);
  return out;
}

std::string xml_escaped(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const char32_t c = take_utf8(text);
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        append_utf8(out, allowed_in_xml(c) ? c : kReplacement);
    }
  }
  return out;
}

std::string valid_utf8(std::string_view text) {
  std::string out;
  while (!text.empty()) append_utf8(out, take_utf8(text));
  return out;
}

}  // namespace sheetform
