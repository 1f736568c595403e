// Which sides of which triangles belong together: the combinatorial half of repair. Internal to mesh/.
#pragma once
#include <array>
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform::gluing {

/// Side 3f + k of face f joins its corners k and (k + 1) % 3.
struct Gluing {
  std::vector<int> partner;  ///< of each side: the side glued to it, -1: border
  std::vector<int> crowded;  ///< a side of each edge that had more than two faces
  std::vector<int> cut;      ///< sides cut open because their component is not orientable
  std::vector<char> turned;  ///< of each face: it has to be turned over
  int one_sided_components = 0;
};

/// Of a face of the soup.
double area(const TriangleSoup& soup, int face);

/// Glues sides with the same two vertices. Of more than two the flattest pairs of matching orientation are
/// glued.
Gluing glue(const TriangleSoup& soup);

/// Turns faces to the majority (by area) of their component; cuts where that is impossible.
void orient(const TriangleSoup& soup, Gluing& gluing);

/// For each corner 3f + k the vertex that it gets: corners of one fan share it. Numbered in the order of the
/// old vertices, unused ones left out. origin: the old vertex of each new one.
std::vector<int> fan_vertices(const TriangleSoup& soup, const Gluing& gluing, std::vector<int>& origin);

}  // namespace sheetform::gluing
