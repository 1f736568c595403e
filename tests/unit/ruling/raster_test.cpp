#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/one_patch.h"

namespace sheetform {
namespace {

using shapes::OnePatch;

const ChartParams kConverged{300, 0};

TEST(ChartRaster, LiftsPointsOfADevelopablePatchOntoIt) {
  const OnePatch o(shapes::cylinder_patch(32, 16), kConverged);
  const ChartRaster raster(o.mesh, o.guide(), o.patch(), o.chart, 3000);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0, 1);
  for (int i = 0; i < 500; ++i) {
    const std::size_t t = random() % o.chart.triangles.size();
    double b = share(random), c = share(random);
    if (b + c > 1) b = 1 - b, c = 1 - c;
    const auto &tri = o.chart.triangles[t], &face = o.mesh.faces[o.patch().faces[t]];
    const Vector2 u = (1 - b - c) * o.chart.uv[tri[0]] + b * o.chart.uv[tri[1]] + c * o.chart.uv[tri[2]];
    const Vector3 p =
        (1 - b - c) * o.mesh.points[face[0]] + b * o.mesh.points[face[1]] + c * o.mesh.points[face[2]];
    EXPECT_LT((raster.lift(static_cast<int>(t), u) - p).norm(), 1e-9) << "exact inside of the triangle";
    const int found = raster.triangle_at(u);
    ASSERT_GE(found, 0);
    // A neighbour at most: over a fold of one edge the planes part slowly.
    EXPECT_LT((raster.lift(found, u) - p).norm(), raster.cell() * 0.1);
    EXPECT_NEAR(raster.normal(found).dot(Vector3(p.x(), p.y(), 0).normalized()), 1, 0.01);
  }
}

TEST(ChartRaster, KnowsItsEnd) {
  const OnePatch o(shapes::plane(10), kConverged);
  const ChartRaster raster(o.mesh, o.guide(), o.patch(), o.chart, 3000);
  Vector2 middle = Vector2::Zero();
  for (const Vector2& u : o.chart.uv) middle += u / static_cast<double>(o.chart.uv.size());
  EXPECT_GE(raster.triangle_at(middle), 0);
  for (double angle = 0; angle < 6.3; angle += 0.1) {
    const Vector2 out(std::cos(angle), std::sin(angle));
    EXPECT_LT(raster.triangle_at(middle + 0.9 * out), 0);
    EXPECT_LT(raster.triangle_at(middle + 1e6 * out), 0);
  }
  // From the middle of a side: half a cell outside is still answered, three cells are not.
  const auto& side = o.chart.boundary[0];
  const Vector2 a = o.chart.uv[side.front()], b = o.chart.uv[side.back()], m = (a + b) / 2;
  const Vector2 out = Vector2((b - a).y(), -(b - a).x()).normalized();
  EXPECT_GE(raster.triangle_at(m + 0.4 * raster.cell() * out), 0);
  EXPECT_LT(raster.triangle_at(m + 3 * raster.cell() * out), 0);
}

TEST(ChartRaster, MisalignmentIsTheSquaredSineToTheAxis) {
  const OnePatch o(shapes::cylinder_patch(32, 16), kConverged);
  const SurfaceGuide guide = o.guide();
  const ChartRaster raster(o.mesh, guide, o.patch(), o.chart, 3000);
  // The flat axis: from a vertex to the one above it.
  int v = -1, w = -1;
  for (std::size_t i = 0; i < o.chart.vertices.size(); ++i) {
    const Vector3& p = o.mesh.points[o.chart.vertices[i]];
    if (std::abs(p.y() - p.x()) > 1e-9) continue;
    if (std::abs(p.z() - 0.25) < 1e-9) v = static_cast<int>(i);
    if (std::abs(p.z() - 0.75) < 1e-9) w = static_cast<int>(i);
  }
  ASSERT_TRUE(v >= 0 && w >= 0);
  const Vector2 axis = (o.chart.uv[w] - o.chart.uv[v]).normalized(), across(-axis.y(), axis.x());
  const int t = raster.triangle_at((o.chart.uv[v] + o.chart.uv[w]) / 2);
  for (double angle = 0; angle < 3.2; angle += 0.2) {
    const double s = std::sin(angle);
    EXPECT_NEAR(raster.misalignment(t, std::cos(angle) * axis + s * across),
                guide.strength[o.patch().faces[t]] * s * s, 0.01);
  }
}

}  // namespace
}  // namespace sheetform
