#include "sheetform/mesh/mesh_read.h"

#include <algorithm>
#include <limits>

#include "sheetform/base/error.h"
#include "sheetform/mesh/polygon_split.h"

namespace sheetform::reading {
namespace {

constexpr std::uint64_t kEarSteps = 64;  // that cutting ears may take for each corner of the file, on average

std::string number_text(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, 6).ptr;
  return {text, end};
}

void check_indices(const PolygonSoup& soup, std::size_t polygon, int base) {
  const auto points = static_cast<std::int64_t>(soup.points.size());
  for (std::size_t c = soup.begin[polygon]; c < soup.begin[polygon + 1]; ++c) {
    const std::int64_t i = soup.corners[c];
    if (i >= 0 && i < points) continue;
    unreadable("a face uses vertex " + std::to_string(i + base) + ", but the file has " +
                   std::to_string(points) + " vertices",
               soup.where(polygon), "export the mesh again");
  }
}

// Triangles of one polygon, as indices into soup.points.
struct Splitter {
  std::vector<Vector3> places;
  std::vector<std::array<int, 3>> triangles;
  std::uint64_t budget;

  void split(const PolygonSoup& soup, std::size_t polygon) {
    triangles.clear();
    const std::int64_t* corner = soup.corners.data() + soup.begin[polygon];
    const std::size_t sides = soup.begin[polygon + 1] - soup.begin[polygon];
    if (sides == 3) {
      triangles.push_back({0, 1, 2});
    } else {
      places.clear();
      for (std::size_t k = 0; k < sides; ++k) places.push_back(soup.points[corner[k]]);
      split_polygon(places, budget, triangles);
    }
    for (auto& t : triangles)
      for (int& k : t) k = static_cast<int>(corner[k]);
  }
};

}  // namespace

void unreadable(const std::string& what, const std::string& where, const std::string& fix) {
  throw Error(ErrorCode::kUnreadableMesh, what, where, fix);
}

void over_limit(const std::string& what, std::uint64_t count, std::uint64_t limit) {
  throw Error(
      ErrorCode::kLimitExceeded,
      "the mesh has " + std::to_string(count) + " " + what + ", the limit is " + std::to_string(limit), {},
      "simplify the mesh before uploading it");
}

std::string shown(std::string_view bytes) {
  std::string text = "'";
  for (const char c : bytes.substr(0, 40)) text += c >= ' ' && c <= '~' ? c : '?';
  return text + (bytes.size() > 40 ? "...'" : "'");
}

std::string at_line(std::int64_t line) { return "line " + std::to_string(line); }
std::string at_byte(std::uint64_t byte) { return "byte " + std::to_string(byte); }

std::optional<double> parse_number(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  double value = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || word.empty()) return std::nullopt;
  if (code == std::errc()) return value;
  if (code != std::errc::result_out_of_range) return std::nullopt;
  const bool tiny = word.find("e-") != word.npos || word.find("E-") != word.npos;
  return tiny ? 0.0 : std::numeric_limits<double>::infinity();
}

std::optional<std::int64_t> parse_integer(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (code != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

double checked_coordinate(double value, const ReadLimits& limits, const std::string& where) {
  if (!std::isfinite(value))
    unreadable("a coordinate is not a finite number", where,
               "remove the vertices without a position and export the mesh again");
  if (std::abs(value) > limits.coordinate)
    throw Error(ErrorCode::kLimitExceeded,
                "a coordinate is " + number_text(value) + ", the limit is " + number_text(limits.coordinate),
                where, "move the mesh to the origin or scale it down");
  return std::abs(value) < std::numeric_limits<double>::min() ? 0.0 : value;
}

namespace {

double checked_word(std::string_view word, const ReadLimits& limits, const Scanner& in) {
  if (word.empty())
    unreadable("a vertex has less than three coordinates", in.where(), "export the mesh again");
  const std::optional<double> value = parse_number(word);
  if (!value) {
    const bool comma = word.find(',') != word.npos;
    unreadable("a coordinate is no number: " + shown(word), in.where(),
               comma ? "use a point as the decimal mark" : "correct the line or export the mesh again");
  }
  return is_plain_coordinate(*value, limits) ? *value : checked_coordinate(*value, limits, in.where());
}

}  // namespace

Vector3 read_point(Scanner& in, const ReadLimits& limits, bool any_line) {
  Vector3 p;
  for (int k = 0; k < 3; ++k) p[k] = checked_word(any_line ? in.word_on_any_line() : in.word(), limits, in);
  return p;
}

std::string PolygonSoup::where(std::size_t polygon) const {
  return binary ? "face " + std::to_string(line[polygon]) : at_line(line[polygon]);
}

void check_vertices(std::uint64_t count, const ReadLimits& limits) {
  if (count > limits.vertices) over_limit("vertices", count, limits.vertices);
}
void check_faces(std::uint64_t count, const ReadLimits& limits) {
  if (count > limits.faces) over_limit("faces", count, limits.faces);
}
void check_sides(std::uint64_t count, const ReadLimits& limits, const std::string& where) {
  if (count <= limits.polygon_sides) return;
  throw Error(ErrorCode::kLimitExceeded,
              "a face has more than " + std::to_string(limits.polygon_sides) + " corners", where,
              "split large polygons into triangles");
}

void check_count(std::uint64_t count, std::uint64_t min_bytes, std::uint64_t bytes_left,
                 const std::string& what, const std::string& where) {
  if (min_bytes == 0 || count <= bytes_left / min_bytes) return;
  unreadable("the header announces " + std::to_string(count) + " " + what + ", the file can hold at most " +
                 std::to_string(bytes_left / min_bytes),
             where, "the file is cut off or its header is wrong: export the mesh again");
}

MeshFile triangulated(PolygonSoup&& soup, std::string format, const ReadLimits& limits, int base) {
  check_vertices(soup.points.size(), limits);
  const std::size_t polygons = soup.line.size();
  std::uint64_t triangles = 0, skipped = 0, split = 0;
  for (std::size_t i = 0; i < polygons; ++i) {
    const std::size_t sides = soup.begin[i + 1] - soup.begin[i];
    check_indices(soup, i, base);
    triangles += std::max<std::size_t>(sides, 2) - 2;
    skipped += sides<3, split += sides> 3;
  }
  check_faces(triangles, limits);
  MeshFile file;
  file.format = std::move(format);
  file.soup.faces.reserve(triangles);
  file.polygon.reserve(triangles);
  Splitter splitter{{}, {}, kEarSteps * soup.corners.size()};
  for (std::size_t i = 0; i < polygons; ++i) {
    if (soup.begin[i + 1] - soup.begin[i] < 3) continue;
    splitter.split(soup, i);
    for (const auto& t : splitter.triangles)
      file.soup.faces.push_back(t), file.polygon.push_back(static_cast<int>(i));
  }
  file.soup.points = std::move(soup.points);
  if (split > 0)
    file.notes.push_back(std::to_string(split) +
                         " faces with more than three corners were split into triangles");
  if (skipped > 0)
    file.notes.push_back(std::to_string(skipped) + " faces with less than three corners were left out");
  return file;
}

}  // namespace sheetform::reading
