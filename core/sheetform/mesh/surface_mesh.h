// The mesh that every stage works on: flat arrays, connectivity built once.
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace sheetform {

using Vector2 = Eigen::Vector2d;
using Vector3 = Eigen::Vector3d;

/// Triangles by index, nothing else: what readers give and writers take. May be broken in any way.
struct TriangleSoup {
  std::vector<Vector3> points;
  std::vector<std::array<int, 3>> faces;
};

/// An oriented edge- and vertex-manifold triangle mesh with border, one or several components.
/// Invariant after build(): every face is counter-clockwise seen from outside, no unused vertex.
struct SurfaceMesh {
  struct Edge {
    int v0, v1;  ///< v0 < v1
    int f0, f1;  ///< faces on both sides, f0 < f1; f1 = -1 on the border
    bool border() const { return f1 < 0; }
    int other(int v) const { return v == v0 ? v1 : v0; }
    int other_face(int f) const { return f == f0 ? f1 : f0; }
  };

  std::vector<Vector3> points;
  std::vector<std::array<int, 3>> faces;
  std::vector<Edge> edges;                          ///< sorted by (v0, v1)
  std::vector<std::array<int, 3>> face_edges;       ///< face_edges[f][k] joins corners k and (k+1)%3 of f
  std::vector<std::array<int, 3>> face_neighbours;  ///< beyond these edges, -1 on the border
  std::vector<int>
      ring_begin;  ///< CSR: edges at v, counter-clockwise; from border edge to border edge at the border
  std::vector<int> ring_edges;
  std::vector<char> border_vertex;

  int vertex_count() const { return static_cast<int>(points.size()); }
  int face_count() const { return static_cast<int>(faces.size()); }
  int edge_count() const { return static_cast<int>(edges.size()); }
  /// Edges at v in counter-clockwise order (seen from outside), as a [begin, end) pair into ring_edges.
  const int* ring_begin_of(int v) const { return ring_edges.data() + ring_begin[v]; }
  const int* ring_end_of(int v) const { return ring_edges.data() + ring_begin[v + 1]; }
  /// Edge between two vertices, -1 if none. O(valence).
  int find_edge(int a, int b) const;
  /// Unnormalised normal: its length is twice the area.
  Vector3 face_normal_raw(int f) const {
    const auto& t = faces[f];
    return (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
  }
  Vector3 face_middle(int f) const {
    return (points[faces[f][0]] + points[faces[f][1]] + points[faces[f][2]]) / 3;
  }
  double edge_length(int e) const { return (points[edges[e].v0] - points[edges[e].v1]).norm(); }
};

/// Builds connectivity. Throws Error kUnsupportedMesh when the soup is not an oriented manifold without
/// unused vertices (mesh/repair makes it one). O(n log n).
SurfaceMesh build_surface_mesh(std::vector<Vector3> points, std::vector<std::array<int, 3>> faces);

/// Twice the signed area of the triangle between them, counter-clockwise positive.
inline double cross(const Vector2& a, const Vector2& b) { return a.x() * b.y() - a.y() * b.x(); }
/// In radians, exact for small ones too; of vectors of any length.
inline double angle_between(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}
/// Of a triangle of these points; 0 where it is none.
inline double smallest_height(const std::array<int, 3>& t, const std::vector<Vector3>& points) {
  const Vector3 &a = points[t[0]], &b = points[t[1]], &c = points[t[2]];
  const double longest =
      std::sqrt(std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
  return longest > 0 ? (b - a).cross(c - a).norm() / longest : 0.0;
}
/// Diagonal of the bounding box; 0 for no points.
double bounding_box_diagonal(const std::vector<Vector3>& points);
/// Area-weighted unit vertex normals.
std::vector<Vector3> vertex_normals(const SurfaceMesh& mesh);
double mean_edge_length(const SurfaceMesh& mesh);
double surface_area(const SurfaceMesh& mesh);
/// Component id of each face (0-based, in order of the lowest face) and their number.
std::pair<std::vector<int>, int> face_components(const SurfaceMesh& mesh);

}  // namespace sheetform
