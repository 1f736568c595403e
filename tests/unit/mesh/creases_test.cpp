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

// A prism over a regular polygon, two edges a side: its rims turn at every other vertex only.
TriangleSoup prism(int sides) {
  TriangleSoup soup = shapes::closed_cylinder(2 * sides, 6);
  const double middle = std::cos(shapes::kPi / sides);
  for (Vector3& p : soup.points) {
    const double turn = std::atan2(p.y(), p.x()) * sides / shapes::kPi;
    if (std::lround(turn) % 2 != 0) p.x() *= middle, p.y() *= middle;
  }
  return soup;
}

TEST(Creases, CornersAreNoZigzag) {
  // Ten sides meet at 36 degrees: the rims are creases, what runs up the wall is none.
  EXPECT_EQ(count(detect_creases(build(prism(10)), 40)), 40);
}

TEST(Creases, JagsFinerThanAFoldDoNotHideIt) {
  // Every other row of points is moved next to the one before and aside: short edges across the fold.
  const double slope = std::tan(shapes::kPi / 4), jag = 0.004;
  const SurfaceMesh m = build(shapes::grid({24, 24}, [=](double u, double v) {
    const int row = static_cast<int>(std::lround(24 * v));
    const bool odd = row % 2 != 0;
    return Vector3(u + (odd ? jag : 0), odd ? (row - 1) / 24.0 + jag : v, -slope * std::abs(u - 0.5));
  }));
  EXPECT_EQ(count(detect_creases(m, 40)), 24);
}

TEST(Creases, AnEdgeBetweenSidesThatCurveBackCounts) {
  // 54 degrees along the one edge from border to border, 16 of which the sheet takes back on both sides.
  const SurfaceMesh m = build(shapes::grid({20, 1}, [](double u, double v) {
    const double x = std::abs(u - 0.5), near = std::min(x, 0.1);
    return Vector3(u, v,
                   -near * std::tan(27 * shapes::kPi / 180) - (x - near) * std::tan(16 * shapes::kPi / 180));
  }));
  EXPECT_EQ(count(detect_creases(m, 40)), 1);
}

TEST(Creases, AShortFoldThatFadesCountsWhereItStartsAtACrease) {
  // A wall with a gable, and a roof whose ridge fades: a fifth of the diagonal long.
  const auto slope = [](double y) {
    return std::tan(35 * std::clamp((0.35 - y) / 0.2, 0.0, 1.0) * shapes::kPi / 180);
  };
  const SurfaceMesh m = build(shapes::grid({12, 96}, [&](double u, double v) {
    const double x = 0.2 * (u - 0.5), y = std::max(0.0, 2 * v - 1), down = std::min(0.0, 2 * v - 1);
    return Vector3(x, y, down - slope(y) * std::abs(x));
  }));
  const int n = count(detect_creases(m, 40));
  EXPECT_GE(n, 12 + 12);
  EXPECT_LE(n, 12 + 14);
}

TEST(Creases, ShortOnesBetweenFlatSidesCountTogether) {
  // A plate with a small block on it, whose edges are all shorter than what counts as a crease by itself.
  const SurfaceMesh m = build(shapes::grid({8, 8}, [](double u, double v) {
    const std::vector<double> place{0, 0.25, 0.465, 0.475, 0.5, 0.525, 0.535, 0.75, 1};
    const auto i = std::lround(8 * u), j = std::lround(8 * v);
    const bool on_top = std::min(i, j) >= 3 && std::max(i, j) <= 5;
    return Vector3(place[i], place[j], on_top ? 0.03 : 0);
  }));
  EXPECT_EQ(count(detect_creases(m, 40)), 4 * 4 + 4 + 4 * 2);  // foot, upright, top
}

TEST(Creases, AWeakBranchDoesNotPartOne) {
  // A fold of 60 degrees that starts at the border and fades, a third of the diagonal long; a bend of 31
  // degrees leads away from it near its start.
  const SurfaceMesh m = build(shapes::grid({8, 24}, [](double u, double v) {
    const double x = 0.3 * (u - 0.5), away = std::clamp(2.5 - std::abs(8 * u - 5.5), 0.0, 1.0);
    const double fold = std::tan(30 * shapes::kPi / 180) * std::clamp((0.45 - v) / 0.2, 0.0, 1.0);
    const double bend = std::tan(18 * shapes::kPi / 180) * std::max(0.0, 1 / 12.0 - std::abs(v - 1 / 12.0));
    return Vector3(x, v, -fold * std::abs(x) + away * bend);
  }));
  const int n = count(detect_creases(m, 40));
  EXPECT_GE(n, 7);
  EXPECT_LE(n, 9);
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

// A sheet folded twice by 45 degrees, along lines that are so far apart.
SurfaceMesh chamfered(double width) {
  return build(shapes::grid({4, 24}, [=](double u, double v) {
    const double x = std::vector<double>{0, 0.5, 0.5 + std::sqrt(0.5) * width, 0.5 + std::sqrt(0.5) * width,
                                         0.5 + std::sqrt(0.5) * width}[std::lround(4 * u)];
    const double z = std::vector<double>{0, 0, -std::sqrt(0.5) * width, -0.25, -0.5}[std::lround(4 * u)];
    return Vector3(x, v, z);
  }));
}

TEST(NarrowRegions, AChamferIsOneLineWhereItIsNarrow) {
  const SurfaceMesh m = chamfered(0.01);
  const std::vector<char> crease = detect_creases(m, 40);
  ASSERT_EQ(count(crease), 48);
  EXPECT_EQ(count(without_narrow_regions(m, crease, 0.005)), 48);
  EXPECT_EQ(count(without_narrow_regions(m, crease, 0.02)), 24);
}

TEST(NarrowRegions, TheWallsOfAThinPlateStay) {
  const SurfaceMesh m = build(shapes::box(6, {1, 1.5, 0.01}));
  const std::vector<char> crease = detect_creases(m, 40);
  EXPECT_EQ(without_narrow_regions(m, crease, 0.03), crease);
}

TEST(NarrowRegions, ChamfersThatMeetLeaveNoLooseEnds) {
  // A box whose upper edges are cut off at 45 degrees.
  TriangleSoup soup = shapes::box(10, {1, 1, 1});
  for (Vector3& p : soup.points) {
    if (p.z() < 0.5 - 1e-9) continue;
    for (double* x : {&p.x(), &p.y()})
      if (std::abs(std::abs(*x) - 0.4) < 1e-9) *x = std::copysign(0.49, *x);
    if (std::max(std::abs(p.x()), std::abs(p.y())) > 0.5 - 1e-9) p.z() = 0.49;
  }
  const SurfaceMesh m = build(soup);
  const std::vector<char> crease = detect_creases(m, 40), left = without_narrow_regions(m, crease, 0.04);
  EXPECT_LE(count(left), count(crease) - 30);  // of a rim of 40 on either side of the cut
  for (int v = 0; v < m.vertex_count(); ++v) {
    const auto ends = std::count_if(m.ring_begin_of(v), m.ring_end_of(v), [&](int e) { return left[e]; });
    EXPECT_NE(ends, 1) << m.points[v].transpose();
  }
}

TEST(NarrowRegions, AThinRodStaysAsItIs) {
  const SurfaceMesh m = build(shapes::box(4, {1, 0.01, 0.01}));
  const std::vector<char> crease = detect_creases(m, 40);
  EXPECT_EQ(without_narrow_regions(m, crease, 0.05), crease);
}

}  // namespace
}  // namespace sheetform
