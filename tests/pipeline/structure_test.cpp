// Shapes whose best decomposition is known. What is promised of lengths is the tolerance.
#include <algorithm>
#include <cmath>

#include "pipeline/run.h"

namespace sheetform {
namespace {

TriangleSoup moved(TriangleSoup soup, const Vector3& by) {
  for (Vector3& p : soup.points) p += by;
  return soup;
}

TriangleSoup together(TriangleSoup a, const TriangleSoup& b) {
  const int shift = static_cast<int>(a.points.size());
  a.points.insert(a.points.end(), b.points.begin(), b.points.end());
  for (const auto& f : b.faces) a.faces.push_back({f[0] + shift, f[1] + shift, f[2] + shift});
  return a;
}

TEST(Structure, OpenTubeIsOneSheetGluedToItself) {
  const TriangleSoup soup = shapes::cylinder(60, 20);
  const Decomposition d = run(soup);
  expect_sound(soup, d);
  ASSERT_EQ(d.strips.patches.size(), 1u);
  EXPECT_EQ(self_seams(d.strips), 1);
  EXPECT_EQ(d.strips.arches.size(), 3u);
  EXPECT_TRUE(d.report.e_max_met);
  EXPECT_NEAR(d.report.cut_length * d.bbox_diagonal, 2, 0.05) << "the seam runs straight along the axis";
  EXPECT_NEAR(area_of(d.strips, d.strips.patches[0]), 4 * shapes::kPi, 0.25);
}

TEST(Structure, ClosedCylinderIsTwoDiscsAndAWall) {
  const TriangleSoup soup = shapes::closed_cylinder(60, 20);
  const Decomposition d = run(soup);
  expect_sound(soup, d);
  ASSERT_EQ(d.strips.patches.size(), 3u);
  EXPECT_TRUE(d.report.e_max_met);
  // Rims of two times a full turn: the seam's ends part them or not.
  EXPECT_GE(creases(d.strips), 2);
  EXPECT_NEAR(crease_length(d.strips), 4 * shapes::kPi, 0.25);
  EXPECT_EQ(self_seams(d.strips), 1);
  std::vector<double> areas;
  for (const auto& p : d.strips.patches) areas.push_back(area_of(d.strips, p));
  std::sort(areas.begin(), areas.end());
  EXPECT_NEAR(areas[0], shapes::kPi, 0.1);
  EXPECT_NEAR(areas[1], shapes::kPi, 0.1);
  EXPECT_NEAR(areas[2], 4 * shapes::kPi, 0.25);
  for (const auto& p : d.strips.patches)
    EXPECT_EQ(p.rulings.empty(), area_of(d.strips, p) < 4)
        << "flat discs have no lines to fold, the wall has";
}

// Corners of the border are no reason to cut a plate.
TEST(Structure, CombIsOneSheet) {
  const TriangleSoup soup = shapes::comb(32, 4);
  const Decomposition d = run(soup);
  expect_sound(soup, d);
  EXPECT_EQ(d.strips.patches.size(), 1u);
  EXPECT_EQ(d.strips.patches[0].corners.size(), 6u) << "of 16 or so";
  EXPECT_LT(d.report.hausdorff, 0.002);
}

// Two bowls of an ellipse, rim to rim: the rim is sharp, what it bounds is curved both ways.
TriangleSoup lens(int around, int rings) {
  TriangleSoup soup = shapes::grid({around, 2 * rings, true, false}, [](double u, double v) {
    const double a = 2 * shapes::kPi * u, up = 2 * v - 1, r = 0.02 + 0.98 * (1 - std::abs(up));
    return Vector3(r * std::cos(a), 0.7 * r * std::sin(a), (up < 0 ? -0.35 : 0.35) * (1 - r * r));
  });
  return soup;
}

// Share of the rim of the lens that an arch runs along within half a percent of the diagonal.
double rim_kept(const Decomposition& d) {
  std::vector<std::array<int, 3>> segments;
  for (const StripMesh::Arch& a : d.strips.arches)
    for (std::size_t i = 0; i + 1 < a.vertices.size(); ++i)
      segments.push_back({a.vertices[i], a.vertices[i + 1], a.vertices[i + 1]});
  const ClosestPointTree arches(d.strips.points, segments);
  constexpr int kPlaces = 360;
  double kept = 0;
  for (int i = 0; i < kPlaces; ++i) {
    const double a = 2 * shapes::kPi * i / kPlaces;
    const Vector3 place(std::cos(a), 0.7 * std::sin(a), 0);
    kept += std::sqrt(arches.closest(place).squared_distance) < 0.005 * d.bbox_diagonal;
  }
  return kept / kPlaces;
}

TEST(Structure, ArchesStayOnCreasesThoughTheToleranceIsWide) {
  const TriangleSoup soup = lens(48, 16);
  const Decomposition d = run(soup, with_e_max(0.03));
  expect_sound(soup, d);
  EXPECT_TRUE(d.report.e_max_met);
  EXPECT_GT(rim_kept(d), 0.9);
}

TEST(Structure, BoxIsItsSixFaces) {
  const TriangleSoup soup = shapes::box(12, {1, 2, 3});
  const Decomposition d = run(soup);
  expect_sound(soup, d);
  ASSERT_EQ(d.strips.patches.size(), 6u);
  ASSERT_EQ(d.strips.arches.size(), 12u);
  EXPECT_EQ(creases(d.strips), 12);
  EXPECT_NEAR(crease_length(d.strips), 24, 0.24);
  EXPECT_TRUE(d.report.e_max_met);
  for (const auto& p : d.strips.patches) EXPECT_EQ(p.corners.size(), 4u);
  for (const auto& p : d.strips.patches) EXPECT_TRUE(p.rulings.empty()) << "a flat face is not folded";
}

// A box as a volume gives it: along its edges run narrow facets, which are no parts.
TEST(Structure, ChamfersOfAVolumeAreNoParts) {
  const TriangleSoup box =
      shapes::isosurface([](const Vector3& p) { return (p.cwiseAbs() - Vector3(0.8, 0.5, 0.3)).maxCoeff(); },
                         {1, 0.7, 0.5}, {25, 18, 13});
  const Decomposition d = run(box, with_e_max(0.07), 2);
  expect_sound(box, d);
  EXPECT_LE(d.strips.patches.size(), 6u);
}

TEST(Structure, PlaneIsOneSheet) {
  const TriangleSoup soup = shapes::plane(20);
  const Decomposition d = run(soup);
  expect_sound(soup, d);
  ASSERT_EQ(d.strips.patches.size(), 1u);
  EXPECT_EQ(d.strips.patches[0].corners.size(), 4u);
  EXPECT_TRUE(d.report.e_max_met);
  EXPECT_EQ(d.report.cut_length, 0);
  EXPECT_NEAR(d.report.border_length, 4 / std::sqrt(2), 0.02);
}

TEST(Structure, QuarterCylinderIsOneSheet) {
  const TriangleSoup soup = shapes::cylinder_patch(40, 20);
  const Decomposition d = run(soup);
  expect_sound(soup, d);
  EXPECT_EQ(d.strips.patches.size(), 1u);
  EXPECT_TRUE(d.report.e_max_met);
}

TEST(Structure, GentleSaddleIsOneSheet) {
  const TriangleSoup soup = shapes::saddle(30, 0.3);
  const Decomposition d = run(soup);
  expect_sound(soup, d);
  EXPECT_EQ(d.strips.patches.size(), 1u) << "straight lines lie in it";
  EXPECT_TRUE(d.report.e_max_met);
}

TEST(Structure, HelicoidNeedsFewSheets) {
  const TriangleSoup soup = shapes::helicoid(24, 30, 1, 2, 0.25);
  const Decomposition d = run(soup);
  expect_sound(soup, d);
  EXPECT_TRUE(d.report.e_max_met);
  EXPECT_LE(d.strips.patches.size(), 2u);
}

TEST(Structure, TorusIsClosed) {
  const TriangleSoup soup = shapes::torus(72, 36);
  const Decomposition d = run(soup, {}, 2);
  expect_sound(soup, d);
  EXPECT_TRUE(d.report.e_max_met);
  EXPECT_EQ(d.report.border_length, 0);
  for (const auto& a : d.strips.arches) EXPECT_GE(a.patches[1], 0);
  EXPECT_LE(d.strips.patches.size(), 10u) << "the trial needed 8 and more";
}

TEST(Structure, SphereIsClosed) {
  const TriangleSoup soup = shapes::sphere(18);
  const Decomposition d = run(soup, {}, 2);
  expect_sound(soup, d);
  EXPECT_TRUE(d.report.e_max_met);
  EXPECT_GE(d.strips.patches.size(), 2u);
  EXPECT_LE(d.strips.patches.size(), 9u) << "the trial needed 7";
}

TEST(Structure, TwoComponentsAreTwoResultsInOne) {
  const TriangleSoup soup =
      together(shapes::box(8, {1, 1, 1}), moved(shapes::cylinder(40, 12, 0.5, 1), {3, 0, 0}));
  const Decomposition d = run(soup);
  expect_sound(soup, d);
  ASSERT_EQ(d.strips.patches.size(), 7u);
  int second = 0;
  for (const auto& p : d.strips.patches) {
    second += p.component == 1;
    for (int v : p.boundary) EXPECT_EQ(d.strips.points[v].x() > 1.5, p.component == 1);
  }
  EXPECT_EQ(second, 1);
  EXPECT_TRUE(d.report.e_max_met);
}

TEST(Structure, RoundHoleStaysOpen) {
  // A flat ring: two border loops.
  const TriangleSoup soup = shapes::grid({60, 10, true, false}, [](double u, double v) {
    const double a = -2 * shapes::kPi * u, r = 0.5 + 0.5 * v;
    return Vector3(r * std::cos(a), r * std::sin(a), 0);
  });
  const Decomposition d = run(soup);
  expect_sound(soup, d);
  EXPECT_LE(d.strips.patches.size(), 2u);
  EXPECT_TRUE(d.report.e_max_met);
}

TEST(Structure, ConeIsOneSheet) {
  const TriangleSoup soup = shapes::grid({60, 16, true, false}, [](double u, double v) {
    const double a = 2 * shapes::kPi * u, r = 0.2 + 0.8 * (1 - v);
    return Vector3(r * std::cos(a), r * std::sin(a), 1.5 * v);
  });
  const Decomposition d = run(soup);
  expect_sound(soup, d);
  EXPECT_EQ(d.strips.patches.size(), 1u);
  EXPECT_TRUE(d.report.e_max_met);
}

}  // namespace
}  // namespace sheetform
