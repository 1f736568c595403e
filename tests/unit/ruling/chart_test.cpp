#include "sheetform/ruling/chart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "sheetform/strip/outline.h"
#include "support/drawing.h"
#include "support/one_patch.h"

namespace sheetform {
namespace {

using shapes::Canvas;
using shapes::Drawing;
using shapes::drawn;
using shapes::OnePatch;

const ChartParams kConverged{400, 0, 0};

struct Sheet {
  const char* name;
  TriangleSoup soup;
  double distortion;  // allowed with the parameters of the search
};
void PrintTo(const Sheet& s, std::ostream* out) { *out << s.name; }

// Grids of planar quads on developable surfaces: the mesh itself unfolds without strain.
class Developable : public ::testing::TestWithParam<Sheet> {};
TEST_P(Developable, FlattensExactlyWhenConverged) {
  const OnePatch o(GetParam().soup, kConverged);
  EXPECT_LT(shapes::worst_strain(o.mesh, o.patch(), o.chart), 1e-8);
  EXPECT_LT(o.chart.distortion, 1e-14);
  EXPECT_EQ(o.chart.folded, 0);
}
TEST_P(Developable, FlattensNearlyWithTheFewIterationsOfTheSearch) {
  const OnePatch o(GetParam().soup);
  EXPECT_LT(o.chart.distortion, GetParam().distortion);
  EXPECT_EQ(o.chart.folded, 0);
}
INSTANTIATE_TEST_SUITE_P(Sheets, Developable,
                         ::testing::Values(Sheet{"plane", shapes::plane(12), 1e-12},
                                           Sheet{"quarter_cylinder", shapes::cylinder_patch(24, 16), 1e-12},
                                           Sheet{"half_cylinder",
                                                 shapes::cylinder_patch(48, 16, 1, 1, shapes::kPi), 1e-12},
                                           Sheet{"cone_sector", shapes::cone_sector(30, 16, 1.2, 0.6), 1e-5},
                                           Sheet{"wide_cone", shapes::cone_sector(80, 16, 4.0, 0.6), 2e-5}));

TEST(Chart, CylinderHasItsSizeInThePlane) {
  const OnePatch o(shapes::cylinder_patch(24, 16, 2, 3, 1.5), kConverged);
  const double width = 24 * 2 * 2 * std::sin(1.5 / 24 / 2);  // of the polygon
  std::vector<Vector2> outline;
  for (const auto& line : o.chart.boundary)
    for (std::size_t i = 0; i + 1 < line.size(); ++i) outline.push_back(o.chart.uv[line[i]]);
  EXPECT_NEAR(signed_area(outline), 3 * width, 1e-8);
  // The corners are as far apart as in the sheet.
  ASSERT_EQ(o.chart.boundary.size(), 4u);
  const Vector2 a = o.chart.uv[o.chart.boundary[0][0]], c = o.chart.uv[o.chart.boundary[2][0]];
  EXPECT_NEAR((a - c).norm(), std::hypot(3, width), 1e-8);
}

struct Curved {
  const char* name;
  TriangleSoup soup;
};
void PrintTo(const Curved& s, std::ostream* out) { *out << s.name; }

TriangleSoup cap() {
  return shapes::grid({20, 20}, [](double u, double v) {
    const double x = u - .5, y = v - .5;
    return Vector3(x, y, std::sqrt(1 - x * x - y * y));
  });
}

class NotDevelopable : public ::testing::TestWithParam<Curved> {};
TEST_P(NotDevelopable, StrainsButDoesNotFold) {
  const OnePatch o(GetParam().soup);
  EXPECT_EQ(o.chart.folded, 0);
  EXPECT_GT(o.chart.distortion, 1e-5);
  for (const auto& t : o.chart.triangles)
    EXPECT_GT(signed_area({o.chart.uv[t[0]], o.chart.uv[t[1]], o.chart.uv[t[2]]}), 0);
}
TEST_P(NotDevelopable, MoreIterationsStrainLess) {
  double last = 1e9;
  for (int iterations : {0, 1, 3, 10, 100}) {
    const OnePatch o(GetParam().soup, {iterations, 0, 0});
    EXPECT_LT(o.chart.distortion, last * 1.001) << iterations;
    last = o.chart.distortion;
  }
}
TEST_P(NotDevelopable, TheOutlineStaysWhereTheMapIsCloseEnough) {
  const TriangleSoup& soup = GetParam().soup;
  const OnePatch held(soup, {0, 0, 0}), settled(soup, {4, 0, 0});
  const double most = held.chart.distortion;
  EXPECT_EQ(OnePatch(soup, {4, 0, 1.01 * most}).chart.uv, held.chart.uv);
  EXPECT_EQ(OnePatch(soup, {4, 0, 0.99 * most}).chart.uv, settled.chart.uv);
}
INSTANTIATE_TEST_SUITE_P(Shapes, NotDevelopable,
                         ::testing::Values(Curved{"cap", cap()}, Curved{"saddle", shapes::saddle(20, 0.5)},
                                           Curved{"helicoid", shapes::helicoid(20, 20, 1, 1, 0.25)}));

TEST(Chart, FollowsTheSizeOfTheMesh) {
  TriangleSoup small = shapes::saddle(16, 0.4), big = small;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  for (Vector3& p : big.points) p = 1000 * (turn * p) + Vector3(5e3, -2e3, 7e3);
  const OnePatch a(small), b(big);
  EXPECT_NEAR(a.chart.distortion, b.chart.distortion, 1e-9);
  for (const auto& t : a.chart.triangles)
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(1000 * (a.chart.uv[t[k]] - a.chart.uv[t[(k + 1) % 3]]).norm(),
                  (b.chart.uv[t[k]] - b.chart.uv[t[(k + 1) % 3]]).norm(), 1e-6);
}

// What the later stages rely on: triangles in the order of the faces, boundary lines in the order of the
// arches.
void expect_follows_layout(const Drawing& d) {
  const PatchLayout layout = d.layout();
  for (const Patch& patch : layout.patches) {
    ASSERT_EQ(patch.defect, TopologyDefect::kNone);
    const PatchChart chart = parametrize(d.mesh, layout, patch, {});
    ASSERT_EQ(chart.triangles.size(), patch.faces.size());
    for (std::size_t i = 0; i < patch.faces.size(); ++i)
      for (int k = 0; k < 3; ++k)
        EXPECT_EQ(chart.vertices[chart.triangles[i][k]], d.mesh.faces[patch.faces[i]][k]);
    ASSERT_EQ(chart.boundary.size(), patch.boundary.size());
    std::set<int> on_loop;
    for (std::size_t u = 0; u < patch.boundary.size(); ++u) {
      std::vector<int> vertices = layout.arches[patch.boundary[u].arch].vertices;
      if (!patch.boundary[u].forward) std::reverse(vertices.begin(), vertices.end());
      ASSERT_EQ(chart.boundary[u].size(), vertices.size());
      for (std::size_t i = 0; i < vertices.size(); ++i)
        EXPECT_EQ(chart.vertices[chart.boundary[u][i]], vertices[i]);
      for (std::size_t i = 0; i + 1 < vertices.size(); ++i)
        EXPECT_TRUE(on_loop.insert(chart.boundary[u][i]).second);
      EXPECT_EQ(chart.boundary[u].back(), chart.boundary[(u + 1) % patch.boundary.size()].front());
    }
  }
}

TEST(Chart, BoundaryLinesFollowTheArches) {
  expect_follows_layout(drawn("AAB/AAC"));
  expect_follows_layout(drawn("AAAB/CDDB/CDDB/CEEE"));
}

Canvas tube(int columns) {
  Canvas canvas;
  canvas.steps = 6;
  canvas.roll = true;
  canvas.place = [=](double x, double y) {
    const double a = 2 * shapes::kPi * x / columns;
    return Vector3(std::cos(a), std::sin(a), y);
  };
  return canvas;
}

TEST(Chart, TubeIsCutOpenAlongItsSeam) {
  const Drawing d = drawn("AAAA|/AAAA|", tube(4));
  expect_follows_layout(d);
  const PatchLayout layout = d.layout();
  const PatchChart chart = parametrize(d.mesh, layout, layout.patches[0], kConverged);
  EXPECT_EQ(static_cast<int>(chart.vertices.size()), d.mesh.vertex_count() + 13)
      << "the seam's vertices stand there twice";
  EXPECT_LT(shapes::worst_strain(d.mesh, layout.patches[0], chart), 1e-8);
  // A rectangle: both sides of the seam are parallel and the circumference apart.
  const double around = 24 * 2 * std::sin(shapes::kPi / 24);
  for (std::size_t u = 0; u < chart.boundary.size(); ++u) {
    const auto& line = chart.boundary[u];
    const double length = (chart.uv[line.back()] - chart.uv[line.front()]).norm();
    const bool seam = layout.arches[layout.patches[0].boundary[u].arch].left ==
                      layout.arches[layout.patches[0].boundary[u].arch].right;
    EXPECT_NEAR(length, seam ? 2 : around, 1e-7);
  }
}

TEST(Chart, ConcavePatchesDoNotFold) {
  for (const auto& [text, distortion] :
       {std::pair{"AAA/A.A", 1e-5}, {"A../A../AAA", 1e-5}, {"AAAA/A..A/A.AA", 5e-3}}) {
    const Drawing d = drawn(text);
    const PatchLayout layout = d.layout();
    const PatchChart chart = parametrize(d.mesh, layout, layout.patches[0], {200, 0});
    EXPECT_EQ(chart.folded, 0) << text;
    EXPECT_LT(chart.distortion, distortion) << text;
  }
}

TEST(Chart, OneTriangleIsItself) {
  const OnePatch o({{{0, 0, 0}, {3, 0, 0}, {0, 0, 4}}, {{0, 1, 2}}}, kConverged);
  EXPECT_LT(shapes::worst_strain(o.mesh, o.patch(), o.chart), 1e-10);
}

}  // namespace
}  // namespace sheetform
