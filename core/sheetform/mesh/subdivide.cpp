#include "sheetform/mesh/subdivide.h"

#include <algorithm>

namespace sheetform {

std::vector<std::array<int, 3>> face_pieces(std::array<int, 3> v, std::array<int, 3> m) {
  const int count = (m[0] >= 0) + (m[1] >= 0) + (m[2] >= 0);
  if (count == 0) return {v};
  if (count == 3) return {{v[0], m[0], m[2]}, {m[0], v[1], m[1]}, {m[1], v[2], m[2]}, {m[0], m[1], m[2]}};
  // Turn the face so that the first side has a new vertex and, of two, the second side has the other.
  while (m[0] < 0 || (count == 2 && m[1] < 0)) {
    std::rotate(v.begin(), v.begin() + 1, v.end());
    std::rotate(m.begin(), m.begin() + 1, m.end());
  }
  if (count == 1) return {{m[0], v[1], v[2]}, {m[0], v[2], v[0]}};
  return {{m[0], v[1], m[1]}, {v[0], m[0], m[1]}, {v[0], m[1], v[2]}};
}

Subdivision insert_vertices(const SurfaceMesh& mesh, const std::vector<char>& crease_edge,
                            const std::vector<EdgePoint>& points) {
  Subdivision result;
  std::vector<int> middle(mesh.edges.size(), -1);
  std::vector<Vector3> all = mesh.points;
  for (const EdgePoint& p : points) middle[p.edge] = static_cast<int>(all.size()), all.push_back(p.point);
  std::vector<std::array<int, 3>> faces;
  for (int f = 0; f < mesh.face_count(); ++f) {
    const auto& e = mesh.face_edges[f];
    for (const auto& piece : face_pieces(mesh.faces[f], {middle[e[0]], middle[e[1]], middle[e[2]]})) {
      faces.push_back(piece);
      result.face_origin.push_back(f);
    }
  }
  result.mesh = build_surface_mesh(std::move(all), std::move(faces));
  result.crease_edge.assign(result.mesh.edges.size(), 0);
  for (int e = 0; e < mesh.edge_count(); ++e) {
    if (crease_edge.empty() || !crease_edge[e]) continue;
    const auto& edge = mesh.edges[e];
    if (middle[e] < 0)
      result.crease_edge[result.mesh.find_edge(edge.v0, edge.v1)] = 1;
    else
      for (int v : {edge.v0, edge.v1}) result.crease_edge[result.mesh.find_edge(v, middle[e])] = 1;
  }
  return result;
}

}  // namespace sheetform
