#include "sheetform/search/patch_tilt.h"

#include <gtest/gtest.h>

#include "unit/morph/ruled_scene.h"

namespace sheetform {
namespace {

// Strips along the axis of a tube are facets: over one of angle a, the tube's normals tilt evenly by 0 to
// a / 2, so 95 % keep to 0.95 a / 2.
TEST(PatchTilt, OfFacetsOfATube) {
  for (double spacing : {0.05, 0.1}) {
    const RuledScene s(shapes::cylinder_patch(240, 4, 1, 0.06, shapes::kPi / 2), {{240, 4}, {}, {}}, spacing);
    const PatchEvaluation& e = *s.patches[0];
    ASSERT_TRUE(e.viable());
    const PatchTilt tilt =
        patch_tilt(s.surface, s.layout.patches[0], *e.chart, e.polygon, e.rulings.triangles, e.polygon.point);
    double longest = 0;  // of the facets' arcs
    for (const Arch& a : s.layout.arches)
      if (s.surface.mesh.points[a.vertices.front()].z() == s.surface.mesh.points[a.vertices.back()].z())
        longest = 90.0 / static_cast<double>(sample_arch(s.surface.mesh, a, spacing).size() - 1);
    ASSERT_GT(longest, 0);
    EXPECT_NEAR(tilt.angle, 0.95 * longest / 2, 0.15 * longest);
  }
}

TEST(PatchTilt, OfAPlaneIsNone) {
  const RuledScene& s = flat_parts();
  const PatchEvaluation& e = *s.patches[0];
  EXPECT_LT(
      patch_tilt(s.surface, s.layout.patches[0], *e.chart, e.polygon, e.rulings.triangles, e.polygon.point)
          .angle,
      1e-6);
}

// A saddle bends along every chord; its parts fail a narrow limit and pass a wide one.
TEST(PatchTilt, DecidesWhetherAPatchIsViable) {
  const RuledScene& s = saddle_parts();
  RunContext context;
  const auto viable = [&](double limit) {
    EvaluationParams params = s.params;
    params.e_max = 0.1;
    params.normal_deviation = limit;
    LayoutEvaluator evaluator(s.surface, params, context);
    int count = 0;
    for (const auto& e : evaluator.patches(s.layout)) count += e->viable();
    return count;
  };
  const int all = static_cast<int>(s.layout.patches.size());
  EXPECT_EQ(viable(0), all);
  EXPECT_EQ(viable(60), all);
  EXPECT_EQ(viable(0.1), 0);
}

}  // namespace
}  // namespace sheetform
