// New vertices on edges. Internal to mesh/.
#pragma once
#include <array>
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// A face with new vertices on its sides (middle[k] between corners k and k + 1, -1: none) as one to four
/// faces of the same orientation. Two new vertices get joined by an edge, a single one is joined to the
/// opposite corner.
std::vector<std::array<int, 3>> face_pieces(std::array<int, 3> corner, std::array<int, 3> middle);

struct EdgePoint {
  int edge;
  Vector3 point;
};

struct Subdivision {
  SurfaceMesh mesh;               ///< old vertices first, then the new ones in the order given
  std::vector<char> crease_edge;  ///< halves of a crease edge are creases
  std::vector<int> face_origin;
};

/// Puts a vertex on each of the given edges (each at most once). crease_edge: by edge, empty = none.
Subdivision insert_vertices(const SurfaceMesh& mesh, const std::vector<char>& crease_edge,
                            const std::vector<EdgePoint>& points);

}  // namespace sheetform
