#include <gtest/gtest.h>

#include "sheetform/field/cross_field.h"
#include "support/shapes.h"

namespace sheetform {
namespace {

SurfaceMesh build(TriangleSoup soup) {
  return build_surface_mesh(std::move(soup.points), std::move(soup.faces));
}

CurvatureField curvature(const SurfaceMesh& mesh, const std::vector<char>& crease = {}) {
  RunContext context;
  return principal_curvature(mesh, crease, {}, context);
}

double unsigned_angle_deg(const Vector3& a, const Vector3& b) {
  return std::acos(std::min(1.0, std::abs(a.dot(b)) / (a.norm() * b.norm()))) * 180 / shapes::kPi;
}

TEST(PrincipalCurvature, DirectionsAreUnitTangentAndOrthogonal) {
  const CurvatureField c = curvature(build(shapes::torus(60, 30)));
  for (std::size_t v = 0; v < c.normal.size(); ++v) {
    EXPECT_NEAR(c.dir_min[v].norm(), 1, 1e-12);
    EXPECT_NEAR(c.dir_max[v].norm(), 1, 1e-12);
    EXPECT_NEAR(c.dir_min[v].dot(c.dir_max[v]), 0, 1e-12);
    EXPECT_NEAR(c.dir_min[v].dot(c.normal[v]), 0, 1e-12);
  }
}

TEST(PrincipalCurvature, SphereIsOneOverRadiusAndPositive) {
  const CurvatureField c = curvature(build(shapes::sphere(20, 2.5)));
  for (std::size_t v = 0; v < c.normal.size(); ++v) {
    EXPECT_NEAR(c.k_min[v], 0.4, 0.02);
    EXPECT_NEAR(c.k_max[v], 0.4, 0.02);
  }
}

TEST(PrincipalCurvature, CylinderBendsAroundOnly) {
  const SurfaceMesh mesh = build(shapes::cylinder(80, 40, 1, 2));
  const CurvatureField c = curvature(mesh);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    EXPECT_NEAR(c.k_max[v], 1, 0.03) << v;  // at the border too
    EXPECT_NEAR(c.k_min[v], 0, 0.03) << v;
    EXPECT_LT(unsigned_angle_deg(c.dir_min[v], Vector3::UnitZ()), 1) << v;
  }
}

TEST(PrincipalCurvature, ScalesWithTheModel) {
  const CurvatureField small = curvature(build(shapes::cylinder(60, 20, 1, 2)));
  const CurvatureField large = curvature(build(shapes::cylinder(60, 20, 1000, 2000)));
  for (std::size_t v = 0; v < small.normal.size(); ++v)
    EXPECT_NEAR(large.k_max[v] * 1000, small.k_max[v], 1e-6);
}

TEST(PrincipalCurvature, ConeGrowsTowardsItsApex) {
  // z = radius: half angle 45 degrees, curvature around is cos(45) / radius, along the rulings 0.
  const SurfaceMesh mesh = build(shapes::grid({80, 40, true, false}, [](double u, double v) {
    const double r = 1 + v, a = 2 * shapes::kPi * u;
    return Vector3(r * std::cos(a), r * std::sin(a), r);
  }));
  const CurvatureField c = curvature(mesh);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const Vector3& p = mesh.points[v];
    const double expected = std::cos(shapes::kPi / 4) / p.z();
    EXPECT_NEAR(std::abs(c.k_max[v]), expected, 0.08 * expected) << v;
    EXPECT_NEAR(c.k_min[v], 0, 0.09 * expected)
        << v;  // one-sided balls at the border see the third derivative
    EXPECT_LT(unsigned_angle_deg(c.dir_min[v], p), 1.5) << v;
    // The normal of this grid points to the axis or away from it; the sign follows the normal.
    const double outward = c.normal[v].dot(Vector3(p.x(), p.y(), 0));
    EXPECT_GT(c.k_max[v] * outward, 0) << v;
  }
}

TEST(PrincipalCurvature, TorusMatchesClosedForm) {
  const double R = 1, r = 0.4;
  const SurfaceMesh mesh = build(shapes::torus(140, 70, R, r));
  const CurvatureField c = curvature(mesh);
  // A circle's height is x^2/2r (1 + x^2/4r^2 + ...): a quadric over a ball of radius b overestimates 1/r by
  // at most the factor 1 + b^2/4r^2, and b is four edges.
  const double ball = 4 * mean_edge_length(mesh), bound = ball * ball / (4 * r * r) / r;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const Vector3& p = mesh.points[v];
    const double rho = std::hypot(p.x(), p.y());
    EXPECT_GT(c.k_max[v], 1 / r);
    EXPECT_LT(c.k_max[v], 1 / r + bound);
    EXPECT_NEAR(c.k_min[v], (rho - R) / r / rho, bound / 2);
    EXPECT_LT(unsigned_angle_deg(c.dir_min[v], Vector3(-p.y(), p.x(), 0)), 1.5);
  }
}

TEST(PrincipalCurvature, SaddleHasOppositeSignsAlongTheDiagonals) {
  const SurfaceMesh mesh = build(shapes::saddle(40, 0.5));
  const CurvatureField c = curvature(mesh);
  const int centre = 20 * 41 + 20;
  EXPECT_NEAR(mesh.points[centre].norm(), 0, 1e-12);
  EXPECT_NEAR(std::max(c.k_min[centre], c.k_max[centre]), 0.5, 0.01);
  EXPECT_NEAR(std::min(c.k_min[centre], c.k_max[centre]), -0.5, 0.01);
  EXPECT_NEAR(unsigned_angle_deg(c.dir_min[centre], Vector3(1, 0, 0)), 45, 1);
  // Along x = y the surface rises (concave seen from above), along x = -y it falls.
  const Vector3 rising = c.k_max[centre] < 0 ? c.dir_max[centre] : c.dir_min[centre];
  EXPECT_LT(unsigned_angle_deg(rising, Vector3(1, 1, 0)), 1);
}

TEST(PrincipalCurvature, DoesNotLookAcrossCreases) {
  const SurfaceMesh mesh = build(shapes::box(10, {1, 1, 1}));
  std::vector<char> crease(mesh.edges.size(), 0);
  std::vector<char> on_crease(mesh.points.size(), 0);
  for (int e = 0; e < mesh.edge_count(); ++e) {
    const auto& edge = mesh.edges[e];
    const Vector3 a = mesh.face_normal_raw(edge.f0).normalized(),
                  b = mesh.face_normal_raw(edge.f1).normalized();
    if (a.dot(b) < 0.5) crease[e] = 1, on_crease[edge.v0] = on_crease[edge.v1] = 1;
  }
  const CurvatureField c = curvature(mesh, crease);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    EXPECT_NEAR(c.k_max[v], 0, 1e-9) << v;
    EXPECT_EQ(c.dir_min[v].norm() == 0, on_crease[v] != 0) << v;
  }
}

TEST(PrincipalCurvature, SaysNothingAboutASingleTriangle) {
  const CurvatureField c = curvature(build_surface_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}));
  for (int v = 0; v < 3; ++v) {
    EXPECT_EQ(c.dir_min[v].norm(), 0);
    EXPECT_EQ(c.k_max[v], 0);
  }
}

TEST(PrincipalCurvature, DoesNotDependOnTheNumberOfThreads) {
  const SurfaceMesh mesh = build(shapes::torus(80, 40));
  RunContext one, two;
  two.threads = 2;
  const CurvatureField a = principal_curvature(mesh, {}, {}, one), b = principal_curvature(mesh, {}, {}, two);
  for (std::size_t v = 0; v < a.normal.size(); ++v) {
    EXPECT_EQ(a.dir_min[v], b.dir_min[v]);
    EXPECT_EQ(a.k_max[v], b.k_max[v]);
  }
}

}  // namespace
}  // namespace sheetform
