#include "sheetform/mesh/creases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "support/shapes.h"

namespace sheetform {
namespace {

SurfaceMesh build(TriangleSoup s) { return build_surface_mesh(std::move(s.points), std::move(s.faces)); }

int count(const std::vector<char>& marks) {
  return static_cast<int>(std::count(marks.begin(), marks.end(), 1));
}

// A sheet over [0,1]^2, 24 x 24 quads, folded along x = 1/2 by fold(y) degrees (a mesh line follows the
// fold).
SurfaceMesh folded(double (*fold)(double)) {
  return build(shapes::grid({24, 24}, [=](double u, double v) {
    const double slope = std::tan(fold(v) * shapes::kPi / 360);
    return Vector3(u, v, -slope * std::abs(u - 0.5));
  }));
}

TEST(Creases, AllEdgesOfBoxesAndNoOthers) {
  for (int n : {1, 2, 7}) {
    const SurfaceMesh m = build(shapes::box(n, {1, 2, 3}));
    const std::vector<char> crease = detect_creases(m, 40);
    for (int e = 0; e < m.edge_count(); ++e) {
      const auto& edge = m.edges[e];
      EXPECT_EQ(crease[e] != 0,
                m.face_normal_raw(edge.f0).normalized().dot(m.face_normal_raw(edge.f1).normalized()) < 0.5);
    }
    EXPECT_EQ(count(crease), 12 * n);
  }
}

TEST(Creases, RimsOfAClosedCylinder) {
  EXPECT_EQ(count(detect_creases(build(shapes::closed_cylinder(48, 12)), 40)), 96);
  EXPECT_EQ(count(detect_creases(build(shapes::closed_cylinder(12, 2)), 40)), 24);
}

TEST(Creases, NoneOnSmoothShapes) {
  for (const TriangleSoup& s : {shapes::torus(24, 12), shapes::sphere(8), shapes::saddle(10, 2),
                                shapes::cylinder(12, 4), shapes::plane(5)})
    EXPECT_EQ(count(detect_creases(build(s), 40)), 0);
}

TEST(Creases, AFoldCountsFromTheAskedAngleOn) {
  EXPECT_EQ(count(detect_creases(folded([](double) { return 50.0; }), 40)), 24);
  EXPECT_EQ(count(detect_creases(folded([](double) { return 35.0; }), 40)), 0);
  EXPECT_EQ(count(detect_creases(folded([](double) { return 35.0; }), 30)), 24);
}

TEST(Creases, AGapIsBridged) {
  EXPECT_EQ(
      count(detect_creases(folded([](double y) { return 40 + 10 * std::cos(2 * shapes::kPi * y); }), 40)),
      24);
}

TEST(Creases, AFadingFoldEndsInTheSurface) {
  const SurfaceMesh m = folded([](double y) { return 90 * (1 - y); });
  const int n = count(detect_creases(m, 40));
  EXPECT_GE(n, 13);  // 40 degrees at y = 5/9
  EXPECT_LE(n, 18);
}

TEST(Creases, ARoundedFoldIsNone) {
  // The same 90 degrees over four edges.
  const SurfaceMesh m = build(shapes::grid({40, 24}, [](double u, double v) {
    const double a = std::clamp((u - 0.45) / 0.1, 0.0, 1.0) * shapes::kPi / 2, r = 0.1 / (shapes::kPi / 2);
    const double before = std::min(u, 0.45), after = std::max(0.0, u - 0.55);
    return Vector3(before + r * std::sin(a) + after * std::cos(a), v,
                   -r * (1 - std::cos(a)) - after * std::sin(a));
  }));
  EXPECT_EQ(count(detect_creases(m, 40)), 0);
  EXPECT_EQ(count(detect_creases(m, 25)), 0);
}

TEST(Creases, RoughnessIsNone) {
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> u(-1, 1);
  for (double noise : {0.005, 0.01, 0.02}) {
    TriangleSoup s = shapes::plane(40);
    for (Vector3& p : s.points) p.z() = noise * u(rng);
    EXPECT_LE(count(detect_creases(build(s), 40)), 20) << noise;  // of 4680
  }
}

TEST(Creases, EdgesWithoutAreaDoNoHarm) {
  TriangleSoup s{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, -1, 0}},
                 {{0, 1, 3}, {1, 2, 3}, {0, 2, 1}, {0, 4, 2}}};
  EXPECT_EQ(count(detect_creases(build(s), 40)), 0);
}

}  // namespace
}  // namespace sheetform
