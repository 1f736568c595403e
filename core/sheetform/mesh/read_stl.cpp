// STL, text and binary. It has no indices: equal places become one vertex.
#include <bit>

#include "sheetform/mesh/mesh_read.h"
#include "sheetform/mesh/weld.h"

namespace sheetform::reading {
namespace {

constexpr std::uint64_t kHead = 84, kFacet = 50;  // bytes

std::string lower(std::string_view word) {
  std::string text(word.substr(0, 16));
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

MeshFile welded(PolygonSoup&& soup, const ReadLimits& limits) {
  ReadLimits loose = limits;
  loose.vertices = 3 * limits.faces;  // corners, not vertices yet
  MeshFile file = triangulated(std::move(soup), "stl", loose, 0);
  merge_classes(exact_classes(file.soup.points), file.soup.points, file.soup.faces);
  check_vertices(file.soup.points.size(), limits);
  return file;
}

// State of the text reader: which words may come.
struct Facet {
  bool open = false;
  std::int64_t line = 0;

  void begin(Scanner& in) {
    if (open) unreadable("a facet begins inside another one", in.where());
    open = true, line = in.line();
    const std::string_view word = in.word_on_any_line();
    if (lower(word) != "normal") unreadable("'normal' is missing after 'facet'", in.where());
    for (int k = 0; k < 3; ++k) in.word_on_any_line();  // normals are often wrong or nan and never needed
  }
  void corner(Scanner& in, PolygonSoup& soup, const ReadLimits& limits) const {
    if (!open) unreadable("a vertex outside of a facet", in.where());
    soup.corners.push_back(static_cast<std::int64_t>(soup.points.size()));
    soup.points.push_back(read_point(in, limits, true));
    check_sides(soup.sides(), limits, in.where());
  }
  void end(Scanner& in, PolygonSoup& soup, const ReadLimits& limits) {
    if (!open || soup.sides() < 3) unreadable("a facet ends with less than three vertices", in.where());
    check_faces(soup.line.size() + 1, limits);
    soup.close(line);
    open = false;
  }
};

std::uint32_t little_endian(const char* p) {
  std::uint32_t value = 0;
  for (int k = 0; k < 4; ++k)
    value |= static_cast<std::uint32_t>(static_cast<unsigned char>(p[k])) << (8 * k);
  return value;
}

void check_size(std::string_view bytes, std::uint64_t facets) {
  const std::uint64_t needed = kHead + kFacet * facets;
  if (bytes.size() >= needed && bytes.size() < needed + kFacet) return;
  unreadable("a binary STL with " + std::to_string(facets) + " facets has " + std::to_string(needed) +
                 " bytes, this file has " + std::to_string(bytes.size()),
             at_byte(80), "the file is cut off or no STL: export or upload it again");
}

}  // namespace

MeshFile read_stl_text(std::string_view bytes, const ReadLimits& limits) {
  PolygonSoup soup;
  Scanner in(bytes, kNoComment, false);
  Facet facet;
  for (;;) {
    const std::string word = lower(in.word_on_any_line());
    if (word.empty()) break;
    if (word == "facet")
      facet.begin(in);
    else if (word == "vertex")
      facet.corner(in, soup, limits);
    else if (word == "endfacet")
      facet.end(in, soup, limits);
    else if (word == "solid" || word == "endsolid")
      in.next_line();  // a name follows
    else if (word != "outer" && word != "loop" && word != "endloop")
      unreadable("no word of STL: " + shown(word), in.where());
  }
  if (facet.open)
    unreadable("the file ends inside a facet", in.where(), "the file is cut off: export the mesh again");
  return welded(std::move(soup), limits);
}

MeshFile read_stl_binary(std::string_view bytes, const ReadLimits& limits) {
  if (bytes.size() < kHead)
    unreadable("a binary STL has at least 84 bytes, this file has " + std::to_string(bytes.size()),
               at_byte(bytes.size()), "the file is cut off: export the mesh again");
  const std::uint64_t facets = little_endian(bytes.data() + 80);
  check_size(bytes, facets);
  check_faces(facets, limits);
  PolygonSoup soup;
  soup.binary = true;
  soup.points.reserve(3 * facets);
  soup.corners.reserve(3 * facets);
  for (std::uint64_t f = 0; f < facets; ++f) {
    for (std::uint64_t k = 0; k < 3; ++k) {
      Vector3 p;
      for (int axis = 0; axis < 3; ++axis) {
        const std::uint64_t at = kHead + kFacet * f + 12 + 12 * k + 4 * static_cast<std::uint64_t>(axis);
        const double value = std::bit_cast<float>(little_endian(bytes.data() + at));
        p[axis] = is_plain_coordinate(value, limits) ? value : checked_coordinate(value, limits, at_byte(at));
      }
      soup.corners.push_back(static_cast<std::int64_t>(soup.points.size()));
      soup.points.push_back(p);
    }
    soup.close(static_cast<std::int64_t>(f));
  }
  return welded(std::move(soup), limits);
}

}  // namespace sheetform::reading
