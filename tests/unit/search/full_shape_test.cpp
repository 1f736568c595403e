#include "sheetform/search/full_shape.h"

#include <gtest/gtest.h>

#include <numeric>

#include "unit/morph/ruled_scene.h"

namespace sheetform {
namespace {

std::vector<Vector3> places(const RuledScene& s, const std::vector<char>& keep) {
  return full_morph_places(s.surface, s.layout, s.reduced, s.params, keep, RunContext{});
}

TEST(FullShape, IsThatOfTheFullMorph) {
  for (const RuledScene* s : {&torus_sections(), &saddle_parts()}) {
    SearchSurface surface = s->surface;
    surface.curvature = &s->curvature;
    const std::vector<Vector3> x = full_morph_places(surface, s->layout, s->reduced, s->params,
                                                     std::vector<char>(s->patches.size(), 0), RunContext{});
    const FullMorphResult full = full_morph(s->problem, {}, RunContext{});
    for (std::size_t a = 0; a < full.arch_points.size(); ++a)
      for (std::size_t k = 0; k < full.arch_points[a].size(); ++k)
        EXPECT_EQ(x[s->reduced.arch_unknowns[a][k]], full.arch_points[a][k]);
  }
}

TEST(FullShape, PatchesThatStayKeepTheirOutlines) {
  const RuledScene& s = torus_sections();
  std::vector<char> keep(s.patches.size(), 0);
  keep[0] = keep[5] = 1;
  const std::vector<Vector3> x = places(s, keep);
  int moved = 0;
  for (std::size_t p = 0; p < keep.size(); ++p)
    for (int u : s.reduced.unknowns[p]) {
      if (keep[p]) {
        EXPECT_EQ(x[u], s.reduced.position[u]);
      }
      moved += x[u] != s.reduced.position[u];
    }
  EXPECT_GT(moved, 100);
}

TEST(FullShape, OfNoPatchIsTheReducedOne) {
  const RuledScene& s = saddle_parts();
  EXPECT_EQ(places(s, std::vector<char>(s.patches.size(), 1)), s.reduced.position);
}

}  // namespace
}  // namespace sheetform
