// A shape with its field and graph, as the tests of tracing need it.
#pragma once
#include "sheetform/field/cross_field.h"
#include "sheetform/tracing/tracing.h"
#include "support/shapes.h"

namespace sheetform {

struct TracedShape {
  SurfaceMesh mesh;
  std::vector<char> crease;
  CrossField field;
  TracingGraph graph;

  explicit TracedShape(TriangleSoup soup, double crease_degrees = 180)
      : mesh(build_surface_mesh(std::move(soup.points), std::move(soup.faces))) {
    RunContext context;
    for (const auto& e : mesh.edges) crease.push_back(dihedral_deg(e) > crease_degrees);
    field = cross_field(mesh, crease, principal_curvature(mesh, crease, {}, context), nullptr, {}, context);
    graph = tracing_graph(mesh, crease, field, {}, context);
  }
  std::vector<Path> candidates(const TraceParams& params = {}, int threads = 1) const {
    RunContext context;
    context.threads = threads;
    return trace_candidates(mesh, graph, field, params, context);
  }
  double dihedral_deg(const SurfaceMesh::Edge& e) const {
    if (e.border()) return 0;
    const Vector3 a = mesh.face_normal_raw(e.f0), b = mesh.face_normal_raw(e.f1);
    return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / shapes::kPi;
  }
};

/// Whole turns of a loop around the z axis.
inline int turns_around_axis(const SurfaceMesh& mesh, const Path& path) {
  double angle = 0;
  const std::size_t n = path.vertices.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vector3 &a = mesh.points[path.vertices[i]], &b = mesh.points[path.vertices[(i + 1) % n]];
    angle += std::atan2(a.x() * b.y() - a.y() * b.x(), a.x() * b.x() + a.y() * b.y());
  }
  return static_cast<int>(std::lround(angle / (2 * shapes::kPi)));
}

}  // namespace sheetform
