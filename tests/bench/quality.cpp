#include "quality.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "sheetform/field/cross_field.h"
#include "sheetform/mesh/creases.h"
#include "sheetform/mesh/mesh_repair.h"
#include "sheetform/mesh/sample.h"

namespace sheetform::bench {
namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846;

double angle(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * kDegrees;
}

struct Reference {
  SurfaceMesh mesh;
  ClosestPointTree tree;
  CurvatureField curvature;
  double diagonal;
  explicit Reference(const InputMesh& input, RunContext& context) : mesh(repair(input.soup, context).mesh) {
    diagonal = bounding_box_diagonal(mesh.points);
    tree = ClosestPointTree(mesh.points, mesh.faces);
    // Over about 3 % of the diagonal, two edges at least.
    CurvatureParams params;
    params.radius_edges = std::clamp(0.03 * diagonal / mean_edge_length(mesh), 2.0, 12.0);
    curvature = principal_curvature(mesh, std::vector<char>(mesh.edges.size(), 0), params, context);
  }
};

void normals(const Reference& reference, const StripMesh& strips, Quality& q) {
  std::vector<std::array<int, 3>> faces;
  for (const auto& p : strips.patches)
    for (const auto& t : p.triangles) faces.push_back(t.v);
  const SurfaceMesh surface = build_surface_mesh(strips.points, faces);
  std::vector<double> off;
  for (const SurfaceSample& s : sample_evenly(surface, 20000)) {
    const int f = reference.tree.closest(s.point).face;
    off.push_back(angle(s.normal, reference.mesh.face_normal_raw(f)));
  }
  if (off.empty()) return;
  for (double a : off) q.normal_deviation += a / static_cast<double>(off.size());
  std::sort(off.begin(), off.end());
  q.normal_deviation_p95 = off[off.size() * 95 / 100];
}

// Every 2 % of the diagonal along each ruling, where |k_max| is above 1 / diagonal and twice |k_min|.
void alignment(const Reference& r, const StripMesh& strips, Quality& q) {
  double all = 0, pronounced = 0, aligned = 0;
  for (const auto& patch : strips.patches)
    for (const auto& ruling : patch.rulings) {
      const Vector3 &a = strips.points[ruling[0]], &b = strips.points[ruling[1]];
      const double length = (b - a).norm();
      const int n = std::max(1, static_cast<int>(std::ceil(length / (0.02 * r.diagonal))));
      for (int i = 0; i < n; ++i) {
        const double share = length / n;
        all += share;
        const ClosestPoint hit = r.tree.closest(a + (i + 0.5) / n * (b - a));
        int k = 0;
        hit.barycentric.maxCoeff(&k);
        const int v = r.mesh.faces[hit.face][k];
        const double big = std::abs(r.curvature.k_max[v]), small = std::abs(r.curvature.k_min[v]);
        if (big * r.diagonal < 1 || small > big / 2) continue;
        pronounced += share;
        const Vector3 normal = r.curvature.normal[v], d = (b - a) - normal * normal.dot(b - a);
        const double off = angle(d, r.curvature.dir_min[v]);
        if (std::min(off, 180 - off) <= 15) aligned += share;
      }
    }
  if (all > 0) q.aligned_where = pronounced / all;
  if (pronounced > 0) q.aligned = aligned / pronounced;
}

void bending(const StripMesh& strips, Quality& q) {
  double sum = 0, total = 0;
  for (const auto& patch : strips.patches) {
    std::map<std::pair<int, int>, Vector3> open;
    for (const auto& t : patch.triangles) {
      const Vector3 normal = (strips.points[t.v[1]] - strips.points[t.v[0]])
                                 .cross(strips.points[t.v[2]] - strips.points[t.v[0]]);
      for (int k = 0; k < 3; ++k) {
        const auto edge = std::minmax(t.vt[k], t.vt[(k + 1) % 3]);
        const auto [it, fresh] = open.emplace(edge, normal);
        if (fresh) continue;
        const double length = (strips.uvs[edge.first] - strips.uvs[edge.second]).norm();
        sum += length * angle(it->second, normal), total += length;
      }
    }
  }
  if (total > 0) q.bend = sum / total;
}

// Area and least second moment of a part in the plane.
std::pair<double, double> moments(const StripMesh& strips, const StripMesh::Patch& patch) {
  double area = 0;
  Vector2 first = Vector2::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  for (const auto& t : patch.triangles) {
    const Vector2 &a = strips.uvs[t.vt[0]], &b = strips.uvs[t.vt[1]], &c = strips.uvs[t.vt[2]];
    const double own = ((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x()) / 2;
    area += own;
    first += own * (a + b + c) / 3;
    const Vector2 sum = a + b + c;
    second += own / 12 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
  }
  second -= first * first.transpose() / area;
  return {area, Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(second).eigenvalues()[0]};
}

void parts(const StripMesh& strips, double diagonal, Quality& q) {
  double total = 0, least = 1e300, narrowest = 1e300;
  std::vector<double> areas;
  for (const auto& patch : strips.patches) {
    const auto [area, moment] = moments(strips, patch);
    const double width = std::sqrt(std::max(0.0, 12 * moment / area));
    areas.push_back(area), total += area;
    least = std::min(least, area), narrowest = std::min(narrowest, width);
    q.narrow_parts += width < 0.02 * diagonal;
  }
  for (double a : areas) q.small_parts += a < 0.003 * total;
  q.smallest_area = least / total;
  q.narrowest = narrowest / diagonal;
}

double height(const SurfaceMesh& mesh, int f) {
  double longest = 0;
  for (int e : mesh.face_edges[f]) longest = std::max(longest, mesh.edge_length(e));
  return longest > 0 ? mesh.face_normal_raw(f).norm() / longest : 0;
}

// Edges that fold by 40 degrees and more between faces high enough to have a normal.
bool is_sharp(const Reference& r, int e) {
  const auto& edge = r.mesh.edges[e];
  if (edge.border()) return false;
  const double least = 5e-4 * r.diagonal;
  return angle(r.mesh.face_normal_raw(edge.f0), r.mesh.face_normal_raw(edge.f1)) >= 40 &&
         height(r.mesh, edge.f0) >= least && height(r.mesh, edge.f1) >= least;
}

// Length of an edge, and of what lies within half a percent of an arch.
std::pair<double, double> followed(const Reference& r, int e, const ClosestPointTree& arches) {
  const Vector3 &a = r.mesh.points[r.mesh.edges[e].v0], &b = r.mesh.points[r.mesh.edges[e].v1];
  const double length = (b - a).norm();
  const int n = std::max(1, static_cast<int>(std::ceil(length / (0.005 * r.diagonal))));
  int near = 0;
  for (int i = 0; i < n; ++i)
    near += arches.closest(a + (i + 0.5) / n * (b - a)).squared_distance < 2.5e-5 * r.diagonal * r.diagonal;
  return {length, length * near / n};
}

void creases(const Reference& r, const StripMesh& strips, Quality& q) {
  const std::vector<char> crease = detect_creases(r.mesh, 40);
  std::vector<std::array<int, 3>> segments;
  for (const auto& a : strips.arches)
    for (std::size_t i = 0; i + 1 < a.vertices.size(); ++i)
      segments.push_back({a.vertices[i], a.vertices[i + 1], a.vertices[i + 1]});
  const ClosestPointTree arches(strips.points, segments);
  double all = 0, kept = 0, sharp = 0, sharp_kept = 0;
  for (int e = 0; e < r.mesh.edge_count(); ++e) {
    const bool counts = is_sharp(r, e);
    if (!crease[e] && !counts) continue;
    const auto [length, near] = followed(r, e, arches);
    if (crease[e]) all += length, kept += near;
    if (counts) sharp += length, sharp_kept += near;
  }
  if (all > 0) q.creases_kept = kept / all;
  if (sharp > 0) q.sharp_kept = sharp_kept / sharp;
  q.sharp_length = sharp / r.diagonal;
}

void nodes(const StripMesh& strips, Quality& q) {
  std::map<int, int> valence;
  for (const auto& a : strips.arches) {
    q.self_seams += a.patches[0] == a.patches[1];
    for (std::size_t i = 0; i + 1 < a.vertices.size(); ++i)
      ++valence[a.vertices[i]], ++valence[a.vertices[i + 1]];
  }
  std::set<int> open;
  for (const auto& p : strips.patches) {
    const std::set<int> corners(p.corners.begin(), p.corners.end());
    for (int i = 0; i < static_cast<int>(p.boundary.size()); ++i)
      if (valence[p.boundary[i]] >= 3 && !corners.count(i)) open.insert(p.boundary[i]);
  }
  q.t_junctions = static_cast<int>(open.size());
}

}  // namespace

Quality measure_quality(const InputMesh& input, const Decomposition& result, RunContext& context) {
  Quality q;
  const Reference reference(input, context);
  const DistanceReport distance = measure_distance(reference.mesh.points, reference.mesh.faces,
                                                   reference.tree, result.strips, 20000, context);
  q.input_to_result = distance.input_to_result / reference.diagonal;
  q.result_to_input = distance.result_to_input / reference.diagonal;
  q.mean_distance = distance.mean / reference.diagonal;
  normals(reference, result.strips, q);
  alignment(reference, result.strips, q);
  bending(result.strips, q);
  parts(result.strips, reference.diagonal, q);
  creases(reference, result.strips, q);
  nodes(result.strips, q);
  return q;
}

}  // namespace sheetform::bench
