#include "sheetform/mesh/surface_mesh.h"

#include <gtest/gtest.h>

#include "sheetform/base/error.h"
#include "support/shapes.h"

namespace sheetform {
namespace {

SurfaceMesh build(TriangleSoup soup) {
  return build_surface_mesh(std::move(soup.points), std::move(soup.faces));
}

int euler(const SurfaceMesh& m) { return m.vertex_count() - m.edge_count() + m.face_count(); }

TEST(SurfaceMesh, EulerCharacteristicOfKnownShapes) {
  EXPECT_EQ(euler(build(shapes::plane(4))), 1);
  EXPECT_EQ(euler(build(shapes::torus(12, 8))), 0);
  EXPECT_EQ(euler(build(shapes::sphere(5))), 2);
  EXPECT_EQ(euler(build(shapes::cylinder(12, 4))), 0);
  EXPECT_EQ(euler(build(shapes::closed_cylinder(12, 4))), 2);
}

TEST(SurfaceMesh, RingsGoAroundCounterClockwise) {
  const SurfaceMesh m = build(shapes::plane(6));
  for (int v = 0; v < m.vertex_count(); ++v) {
    const int count = static_cast<int>(m.ring_end_of(v) - m.ring_begin_of(v));
    double turned = 0;
    for (int i = 0; i + 1 < count; ++i) {
      const Vector3 a = m.points[m.edges[m.ring_begin_of(v)[i]].other(v)] - m.points[v];
      const Vector3 b = m.points[m.edges[m.ring_begin_of(v)[i + 1]].other(v)] - m.points[v];
      EXPECT_GT(a.cross(b).z(), 0);
      turned += std::acos(a.normalized().dot(b.normalized()));
    }
    if (m.border_vertex[v]) {
      EXPECT_LE(turned, shapes::kPi + 1e-9);
    }
  }
}

TEST(SurfaceMesh, ClosedShapesPointOutward) {
  for (const TriangleSoup& s : {shapes::sphere(6), shapes::box(3, {1, 2, 3}), shapes::closed_cylinder(12, 4),
                                shapes::torus(20, 10)}) {
    double volume = 0;
    for (const auto& t : s.faces) volume += s.points[t[0]].dot(s.points[t[1]].cross(s.points[t[2]])) / 6;
    EXPECT_GT(volume, 0);
  }
}

TEST(SurfaceMesh, RefusesWhatIsNoManifold) {
  const std::vector<Vector3> p{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  EXPECT_THROW(build_surface_mesh(p, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}), Error);
  EXPECT_THROW(build_surface_mesh(p, {{0, 1, 2}, {0, 1, 3}, {0, 2, 4}}), Error);
  EXPECT_THROW(build_surface_mesh(p, {{0, 1, 2}, {0, 3, 4}}), Error);
  EXPECT_THROW(build_surface_mesh(p, {{0, 1, 2}}), Error);
}

}  // namespace
}  // namespace sheetform
