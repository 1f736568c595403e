// The dynamic programme against every triangulation of small polygons.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include "support/one_patch.h"

namespace sheetform {
namespace {

using shapes::OnePatch;
using Triangles = std::vector<std::array<int, 3>>;
using Pair = std::pair<int, int>;

// All triangulations of the polygon first..last, closed by the chord between them.
std::vector<Triangles> triangulations(int first, int last) {
  if (last - first < 2) return {{}};
  std::vector<Triangles> all;
  for (int k = first + 1; k < last; ++k)
    for (const Triangles& a : triangulations(first, k))
      for (const Triangles& b : triangulations(k, last)) {
        Triangles t = a;
        t.insert(t.end(), b.begin(), b.end());
        t.push_back({first, k, last});
        all.push_back(std::move(t));
      }
  return all;
}

bool on_outline(int a, int b, int m) { return (a + 1) % m == b || (b + 1) % m == a; }

std::set<Pair> chords_of(const Triangles& triangles, int m) {
  std::set<Pair> chords;
  for (const auto& t : triangles)
    for (int k = 0; k < 3; ++k)
      if (!on_outline(t[k], t[(k + 1) % 3], m)) chords.insert(std::minmax(t[k], t[(k + 1) % 3]));
  return chords;
}

// Its dual graph is a path: no triangle has three chords.
bool is_strip(const Triangles& triangles, int m) {
  return std::all_of(triangles.begin(), triangles.end(), [&](const auto& t) {
    return on_outline(t[0], t[1], m) || on_outline(t[1], t[2], m) || on_outline(t[2], t[0], m);
  });
}

struct Case {
  const char* name;
  TriangleSoup soup;
  double spacing;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class AllStrips : public ::testing::TestWithParam<Case> {
 protected:
  AllStrips()
      : shape(GetParam().soup, {200, 0}),
        polygon(shape.polygon(GetParam().spacing)),
        raster(shape.mesh, shape.guide(), shape.patch(), shape.chart, 3000) {
    params.e_max = 0.05;
  }
  // The cost of one triangulation: the only one that is left when all other chords are forbidden.
  RulingSet only(const std::set<Pair>& chords) const {
    const std::function<bool(int, int)> forbidden = [&](int a, int b) {
      return !chords.count(std::minmax(a, b));
    };
    return best_rulings(polygon, raster, params, &forbidden);
  }
  OnePatch shape;
  PatchPolygon polygon;
  ChartRaster raster;
  RulingParams params;
};

TEST_P(AllStrips, TheBestOfThemIsFound) {
  const int m = polygon.size();
  ASSERT_GE(m, 6);
  ASSERT_LE(m, 12);
  int strips = 0;
  double best = std::numeric_limits<double>::infinity();
  std::set<Pair> best_chords;
  for (const Triangles& t : triangulations(0, m - 1)) {
    const std::set<Pair> chords = chords_of(t, m);
    const RulingSet alone = only(chords);
    if (!is_strip(t, m)) {
      EXPECT_FALSE(alone.found) << "only strips are searched";
      continue;
    }
    ++strips;
    if (!alone.found) continue;  // a chord that leaves the patch
    EXPECT_EQ(chords_of(alone.triangles, m), chords);
    if (alone.cost < best) best = alone.cost, best_chords = chords;
  }
  EXPECT_EQ(strips, m << (m - 5)) << "m 2^(m-5) strips of a polygon of m sides";
  const RulingSet set = best_rulings(polygon, raster, params);
  ASSERT_TRUE(set.found);
  EXPECT_NEAR(set.cost, best, 1e-12 * std::max(1.0, best));
  EXPECT_LE(only(chords_of(set.triangles, m)).cost, best * (1 + 1e-12) + 1e-12);
}

TEST_P(AllStrips, StartOfTheOutlineDoesNotMatter) {
  const double cost = best_rulings(polygon, raster, params).cost;
  for (int shift = 1; shift < polygon.size(); ++shift) {
    PatchPolygon turned = polygon;
    std::rotate(turned.uv.begin(), turned.uv.begin() + shift, turned.uv.end());
    std::rotate(turned.point.begin(), turned.point.begin() + shift, turned.point.end());
    EXPECT_NEAR(best_rulings(turned, raster, params).cost, cost, 1e-6 * std::max(1.0, cost));
  }
}

INSTANTIATE_TEST_SUITE_P(Small, AllStrips,
                         ::testing::Values(Case{"quarter_cylinder", shapes::cylinder_patch(24, 16), 0.5},
                                           Case{"flat_cylinder", shapes::cylinder_patch(24, 24, 1, 0.5, 1),
                                                0.3},
                                           Case{"saddle", shapes::saddle(20, 0.5), 0.8},
                                           Case{"cone", shapes::cone_sector(30, 16, 1.2, 0.6), 0.35},
                                           Case{"cap",
                                                shapes::grid({16, 16},
                                                             [](double u, double v) {
                                                               const double x = u - .5, y = v - .4;
                                                               return Vector3(x, y,
                                                                              std::sqrt(1 - x * x - y * y));
                                                             }),
                                                0.4},
                                           Case{"helicoid", shapes::helicoid(16, 24, 0.5, 1, 0.2), 0.4}));

TEST(BestRulingsOfThreePoints, AreOneTriangle) {
  const OnePatch o(shapes::plane(4), {100, 0});
  PatchPolygon polygon = o.polygon(0.5);
  polygon.uv = {polygon.uv[0], polygon.uv[2], polygon.uv[4]};
  polygon.point = {polygon.point[0], polygon.point[2], polygon.point[4]};
  const ChartRaster raster(o.mesh, o.guide(), o.patch(), o.chart, 500);
  const RulingSet set = best_rulings(polygon, raster, {});
  ASSERT_TRUE(set.found);
  EXPECT_EQ(set.triangles.size(), 1u);
  EXPECT_TRUE(set.chords.empty());
}

}  // namespace
}  // namespace sheetform
