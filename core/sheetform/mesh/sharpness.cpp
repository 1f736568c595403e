#include "sheetform/mesh/sharpness.h"

#include <algorithm>

namespace sheetform {
namespace {

constexpr double kConfirmed = 20;  // between the normals of a sliver and a neighbour
constexpr double kSliver = 0.01;   // height over longest side below which a face has no normal of its own
constexpr int kMostFaces = 64;     // of the surroundings of an edge, on one side

double degrees_between(const Vector3& a, const Vector3& b) { return angle_between(a, b) * 180 / M_PI; }

// Twice the area over the squared longest side: 0.87 for an equilateral triangle, 0 for a degenerate one.
double fatness(const SurfaceMesh& mesh, int f) {
  double longest = 0;
  for (int e : mesh.face_edges[f]) longest = std::max(longest, mesh.edge_length(e));
  return longest > 0 ? mesh.face_normal_raw(f).norm() / (longest * longest) : 0;
}

// The normal of a sliver says little: unless a neighbour confirms it, it takes the direction of its largest
// neighbour.
Vector3 trusted_normal(const SurfaceMesh& mesh, int f) {
  const Vector3 own = mesh.face_normal_raw(f);
  if (fatness(mesh, f) >= kSliver) return own;
  Vector3 largest = Vector3::Zero();
  for (int e : mesh.face_edges[f]) {
    const int g = mesh.edges[e].other_face(f);
    if (g < 0) continue;
    const Vector3 n = mesh.face_normal_raw(g);
    if (own.norm() > 0 && degrees_between(own, n) < kConfirmed) return own;
    if (n.squaredNorm() > largest.squaredNorm()) largest = n;
  }
  return largest.norm() > 0 ? Vector3(largest.normalized() * own.norm()) : own;
}

}  // namespace

Sharpness::Sharpness(const SurfaceMesh& mesh) : mesh_(mesh), mean_edge_(mean_edge_length(mesh)) {
  for (int f = 0; f < mesh.face_count(); ++f) {
    middles_.push_back(mesh.face_middle(f));
    normals_.push_back(trusted_normal(mesh, f));
  }
}

double Sharpness::dihedral(int e) const {
  const auto& edge = mesh_.edges[e];
  return edge.border() ? 0 : degrees_between(normals_[edge.f0], normals_[edge.f1]);
}

double Sharpness::share(int e, double barrier) const {
  const double size = std::clamp(mesh_.edge_length(e), mean_edge_ / 2, mean_edge_ * 2), angle = dihedral(e);
  double best = 0;
  for (double radius : {size, 2 * size}) {
    const double around = degrees_between(side_normal(e, mesh_.edges[e].f0, radius, barrier),
                                          side_normal(e, mesh_.edges[e].f1, radius, barrier));
    const double ratio = around > 0 ? std::min(3.0, angle / around) : 3.0;
    if (best == 0 || std::abs(std::log(ratio)) < std::abs(std::log(best))) best = ratio;
  }
  return best;
}

// Area-weighted normal of the faces on the side of `face`, connected to it over edges below the barrier.
Vector3 Sharpness::side_normal(int e, int face, double radius, double barrier) const {
  const auto& edge = mesh_.edges[e];
  const Vector3& a = mesh_.points[edge.v0];
  const Vector3 middle = (a + mesh_.points[edge.v1]) / 2;
  const Vector3 up = normals_[edge.f0].normalized() + normals_[edge.f1].normalized();
  Vector3 out = up.cross(mesh_.points[edge.v1] - a);
  if (out.dot(middles_[face] - a) < 0) out = -out;
  std::vector<int> seen{face};
  Vector3 sum = Vector3::Zero();
  for (std::size_t i = 0; i < seen.size() && i < kMostFaces; ++i) {
    sum += normals_[seen[i]];
    for (int side : mesh_.face_edges[seen[i]]) {
      const int next = mesh_.edges[side].other_face(seen[i]);
      if (next < 0 || side == e || std::find(seen.begin(), seen.end(), next) != seen.end()) continue;
      if ((middles_[next] - middle).norm() > radius || out.dot(middles_[next] - a) <= 0) continue;
      if (degrees_between(normals_[seen[i]], normals_[next]) < barrier) seen.push_back(next);
    }
  }
  return sum;
}

}  // namespace sheetform
