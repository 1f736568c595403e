#include <algorithm>
#include <cmath>

#include "sheetform/base/error.h"
#include "sheetform/mesh/mesh_repair.h"
#include "sheetform/mesh/subdivide.h"
#include "sheetform/mesh/symmetry.h"

namespace sheetform {
namespace {

// Heights over the plane; vertices that are near enough are moved onto it and get height 0.
std::vector<double> snapped_heights(SurfaceMesh& mesh, const Vector3& normal, double offset, double snap) {
  std::vector<double> height(mesh.points.size()),
      shortest(mesh.points.size(), std::numeric_limits<double>::infinity());
  for (int e = 0; e < mesh.edge_count(); ++e)
    for (int v : {mesh.edges[e].v0, mesh.edges[e].v1})
      shortest[v] = std::min(shortest[v], mesh.edge_length(e));
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    height[v] = normal.dot(mesh.points[v]) - offset;
    if (std::abs(height[v]) > snap * shortest[v]) continue;
    mesh.points[v] -= height[v] * normal;
    height[v] = 0;
  }
  return height;
}

std::vector<EdgePoint> crossings(const SurfaceMesh& mesh, const std::vector<double>& height,
                                 const Vector3& normal, double offset) {
  std::vector<EdgePoint> points;
  for (int e = 0; e < mesh.edge_count(); ++e) {
    const auto& edge = mesh.edges[e];
    const double a = height[edge.v0], b = height[edge.v1];
    if (!((a < 0 && b > 0) || (a > 0 && b < 0))) continue;
    const Vector3 p = mesh.points[edge.v0] + a / (a - b) * (mesh.points[edge.v1] - mesh.points[edge.v0]);
    points.push_back({e, p - (normal.dot(p) - offset) * normal});
  }
  return points;
}

// The kept faces with their vertices renumbered; origin: the old vertex of each new one.
TriangleSoup kept_side(const SurfaceMesh& mesh, const std::vector<double>& height, std::vector<int>& origin) {
  TriangleSoup half;
  std::vector<int> id(mesh.points.size(), -1);
  for (const auto& f : mesh.faces) {
    const double low = std::min({height[f[0]], height[f[1]], height[f[2]]}),
                 high = std::max({height[f[0]], height[f[1]], height[f[2]]});
    if (low < 0 || high <= 0) continue;
    std::array<int, 3> t{};
    for (int k = 0; k < 3; ++k) {
      int& v = id[f[k]];
      if (v < 0)
        v = static_cast<int>(half.points.size()), half.points.push_back(mesh.points[f[k]]),
        origin.push_back(f[k]);
      t[k] = v;
    }
    half.faces.push_back(t);
  }
  return half;
}

}  // namespace

HalfMesh cut_half(const SurfaceMesh& input, const std::vector<char>& crease_edge, const Vector3& normal,
                  double offset, double snap) {
  SurfaceMesh mesh = input;
  std::vector<double> height = snapped_heights(mesh, normal, offset, snap);
  const Subdivision cut = insert_vertices(mesh, crease_edge, crossings(mesh, height, normal, offset));
  height.resize(cut.mesh.points.size(), 0);
  std::vector<int> origin;
  const TriangleSoup half = kept_side(cut.mesh, height, origin);
  if (half.faces.empty())
    throw Error(ErrorCode::kInvalidParameter, "nothing of the mesh lies on the kept side of the plane",
                "symmetry", "give a plane that cuts the mesh in two halves");
  // Parts that touch in a vertex of the plane are split by repair; a clean half passes through it unchanged.
  RepairResult repaired = repair(half);
  HalfMesh result;
  result.mesh = std::move(repaired.mesh);
  for (int v : repaired.vertex_origin) result.on_plane.push_back(v >= 0 && height[origin[v]] == 0);
  for (const auto& e : result.mesh.edges) {
    const int a = repaired.vertex_origin[e.v0], b = repaired.vertex_origin[e.v1];
    const int old = a < 0 || b < 0 ? -1 : cut.mesh.find_edge(origin[a], origin[b]);
    result.crease_edge.push_back(old >= 0 && !e.border() ? cut.crease_edge[old] : 0);
  }
  return result;
}

PlaneBorder plane_border(SurfaceMesh& half, double reach) {
  PlaneBorder plane;
  plane.edge.assign(half.edges.size(), 0);
  plane.vertex.assign(half.points.size(), 0);
  for (int e = 0; e < half.edge_count(); ++e) {
    const auto& edge = half.edges[e];
    if (!edge.border() || std::abs(half.points[edge.v0].x()) > reach ||
        std::abs(half.points[edge.v1].x()) > reach)
      continue;
    plane.edge[e] = plane.vertex[edge.v0] = plane.vertex[edge.v1] = 1;
  }
  for (int v = 0; v < half.vertex_count(); ++v)
    if (plane.vertex[v]) half.points[v].x() = 0;
  return plane;
}

SurfaceMesh with_mirror_image(const SurfaceMesh& half, const PlaneBorder& plane) {
  std::vector<Vector3> points = half.points;
  std::vector<std::array<int, 3>> faces = half.faces;
  std::vector<int> image(points.size());
  for (int v = 0; v < half.vertex_count(); ++v) {
    image[v] = plane.vertex[v] ? v : static_cast<int>(points.size());
    if (!plane.vertex[v]) points.emplace_back(-half.points[v].x(), half.points[v].y(), half.points[v].z());
  }
  for (const auto& f : half.faces) faces.push_back({image[f[0]], image[f[2]], image[f[1]]});
  return build_surface_mesh(std::move(points), std::move(faces));
}

}  // namespace sheetform
