#include "sheetform/symmetric.h"

#include <algorithm>
#include <cmath>

#include "sheetform/base/error.h"
#include "sheetform/mesh/closest_point.h"
#include "sheetform/mesh/mesh_repair.h"
#include "sheetform/mesh/symmetry.h"

namespace sheetform {
namespace {

constexpr double kOnPlane = 1e-12;   // of the diagonal: cut_half moves points exactly there
constexpr double kDetail = 0.05;     // of the tolerance: what may be snapped to the plane
constexpr double kTrusted = 0.5;     // of the tolerance: a plane that is found has to fit that well
constexpr double kAxisAngle = 1e-3;  // radians: a plane so near to an axis is tried there
constexpr std::size_t kMostPlanes = 4;
constexpr std::size_t kVoters = 100;  // vertices that tell which half a surface belongs to

struct Pair {
  Vector3 from, to;  // a point of one mesh, and the nearest one of the other
  double distance2 = -1;
};

// The vertex or middle of a face of one mesh that is farthest from the other.
Pair farthest(const SurfaceMesh& from, const ClosestPointTree& to) {
  Pair worst;
  const auto look_at = [&](const Vector3& p) {
    const ClosestPoint c = to.closest(p);
    if (c.squared_distance > worst.distance2) worst = {p, c.point, c.squared_distance};
  };
  for (const Vector3& p : from.points) look_at(p);
  for (const auto& f : from.faces) look_at((from.points[f[0]] + from.points[f[1]] + from.points[f[2]]) / 3);
  return worst;
}

struct Deviation {
  double distance = 0;
  Vector3 place = Vector3::Zero();  // of the first mesh
};

Deviation deviation(const SurfaceMesh& a, const SurfaceMesh& b) {
  const ClosestPointTree tree_a(a.points, a.faces), tree_b(b.points, b.faces);
  const Pair there = farthest(a, tree_b), back = farthest(b, tree_a);
  if (there.distance2 >= back.distance2) return {std::sqrt(there.distance2), there.from};
  return {std::sqrt(back.distance2), back.to};
}

int euler(const SurfaceMesh& m) { return m.vertex_count() - m.edge_count() + m.face_count(); }

bool same_topology(const SurfaceMesh& a, const SurfaceMesh& b) {
  return euler(a) == euler(b) && count_border_loops(a) == count_border_loops(b) &&
         face_components(a).second == face_components(b).second;
}

double cut_length(const SurfaceMesh& half, const PlaneBorder& border) {
  double sum = 0;
  for (int e = 0; e < half.edge_count(); ++e)
    if (border.edge[e]) sum += half.edge_length(e);
  return sum;
}

// Which component of the half most vertices of each component of the whole, or their images, are nearest to.
std::vector<int> nearest_components(const SurfaceMesh& whole, const std::vector<int>& own, int wholes,
                                    const SurfaceMesh& half, const std::vector<int>& component, int count) {
  if (count == 1) return std::vector<int>(wholes, 0);
  const ClosestPointTree tree(half.points, half.faces);
  std::vector<std::vector<int>> faces(wholes);
  for (std::size_t f = 0; f < own.size(); ++f) faces[own[f]].push_back(static_cast<int>(f));
  std::vector<int> nearest;
  for (int c = 0; c < wholes; ++c) {
    const std::size_t step = 1 + faces[c].size() / kVoters;
    std::vector<int> votes(count, 0);
    for (std::size_t i = 0; i < faces[c].size(); i += step) {
      const Vector3& p = whole.points[whole.faces[faces[c][i]][0]];
      ++votes[component[tree.closest({std::abs(p.x()), p.y(), p.z()}).face]];
    }
    nearest.push_back(static_cast<int>(std::max_element(votes.begin(), votes.end()) - votes.begin()));
  }
  return nearest;
}

// The plane along the nearest axis through the same place of the mesh, if that is nearly the same.
std::optional<Plane> along_axis(const Plane& plane, const Vector3& centre) {
  int axis = 0;
  plane.normal.cwiseAbs().maxCoeff(&axis);
  const Vector3 normal = std::copysign(1.0, plane.normal[axis]) * Vector3::Unit(axis);
  if ((plane.normal - normal).norm() > kAxisAngle || plane.normal == normal) return std::nullopt;
  // The height of the mesh's centre over the plane stays.
  return Plane{normal, normal.dot(centre) - (plane.normal.dot(centre) - plane.offset)};
}

std::string percent(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g %%", 100 * x);
  return text;
}

}  // namespace

PlaneFrame plane_frame(const Plane& plane) {
  PlaneFrame frame;
  int axis = 0;
  plane.normal.cwiseAbs().maxCoeff(&axis);
  const Vector3 first =
      (Vector3::Unit((axis + 1) % 3) - plane.normal[(axis + 1) % 3] * plane.normal).normalized();
  frame.axes.row(0) = plane.normal;
  frame.axes.row(1) = first;
  frame.axes.row(2) = plane.normal.cross(first);
  frame.offset = plane.offset;
  return frame;
}

std::optional<SymmetricHalf> symmetric_half(const SurfaceMesh& mesh, const Plane& plane, double reach,
                                            double detail, Asymmetry& why) {
  SymmetricHalf half;
  half.plane = plane;
  half.frame = plane_frame(plane);
  SurfaceMesh turned = mesh;
  for (Vector3& p : turned.points) p = half.frame.in(p);
  const double snap = std::clamp(detail / mean_edge_length(mesh), 1e-6, 0.1);
  try {
    half.mesh = cut_half(turned, {}, Vector3::UnitX(), 0, snap).mesh;
  } catch (const Error& e) {
    why = {e.summary(), {}};
    return std::nullopt;
  }
  const PlaneBorder border = plane_border(half.mesh, kOnPlane);
  const SurfaceMesh whole = with_mirror_image(half.mesh, border);
  const Deviation worst = deviation(turned, whole);
  half.deviation = worst.distance;
  if (half.deviation > reach) {
    why = {"the mesh deviates from its mirror image by " + percent(half.deviation) + " of the diagonal",
           half.frame.out(worst.place)};
    return std::nullopt;
  }
  if (!same_topology(whole, turned)) {
    why = {"the two sides of the plane differ in components, borders or holes", {}};
    return std::nullopt;
  }
  return half;
}

std::vector<int> halves_of_whole(const SurfaceMesh& whole, const SurfaceMesh& half,
                                 const std::vector<int>& component, int count) {
  auto [half_of, wholes] = face_components(whole);
  const std::vector<int> to = nearest_components(whole, half_of, wholes, half, component, count);
  for (int& c : half_of) c = to[c];
  return half_of;
}

std::optional<SymmetricHalf> find_symmetric_half(const SurfaceMesh& mesh, double e_max,
                                                 const RunContext& context) {
  const ClosestPointTree tree(mesh.points, mesh.faces);
  Vector3 centre = Vector3::Zero();
  for (const Vector3& p : mesh.points) centre += p / static_cast<double>(mesh.points.size());
  std::optional<SymmetricHalf> best;
  double best_score = 0;
  Asymmetry why;
  const auto consider = [&](const Plane& plane) {
    context.checkpoint();
    auto half = symmetric_half(mesh, plane, kTrusted * e_max, kDetail * e_max, why);
    if (!half) return false;
    const double cut = cut_length(half->mesh, plane_border(half->mesh, kOnPlane));
    const double score = (cut + 1e-3) * (1 + 8 * half->deviation / e_max);
    if (!best || score < best_score) best = std::move(half), best_score = score;
    return true;
  };
  std::vector<SymmetryPlane> planes = detect_symmetry(mesh, tree, context);
  if (planes.size() > kMostPlanes) planes.resize(kMostPlanes);
  for (const SymmetryPlane& found : planes) {
    const Plane plane{found.normal, found.offset};
    const std::optional<Plane> straight = along_axis(plane, centre);
    if (!straight || !consider(*straight)) consider(plane);
  }
  return best;
}

}  // namespace sheetform
