// What the readers of the four formats share: a scanner of text, checks of numbers and counts, polygons.
// Internal to mesh/.
#pragma once
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sheetform/mesh/mesh_io.h"

namespace sheetform::reading {

[[noreturn]] void unreadable(const std::string& what, const std::string& where, const std::string& fix = {});
[[noreturn]] void over_limit(const std::string& what, std::uint64_t count, std::uint64_t limit);

/// At most 40 printable characters of untrusted bytes, in quotes: what an error message may repeat.
std::string shown(std::string_view bytes);
std::string at_line(std::int64_t line);
std::string at_byte(std::uint64_t byte);

constexpr char kNoComment = '\n';  // never met inside a line

/// Tokens of a text, line by line. Ends of lines are LF, CRLF or CR. Never copies, never looks back.
class Scanner {
 public:
  /// comment: character that starts a comment up to the end of the line, or kNoComment.
  /// continuation: a backslash at the end of a line joins the next one to it.
  /// line: number of the first line of the text.
  Scanner(std::string_view text, char comment, bool continuation, std::int64_t line = 1)
      : p_(text.data()),
        end_(text.data() + text.size()),
        line_(line),
        comment_(comment),
        continuation_(continuation) {}

  bool at_end() const { return p_ == end_; }
  std::int64_t line() const { return line_; }
  std::string where() const { return at_line(line_); }
  std::size_t bytes_left() const { return static_cast<std::size_t>(end_ - p_); }
  const char* position() const { return p_; }

  /// Next token of this line; empty at its end.
  std::string_view word() {
    skip_blanks();
    const char* begin = p_;
    while (p_ != end_ && !is_break(*p_) && !is_blank(*p_) && *p_ != comment_) ++p_;
    if (continuation_ && p_ != begin && p_ != end_ && is_break(*p_) && p_[-1] == '\\') --p_;
    return {begin, static_cast<std::size_t>(p_ - begin)};
  }
  /// Next token on this or a later line; empty at the end of the text.
  std::string_view word_on_any_line() {
    for (;;) {
      const std::string_view w = word();
      if (!w.empty() || p_ == end_) return w;
      next_line();
    }
  }
  /// Goes to the start of the next line. joined: also over the lines that a backslash joins to this one.
  void next_line(bool joined = false) {
    while (p_ != end_ && !is_break(*p_)) {
      if (*p_ == comment_) joined = false;
      if (joined && continuation_ && skip_joint()) continue;
      ++p_;
    }
    if (p_ != end_) skip_break();
  }

 private:
  static bool is_break(char c) { return c == '\n' || c == '\r'; }
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
  void skip_break() {
    if (*p_ == '\r' && p_ + 1 != end_ && p_[1] == '\n') ++p_;
    ++p_, ++line_;
  }
  bool skip_joint() {
    if (*p_ != '\\' || p_ + 1 == end_ || !is_break(p_[1])) return false;
    ++p_;
    skip_break();
    return true;
  }
  void skip_blanks() {
    while (p_ != end_) {
      if (is_blank(*p_))
        ++p_;
      else if (!continuation_ || !skip_joint())
        break;
    }
  }

  const char* p_;
  const char* end_;
  std::int64_t line_;
  char comment_;
  bool continuation_;
};

/// The whole of `word` as a number; none when it is not one. Not finite values are returned as such.
std::optional<double> parse_number(std::string_view word);
/// The whole of `word` as an integer in range; none otherwise.
std::optional<std::int64_t> parse_integer(std::string_view word);

/// Nothing to check or change: finite, within the limit, neither 0 nor denormal.
inline bool is_plain_coordinate(double value, const ReadLimits& limits) {
  return std::abs(value) <= limits.coordinate && std::abs(value) >= std::numeric_limits<double>::min();
}
/// A finite coordinate within the limit; -0 becomes 0 and denormals too, so that equal places have equal
/// bytes.
double checked_coordinate(double value, const ReadLimits& limits, const std::string& where);
/// Three coordinates from the next three words, on this line or (any_line) on later ones.
Vector3 read_point(Scanner& in, const ReadLimits& limits, bool any_line);

/// Polygons as they stand in a file. Indices are checked by triangulated().
struct PolygonSoup {
  std::vector<Vector3> points;
  std::vector<std::int64_t> corners;
  std::vector<std::size_t> begin{0};  ///< of each polygon in corners, and the end
  std::vector<std::int64_t> line;     ///< where each one stands; or its number in a binary file
  bool binary = false;                ///< `line` counts faces, not lines

  std::size_t sides() const { return corners.size() - begin.back(); }  ///< of the polygon being written
  void close(std::int64_t place) { begin.push_back(corners.size()), line.push_back(place); }
  std::string where(std::size_t polygon) const;
};

void check_vertices(std::uint64_t count, const ReadLimits& limits);
void check_faces(std::uint64_t count, const ReadLimits& limits);
void check_sides(std::uint64_t count, const ReadLimits& limits, const std::string& where);
/// Refuses a count from a header that the rest of the file cannot hold. min_bytes: of one item.
void check_count(std::uint64_t count, std::uint64_t min_bytes, std::uint64_t bytes_left,
                 const std::string& what, const std::string& where);

/// Checks all indices, splits polygons (fans of convex ones, ears of others), drops and notes those with less
/// than three corners. base: the first index of the format, for messages.
MeshFile triangulated(PolygonSoup&& soup, std::string format, const ReadLimits& limits, int base);

MeshFile read_obj(std::string_view bytes, const ReadLimits& limits);
MeshFile read_stl_text(std::string_view bytes, const ReadLimits& limits);
MeshFile read_stl_binary(std::string_view bytes, const ReadLimits& limits);
MeshFile read_ply(std::string_view bytes, const ReadLimits& limits);
MeshFile read_off(std::string_view bytes, const ReadLimits& limits);

}  // namespace sheetform::reading
