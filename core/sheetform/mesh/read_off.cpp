// Geomview OFF in text form, with the prefixes that put normals, colours or texture coordinates behind each
// vertex.
#include "sheetform/mesh/mesh_read.h"

namespace sheetform::reading {
namespace {

std::uint64_t read_count(Scanner& in, const char* what) {
  const std::string_view word = in.word_on_any_line();
  const std::optional<std::int64_t> value = parse_integer(word);
  if (!value || *value < 0)
    unreadable(std::string("the number of ") + what +
                   " is missing: " + (word.empty() ? "the file ends" : shown(word)),
               in.where(), "an OFF file begins with OFF, then the numbers of vertices, faces and edges");
  return static_cast<std::uint64_t>(*value);
}

// The keyword is optional, and the first count may stick to it ("OFF490 518 0" is common).
std::string_view without_keyword(std::string_view bytes) {
  Scanner in(bytes, '#', false);
  const std::string_view word = in.word_on_any_line();
  const std::size_t off = word.find("OFF");
  if (off == word.npos) return bytes;
  const std::string_view prefix = word.substr(0, off);
  if (prefix.find_first_of("4n") != prefix.npos)
    unreadable("the file is " + shown(word) + ", vertices of four or more dimensions", in.where(),
               "export it as plain OFF, in three dimensions");
  Scanner rest = in;
  if (rest.word() == "BINARY")
    unreadable("the file is a binary OFF", in.where(), "export it as text OFF or as binary PLY");
  return bytes.substr(static_cast<std::size_t>(word.data() + off + 3 - bytes.data()));
}

std::int64_t lines_between(const char* begin, const char* end) {
  Scanner in({begin, static_cast<std::size_t>(end - begin)}, kNoComment, false);
  while (!in.at_end()) in.next_line();
  return in.line() - 1;
}

void read_face(Scanner& in, PolygonSoup& soup, const ReadLimits& limits) {
  const std::string_view word = in.word_on_any_line();
  const std::int64_t line = in.line();
  const std::optional<std::int64_t> sides = parse_integer(word);
  if (word.empty())
    unreadable("the file ends after " + std::to_string(soup.line.size()) + " faces", at_line(line),
               "the file is cut off: export the mesh again");
  if (!sides || *sides < 0)
    unreadable("the number of corners of a face is no number: " + shown(word), at_line(line));
  check_sides(static_cast<std::uint64_t>(*sides), limits, at_line(line));
  for (std::int64_t k = 0; k < *sides; ++k) {
    const std::string_view corner = in.word_on_any_line();
    const std::optional<std::int64_t> index = parse_integer(corner);
    if (!index)
      unreadable("a face corner is no vertex number: " + (corner.empty() ? "the file ends" : shown(corner)),
                 in.where());
    soup.corners.push_back(*index);
  }
  soup.close(line);
  in.next_line();  // a colour may follow
}

}  // namespace

MeshFile read_off(std::string_view bytes, const ReadLimits& limits) {
  const std::string_view body = without_keyword(bytes);
  Scanner in(body, '#', false, 1 + lines_between(bytes.data(), body.data()));
  const std::uint64_t vertices = read_count(in, "vertices"), faces = read_count(in, "faces");
  check_count(vertices, 6, in.bytes_left(), "vertices", in.where());
  check_count(faces, 2, in.bytes_left(), "faces", in.where());
  check_vertices(vertices, limits);
  check_faces(faces, limits);
  in.next_line();  // the number of edges is not needed
  PolygonSoup soup;
  soup.points.reserve(vertices);
  for (std::uint64_t i = 0; i < vertices; ++i) {
    soup.points.push_back(read_point(in, limits, true));
    in.next_line();
  }
  for (std::uint64_t i = 0; i < faces; ++i) read_face(in, soup, limits);
  return triangulated(std::move(soup), "off", limits, 0);
}

}  // namespace sheetform::reading
