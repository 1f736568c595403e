// Wavefront OBJ: v and f; everything else is passed over, names of other files above all.
#include <algorithm>
#include <array>

#include "sheetform/mesh/mesh_read.h"

namespace sheetform::reading {
namespace {

// The vertex of "7", "7/1", "7//3" or "-1/2/3" as a 0-based index. A later vertex may be meant: checked at
// the end.
std::int64_t corner_index(std::string_view word, std::int64_t seen, const Scanner& in) {
  std::string_view rest = word;
  std::int64_t index = 0;
  for (int part = 0; part < 3; ++part) {
    const std::size_t slash = rest.find('/');
    const std::string_view digits = rest.substr(0, slash);
    const std::optional<std::int64_t> value = parse_integer(digits);
    const bool may_be_empty = part == 1 || (part == 2 && digits.empty());
    if (!value && !(digits.empty() && may_be_empty))
      unreadable("a face corner is no vertex number: " + shown(word), in.where(),
                 "correct the line or export the mesh again");
    if (part == 0) index = *value;
    if (slash == rest.npos) break;
    if (part == 2) unreadable("a face corner has more than three numbers: " + shown(word), in.where());
    rest.remove_prefix(slash + 1);
  }
  if (index == 0) unreadable("a face uses vertex 0; OBJ counts from 1", in.where(), "export the mesh again");
  if (index < 0 && index < -seen)
    unreadable("a face uses vertex " + std::to_string(index) + ", but only " + std::to_string(seen) +
                   " came before it",
               in.where(), "export the mesh again");
  return index > 0 ? index - 1 : seen + index;
}

void read_face(Scanner& in, PolygonSoup& soup, const ReadLimits& limits) {
  const std::int64_t line = in.line();
  for (std::string_view word = in.word(); !word.empty(); word = in.word()) {
    soup.corners.push_back(corner_index(word, static_cast<std::int64_t>(soup.points.size()), in));
    check_sides(soup.sides(), limits, at_line(line));
  }
  soup.close(line);
}

constexpr std::array<std::string_view, 40> kKeys{
    "v",     "f",        "fo",       "vt",     "vn",         "vp",        "l",      "p",     "g",    "o",
    "s",     "mg",       "usemtl",   "mtllib", "usemap",     "maplib",    "cstype", "deg",   "bmat", "step",
    "curv",  "curv2",    "surf",     "parm",   "trim",       "hole",      "scrv",   "sp",    "end",  "con",
    "bevel", "c_interp", "d_interp", "lod",    "shadow_obj", "trace_obj", "ctech",  "stech", "call", "csh"};
bool is_key(std::string_view word) { return std::find(kKeys.begin(), kKeys.end(), word) != kKeys.end(); }

}  // namespace

MeshFile read_obj(std::string_view bytes, const ReadLimits& limits) {
  PolygonSoup soup;
  Scanner in(bytes, '#', true);
  while (!in.at_end()) {
    const std::string_view key = in.word();
    // Free text may end in a backslash that is no continuation (a folder, say); numbers may be continued.
    bool joined = key == "vt" || key == "vn" || key == "vp" || key == "l" || key == "p";
    if (key == "v") {
      check_vertices(soup.points.size() + 1, limits);
      soup.points.push_back(read_point(in, limits, false));
      joined = true;
    } else if (key == "f" || key == "fo") {
      check_faces(soup.line.size() + 1, limits);
      read_face(in, soup, limits);
    } else if (!key.empty() && soup.points.empty() && soup.line.empty() && !is_key(key)) {
      unreadable("this is no OBJ file: " + shown(key), in.where(), "give an OBJ, STL, PLY or OFF file");
    }
    in.next_line(joined);
  }
  return triangulated(std::move(soup), "obj", limits, 1);
}

}  // namespace sheetform::reading
