#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "sheetform/strip/outline.h"
#include "support/drawing.h"
#include "support/one_patch.h"

namespace sheetform {
namespace {

using shapes::Canvas;
using shapes::Drawing;
using shapes::drawn;
using shapes::OnePatch;

// A polyline with steps of very different lengths, as an arch of a mesh of one row of quads.
struct Uneven {
  SurfaceMesh mesh;
  Arch arch;
  Uneven() {
    const std::vector<double> x{0, 0.01, 0.02, 0.5, 0.9, 1};
    TriangleSoup soup;
    for (double v : x) soup.points.emplace_back(v, 0, 0);
    for (double v : x) soup.points.emplace_back(v, 1, 0);
    for (int i = 0; i + 1 < 6; ++i)
      soup.faces.push_back({i, i + 1, i + 7}), soup.faces.push_back({i, i + 7, i + 6});
    mesh = build_surface_mesh(soup.points, soup.faces);
    for (int i = 0; i < 6; ++i) arch.vertices.push_back(i);
    for (int i = 0; i < 5; ++i) arch.edges.push_back(mesh.find_edge(i, i + 1));
    arch.length = 1;
  }
};

TEST(SampleArch, IsEvenAlongTheArchWhateverTheEdges) {
  const Uneven u;
  for (double spacing : {0.3, 0.1, 0.07, 0.013}) {
    const auto at = sample_arch(u.mesh, u.arch, spacing);
    const int n = static_cast<int>(at.size()) - 1;
    EXPECT_EQ(n, std::lround(1 / spacing));
    EXPECT_EQ(at.front(), 0);
    EXPECT_EQ(at.back(), 5);
    for (int i = 0; i <= n; ++i) {
      const Vector3 p = arch_point(u.mesh, u.arch, at[i]);
      EXPECT_NEAR(p.x(), double(i) / n, 1e-12);
      EXPECT_EQ(p.y(), 0);
      EXPECT_TRUE(i == 0 || at[i] > at[i - 1]);
    }
  }
}

TEST(SampleArch, HasAtLeastTwoSegments) {
  const Uneven u;
  EXPECT_EQ(sample_arch(u.mesh, u.arch, 100).size(), 3u);
}

TEST(SampleArch, ClosedArchHasAtLeastThreeSegments) {
  Canvas canvas;
  canvas.one_path = true;
  const Drawing d = drawn("AAA/ABA/AAA", canvas);
  const PatchLayout layout = d.layout();
  const Arch& arch = layout.arches[layout.patches[d.patch_of(layout, 'B')].boundary[0].arch];
  ASSERT_TRUE(arch.closed());
  const auto at = sample_arch(d.mesh, arch, 100);
  EXPECT_GE(at.size(), 4u);
  EXPECT_EQ(arch_point(d.mesh, arch, at.front()), arch_point(d.mesh, arch, at.back()));
}

TEST(ArchPoint, LiesOnTheEdges) {
  const Uneven u;
  EXPECT_EQ(arch_point(u.mesh, u.arch, 0), Vector3(0, 0, 0));
  EXPECT_NEAR(arch_point(u.mesh, u.arch, 2.5).x(), 0.26, 1e-15);
  EXPECT_EQ(arch_point(u.mesh, u.arch, 5), Vector3(1, 0, 0));
}

TEST(PatchPolygon, GoesAroundOnceCounterClockwise) {
  const OnePatch o(shapes::cylinder_patch(24, 16, 1, 1, 1.0), {300, 0});
  const PatchPolygon polygon = o.polygon(0.1);
  ASSERT_EQ(polygon.size(), 40);
  EXPECT_NEAR(signed_area(polygon.uv), 1.0, 1e-3);
  int nodes = 0;
  for (int i = 0; i < 40; ++i) {
    nodes += polygon.node[i] != 0;
    EXPECT_NEAR((polygon.uv[(i + 1) % 40] - polygon.uv[i]).norm(), 0.1, 1e-3);
    EXPECT_NEAR((polygon.point[(i + 1) % 40] - polygon.point[i]).norm(), 0.1, 1e-3);
    EXPECT_NEAR(polygon.point[i].head<2>().norm(), 1, 1e-3);
  }
  EXPECT_EQ(nodes, 4);
}

TEST(PatchPolygon, KnowsWhereEachPointComesFrom) {
  const Drawing d = drawn("AAB/AAC");
  const PatchLayout layout = d.layout();
  std::vector<std::vector<double>> samples;
  for (const Arch& a : layout.arches) samples.push_back(sample_arch(d.mesh, a, 0.3));
  std::map<std::pair<int, int>, Vector3> seen;  // (arch, sample) -> place: the same from both sides
  for (const Patch& patch : layout.patches) {
    const PatchChart chart = parametrize(d.mesh, layout, patch, {});
    const PatchPolygon polygon = patch_polygon(d.mesh, layout, patch, chart, samples);
    for (int i = 0; i < polygon.size(); ++i) {
      const int arch = patch.boundary[polygon.origin[i].use].arch, sample = polygon.origin[i].sample;
      EXPECT_EQ(polygon.point[i], arch_point(d.mesh, layout.arches[arch], samples[arch][sample]));
      const bool end = sample == 0 || sample + 1 == static_cast<int>(samples[arch].size());
      EXPECT_EQ(polygon.node[i] != 0, end);
      const auto [it, fresh] = seen.emplace(std::pair{arch, sample}, polygon.point[i]);
      EXPECT_EQ(it->second, polygon.point[i]);
    }
  }
}

TEST(PatchPolygon, BothSidesOfASeamAreTheSamePointsApartInThePlane) {
  Canvas canvas;
  canvas.steps = 6;
  canvas.roll = true;
  canvas.place = [](double x, double y) {
    return Vector3(std::cos(shapes::kPi * x / 2), std::sin(shapes::kPi * x / 2), y);
  };
  const Drawing d = drawn("AAAA|/AAAA|", canvas);
  const PatchLayout layout = d.layout();
  std::vector<std::vector<double>> samples;
  for (const Arch& a : layout.arches) samples.push_back(sample_arch(d.mesh, a, 0.25));
  const PatchChart chart = parametrize(d.mesh, layout, layout.patches[0], {});
  const PatchPolygon polygon = patch_polygon(d.mesh, layout, layout.patches[0], chart, samples);
  std::map<std::pair<int, int>, std::vector<int>> places;
  for (int i = 0; i < polygon.size(); ++i)
    places[{layout.patches[0].boundary[polygon.origin[i].use].arch, polygon.origin[i].sample}].push_back(i);
  int twice = 0;
  for (const auto& [origin, at] : places) {
    if (at.size() < 2) continue;
    ++twice;
    EXPECT_EQ(polygon.point[at[0]], polygon.point[at[1]]);
    EXPECT_GT((polygon.uv[at[0]] - polygon.uv[at[1]]).norm(), 5);
  }
  EXPECT_GE(twice, 7);
}

}  // namespace
}  // namespace sheetform
