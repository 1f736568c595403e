#include "sheetform/field/cross_field.h"

#include <gtest/gtest.h>

#include <numeric>

#include "sheetform/base/error.h"
#include "support/shapes.h"

namespace sheetform {
namespace {

SurfaceMesh build(TriangleSoup soup) {
  return build_surface_mesh(std::move(soup.points), std::move(soup.faces));
}

CrossField field_of(const SurfaceMesh& mesh, const std::vector<char>& crease = {},
                    const std::vector<Vector3>* guide = nullptr, FieldParams params = {}) {
  RunContext context;
  return cross_field(mesh, crease, principal_curvature(mesh, crease, {}, context), guide, params, context);
}

int index_sum(const CrossField& f) {
  return std::accumulate(f.singular_index.begin(), f.singular_index.end(), 0);
}
int euler(const SurfaceMesh& m) { return m.vertex_count() - m.edge_count() + m.face_count(); }

// Smallest angle between `w` and the four directions at v, in degrees.
double off_cross_deg(const CrossField& f, int v, const Vector3& w) {
  double best = 0;
  for (int d = 0; d < 4; ++d) best = std::max(best, f.direction(v, d).dot(w.normalized()));
  return std::acos(std::min(1.0, best)) * 180 / shapes::kPi;
}

std::vector<char> creases_above(const SurfaceMesh& mesh, double degrees) {
  std::vector<char> crease(mesh.edges.size(), 0);
  for (int e = 0; e < mesh.edge_count(); ++e) {
    const auto& edge = mesh.edges[e];
    if (edge.border()) continue;
    const Vector3 a = mesh.face_normal_raw(edge.f0).normalized(),
                  b = mesh.face_normal_raw(edge.f1).normalized();
    crease[e] = a.dot(b) < std::cos(degrees * shapes::kPi / 180);
  }
  return crease;
}

// The square [0,1]^2 turned by `degrees`, as one flat mesh; or any affine image of it.
SurfaceMesh parallelogram(int n, const Vector3& a, const Vector3& b) {
  return build(shapes::grid({n, n}, [&](double u, double v) { return Vector3(u * a + v * b); }));
}

TEST(CrossField, DirectionsTurnCounterClockwise) {
  const CrossField f = field_of(build(shapes::plane(6)));
  for (int v = 0; v < 49; ++v)
    for (int d = 0; d < 4; ++d) {
      EXPECT_NEAR(f.direction(v, d).norm(), 1, 1e-12);
      EXPECT_NEAR((f.normal[v].cross(f.direction(v, d)) - f.direction(v, d + 1)).norm(), 0, 1e-12);
    }
}

TEST(CrossField, SumOfIndicesIsFourTimesTheEulerCharacteristic) {
  for (const TriangleSoup& soup : {shapes::sphere(12), shapes::torus(40, 20), shapes::box(8, {1, 2, 3}),
                                   shapes::closed_cylinder(36, 12), shapes::box(9, {1, 1, 0.2})}) {
    const SurfaceMesh mesh = build(soup);
    EXPECT_EQ(index_sum(field_of(mesh)), 4 * euler(mesh));
    EXPECT_EQ(index_sum(field_of(mesh, creases_above(mesh, 40))), 4 * euler(mesh));
  }
}

TEST(CrossField, SphereHasEightSingularitiesOfIndexOne) {
  const CrossField f = field_of(build(shapes::sphere(20)));
  EXPECT_EQ(f.singular_faces.size(), 8u);
  for (int index : f.singular_index) EXPECT_EQ(index, 1);
}

TEST(CrossField, TorusHasNoneAndFollowsItsCircles) {
  const SurfaceMesh mesh = build(shapes::torus(60, 30));
  const CrossField f = field_of(mesh);
  EXPECT_TRUE(f.singular_faces.empty());
  for (int v = 0; v < mesh.vertex_count(); ++v)
    EXPECT_LT(off_cross_deg(f, v, Vector3(-mesh.points[v].y(), mesh.points[v].x(), 0)), 1);
}

TEST(CrossField, FollowsTheRulingsOfACylinder) {
  const SurfaceMesh mesh = build(shapes::cylinder(40, 20));
  const CrossField f = field_of(mesh);
  EXPECT_TRUE(f.singular_faces.empty());
  for (int v = 0; v < mesh.vertex_count(); ++v) EXPECT_LT(off_cross_deg(f, v, Vector3::UnitZ()), 0.5);
}

TEST(CrossField, FollowsTheBorderOfAFlatSquare) {
  const Vector3 a(3, 1, 0), b(-1, 3, 0);
  const SurfaceMesh mesh = parallelogram(16, a, b);
  const CrossField f = field_of(mesh);
  EXPECT_TRUE(f.singular_faces.empty());
  for (int v = 0; v < mesh.vertex_count(); ++v) EXPECT_LT(off_cross_deg(f, v, a), 0.5);
}

TEST(CrossField, OddBorderCornersMakeNoSingularities) {
  // A rhombus of 50 and 130 degrees: no cross fits both sides of a corner; without care each corner counts as
  // one.
  const double angle = 50 * shapes::kPi / 180;
  const SurfaceMesh mesh = parallelogram(20, Vector3(1, 0, 0), Vector3(std::cos(angle), std::sin(angle), 0));
  EXPECT_TRUE(field_of(mesh).singular_faces.empty());
}

TEST(CrossField, FollowsCreases) {
  const SurfaceMesh mesh = build(shapes::closed_cylinder(48, 16));
  const std::vector<char> crease = creases_above(mesh, 40);
  const CrossField f = field_of(mesh, crease);
  int count = 0;
  for (int e = 0; e < mesh.edge_count(); ++e) {
    if (!crease[e]) continue;
    const auto& edge = mesh.edges[e];
    for (int v : {edge.v0, edge.v1})
      EXPECT_LT(off_cross_deg(f, v, mesh.points[edge.v1] - mesh.points[edge.v0]), 6);
    ++count;
  }
  EXPECT_EQ(count, 96);
}

TEST(CrossField, ObeysTheUsersDirections) {
  const SurfaceMesh mesh = build(shapes::cylinder(40, 20));
  std::vector<Vector3> guide;
  for (const Vector3& p : mesh.points)
    guide.push_back(Vector3(-p.y(), p.x(), 0) + Vector3::UnitZ());  // 45 degrees
  const CrossField f = field_of(mesh, {}, &guide);
  for (int v = 0; v < mesh.vertex_count(); ++v) EXPECT_LT(off_cross_deg(f, v, guide[v]), 3) << v;
}

TEST(CrossField, SpreadsAFewDirectionsOfTheUser) {
  const SurfaceMesh mesh = build(shapes::torus(40, 20));
  std::vector<Vector3> guide(mesh.points.size(), Vector3::Zero());
  guide[7] = Vector3(-mesh.points[7].y(), mesh.points[7].x(), 0);
  const CrossField f = field_of(mesh, {}, &guide);
  EXPECT_LT(off_cross_deg(f, 7, guide[7]), 1);
  EXPECT_EQ(index_sum(f), 0);
  for (const Vector3& d : f.dir) EXPECT_NEAR(d.norm(), 1, 1e-9);
}

TEST(CrossField, FlatClosedSheetWithoutAnyConstraintStillHasAField) {
  // A torus with alignment switched off: nothing pulls, the anchor decides.
  FieldParams params;
  params.curvature_scale = 1e12;
  const CrossField f = field_of(build(shapes::torus(30, 15)), {}, nullptr, params);
  EXPECT_EQ(index_sum(f), 0);
  for (const Vector3& d : f.dir) EXPECT_NEAR(d.norm(), 1, 1e-9);
}

TEST(CrossField, DoesNotDependOnUnits) {
  const SurfaceMesh small = build(shapes::closed_cylinder(30, 10, 1, 2)),
                    large = build(shapes::closed_cylinder(30, 10, 1024, 2048));
  const CrossField a = field_of(small), b = field_of(large);
  EXPECT_EQ(a.singular_faces, b.singular_faces);
  for (std::size_t v = 0; v < a.dir.size(); ++v)
    EXPECT_LT(off_cross_deg(a, static_cast<int>(v), b.dir[v]), 1e-3);
}

TEST(CrossField, RefusesAGuideOfTheWrongLength) {
  const SurfaceMesh mesh = build(shapes::plane(4));
  const std::vector<Vector3> guide(3, Vector3::UnitX());
  try {
    field_of(mesh, {}, &guide);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::kInvalidParameter);
    EXPECT_EQ(e.where(), "3 directions for 25 vertices");
  }
}

TEST(CrossField, ClosestDirection) {
  const CrossField f = field_of(build(shapes::plane(6)));
  for (int d = 0; d < 4; ++d) {
    const Vector3 w = f.direction(24, d) + 0.9 * f.direction(24, d + 1) + 5 * f.normal[24];
    EXPECT_EQ(closest_direction(f, 24, w), d);
  }
}

TEST(CrossField, SurvivesDegenerateTriangles) {
  // Every other column of the grid has no width.
  const SurfaceMesh mesh = build(
      shapes::grid({8, 8}, [](double u, double v) { return Vector3(std::floor(u * 8 / 2) * 0.25, v, 0); }));
  const CrossField f = field_of(mesh);
  for (const Vector3& d : f.dir) EXPECT_NEAR(d.norm(), 1, 1e-9);
}

TEST(CrossField, Cancels) {
  const SurfaceMesh mesh = build(shapes::torus(30, 15));
  std::atomic<bool> stop{true};
  RunContext free, stopped;
  stopped.cancelled = &stop;
  const CurvatureField c = principal_curvature(mesh, {}, {}, free);
  EXPECT_THROW(cross_field(mesh, {}, c, nullptr, {}, stopped), Error);
}

}  // namespace
}  // namespace sheetform
