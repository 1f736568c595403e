#include "sheetform/blueprint/stroke_font.h"

#include <array>
#include <cstdint>

namespace sheetform {
namespace {

// Glyphs on a grid 4 wide and 6 high: two digits a point (x, then y + 1, so that 1 is the baseline), a space
// between the points of a stroke, a slash between strokes. Drawn for this program. From ' ' to '`', then '{'
// to '~'.
constexpr std::array<const char*, 65> kUpTo = {"",
                                               "27 23/22 21",
                                               "17 15/37 35",
                                               "11 17/31 37/03 43/05 45",
                                               "46 37 17 06 05 14 34 43 42 31 11 02/20 27",
                                               "01 47/07 17 16 06 07/31 41 42 32 31",
                                               "41 05 06 17 26 25 03 02 11 21 43",
                                               "27 25",
                                               "37 25 23 31",
                                               "17 25 23 11",
                                               "22 26/03 45/05 43",
                                               "22 26/04 44",
                                               "22 10",
                                               "14 34",
                                               "21 22",
                                               "01 47",
                                               "11 31 42 46 37 17 06 02 11/02 46",
                                               "16 27 21/11 31",
                                               "06 17 37 46 45 01 41",
                                               "06 17 37 46 45 34 14/34 43 42 31 11 02",
                                               "31 37 03 43",
                                               "47 07 04 34 43 42 31 11 02",
                                               "46 37 17 06 02 11 31 42 43 34 04",
                                               "07 47 21",
                                               "14 05 06 17 37 46 45 34 14 03 02 11 31 42 43 34",
                                               "02 11 31 42 46 37 17 06 05 14 44",
                                               "22 23/25 26",
                                               "25 26/22 10",
                                               "46 04 42",
                                               "03 43/05 45",
                                               "06 44 02",
                                               "06 17 37 46 45 24 23/21 22",
                                               "33 35 15 13 43 46 37 17 06 02 11 41",
                                               "01 05 27 45 41/03 43",
                                               "01 07 37 46 45 34 04/34 43 42 31 01",
                                               "46 37 17 06 02 11 31 42",
                                               "01 07 27 45 43 21 01",
                                               "47 07 01 41/04 34",
                                               "47 07 01/04 34",
                                               "46 37 17 06 02 11 31 42 44 24",
                                               "01 07/41 47/04 44",
                                               "11 31/17 37/21 27",
                                               "02 11 31 42 47",
                                               "01 07/47 04 41",
                                               "07 01 41",
                                               "01 07 24 47 41",
                                               "01 07 41 47",
                                               "11 31 42 46 37 17 06 02 11",
                                               "01 07 37 46 45 34 04",
                                               "11 31 42 46 37 17 06 02 11/23 41",
                                               "01 07 37 46 45 34 04/24 41",
                                               "46 37 17 06 05 14 34 43 42 31 11 02",
                                               "07 47/27 21",
                                               "07 02 11 31 42 47",
                                               "07 21 47",
                                               "07 11 24 31 47",
                                               "01 47/07 41",
                                               "07 24 47/24 21",
                                               "07 47 01 41",
                                               "37 17 11 31",
                                               "07 41",
                                               "17 37 31 11",
                                               "05 27 45",
                                               "00 40",
                                               "17 26"};
constexpr std::array<const char*, 4> kFromBrace = {"37 26 25 14 23 22 31", "20 27", "17 26 25 34 23 22 11",
                                                   "04 15 33 44"};
constexpr const char* kUnknown = "01 41 45 05 01";
constexpr double kAdvance = 6, kWidth = 4;

const char* glyph(unsigned char c) {
  if (c >= 'a' && c <= 'z') c = static_cast<unsigned char>(c - 'a' + 'A');
  if (c >= ' ' && c <= '`') return kUpTo[c - static_cast<unsigned>(' ')];
  if (c >= '{' && c <= '~') return kFromBrace[c - static_cast<unsigned>('{')];
  return kUnknown;
}

// One character for each code point: continuation bytes of UTF-8 draw nothing of their own.
bool draws(unsigned char c) { return (c & 0xC0) != 0x80; }

int count(std::string_view text) {
  int n = 0;
  for (char c : text) n += draws(static_cast<unsigned char>(c));
  return n;
}

void add_glyph(const char* g, double x, double unit, StrokeText& out) {
  bool fresh = true;
  for (; *g; ++g) {
    if (*g == '/') fresh = true;
    if (*g < '0' || *g > '9') continue;
    if (fresh) out.lines.emplace_back();
    fresh = false;
    out.lines.back().push_back({x + unit * (g[0] - '0'), unit * (g[1] - '1')});
    ++g;
  }
}

}  // namespace

double stroke_text_width(std::string_view text, double height) {
  const int n = count(text);
  return n == 0 ? 0 : (kAdvance * (n - 1) + kWidth) * height / 6;
}

StrokeText stroke_text(std::string_view text, double height) {
  StrokeText out;
  out.height = height, out.width = stroke_text_width(text, height);
  const double unit = height / 6;
  double x = 0;
  for (char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (!draws(byte)) continue;
    add_glyph(glyph(byte), x, unit, out);
    x += kAdvance * unit;
  }
  return out;
}

}  // namespace sheetform
