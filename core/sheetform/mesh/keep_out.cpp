#include "sheetform/mesh/keep_out.h"

#include <algorithm>
#include <cmath>

namespace sheetform {
namespace {

constexpr double kFlood = 2;      // spacings beyond the radius: what margins may ask for
constexpr int kMostSamples = 64;  // of one edge

// Whether the edge comes nearer to the curve than `reach`.
bool comes_near(const SurfaceMesh& mesh, int e, const ClosestPointTree& curve, double reach) {
  const Vector3 &a = mesh.points[mesh.edges[e].v0], &b = mesh.points[mesh.edges[e].v1];
  const int n = std::clamp(static_cast<int>(2 * (b - a).norm() / reach) + 1, 1, kMostSamples);
  for (int i = 0; i <= n; ++i)
    if (curve.closest(a + (b - a) * i / n, reach * reach).face >= 0) return true;
  return false;
}

}  // namespace

KeepOut::KeepOut(const SurfaceMesh& mesh, const std::vector<BrushStroke>& brushes, double spacing,
                 const RunContext& context)
    : spacing_(spacing) {
  if (brushes.empty()) return;
  surface_ = ClosestPointTree(mesh.points, mesh.faces, context);
  for (const BrushStroke& stroke : brushes) {
    context.checkpoint();
    const double fine = std::min(spacing, stroke.radius / 2);
    const std::vector<CurvePoint> curve = curve_on_surface(surface_, stroke.points, false, fine);
    Brush brush{curve_tree(curve), stroke.radius, {}};
    brush.faces = flooded(mesh, curve, brush);
    brushes_.push_back(std::move(brush));
  }
}

std::vector<int> KeepOut::flooded(const SurfaceMesh& mesh, const std::vector<CurvePoint>& curve,
                                  const Brush& brush) const {
  const double reach = brush.radius + kFlood * spacing_;
  std::vector<char> in(mesh.faces.size(), 0);
  std::vector<int> faces, open;
  const auto take = [&](int f) {
    if (!in[f]) in[f] = 1, faces.push_back(f), open.push_back(f);
  };
  for (const CurvePoint& p : curve) take(p.face);
  while (!open.empty()) {
    const int f = open.back();
    open.pop_back();
    for (int e : mesh.face_edges[f]) {
      const int g = mesh.edges[e].other_face(f);
      if (g >= 0 && !in[g] && comes_near(mesh, e, brush.curve, reach)) take(g);
    }
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

double KeepOut::depth_in(const Brush& brush, const Vector3& point, double margin) const {
  const double reach = brush.radius + margin;
  const ClosestPoint near = brush.curve.closest(point, reach * reach);
  if (near.face < 0) return 0;
  const int face = surface_.closest(point).face;
  if (!std::binary_search(brush.faces.begin(), brush.faces.end(), face)) return 0;
  return reach - std::sqrt(near.squared_distance);
}

double KeepOut::depth(const Vector3& point, double margin, int* brush) const {
  double deepest = 0;
  for (std::size_t i = 0; i < brushes_.size(); ++i) {
    const double here = depth_in(brushes_[i], point, margin);
    if (here <= deepest) continue;
    deepest = here;
    if (brush != nullptr) *brush = static_cast<int>(i);
  }
  return deepest;
}

Vector3 KeepOut::pushed_out(const Vector3& point, double margin) const {
  Vector3 out = point;
  for (const Brush& brush : brushes_) {
    if (depth_in(brush, out, margin) <= 0) continue;
    const Vector3 centre = brush.curve.closest(out).point;
    const double distance = (out - centre).norm();
    if (distance > 0) out = centre + (out - centre) * ((brush.radius + margin) / distance);
  }
  return out;
}

std::vector<char> edges_inside(const SurfaceMesh& mesh, const KeepOut& keep_out, double margin) {
  if (keep_out.empty()) return {};
  std::vector<char> vertex(mesh.points.size()), edge(mesh.edges.size());
  for (std::size_t v = 0; v < vertex.size(); ++v) vertex[v] = keep_out.depth(mesh.points[v], margin) > 0;
  for (std::size_t e = 0; e < edge.size(); ++e) {
    const auto& [a, b, f, g] = mesh.edges[e];
    edge[e] = vertex[a] || vertex[b] || keep_out.depth((mesh.points[a] + mesh.points[b]) / 2, margin) > 0;
  }
  return edge;
}

}  // namespace sheetform
