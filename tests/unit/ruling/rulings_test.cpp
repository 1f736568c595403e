#include "sheetform/ruling/rulings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>

#include "sheetform/strip/outline.h"
#include "support/drawing.h"
#include "support/one_patch.h"

namespace sheetform {
namespace {

using shapes::OnePatch;

const ChartParams kConverged{300, 0};

struct Ruled {
  OnePatch shape;
  PatchPolygon polygon;
  ChartRaster raster;
  Ruled(TriangleSoup soup, double spacing, const ChartParams& chart = kConverged)
      : shape(std::move(soup), chart),
        polygon(shape.polygon(spacing)),
        raster(shape.mesh, shape.guide(), shape.patch(), shape.chart, 3000) {}
  RulingSet best(const RulingParams& params) const { return best_rulings(polygon, raster, params); }
  Vector3 direction(const RulingSet::Chord& c) const {
    return (polygon.point[c.b] - polygon.point[c.a]).normalized();
  }
  double length(const RulingSet::Chord& c) const { return (polygon.point[c.b] - polygon.point[c.a]).norm(); }
};

RulingParams params_for(double e_max) {
  RulingParams p;
  p.e_max = e_max;
  return p;
}
// The error alone decides.
RulingParams error_only(double e_max) {
  RulingParams p = params_for(e_max);
  p.twist_weight = p.align_weight = 0;
  return p;
}

double degrees(double sine) { return std::asin(std::clamp(sine, -1.0, 1.0)) * 180 / shapes::kPi; }

// A strip: m - 2 triangles, each sharing a chord with the one before, together the whole polygon.
void expect_strip(const PatchPolygon& polygon, const RulingSet& set) {
  ASSERT_TRUE(set.found);
  const int m = polygon.size();
  ASSERT_EQ(static_cast<int>(set.triangles.size()), m - 2);
  ASSERT_EQ(static_cast<int>(set.chords.size()), m - 3);
  double area = 0, chord_area = 0;
  std::set<std::array<int, 2>> chords;
  for (std::size_t t = 0; t < set.triangles.size(); ++t) {
    const auto& [a, b, c] = set.triangles[t];
    const double own = signed_area({polygon.uv[a], polygon.uv[b], polygon.uv[c]});
    EXPECT_GT(own, -1e-9);
    area += own;
    if (t == 0) continue;
    const auto& chord = set.chords[t - 1];
    EXPECT_TRUE(chords.insert({std::min(chord.a, chord.b), std::max(chord.a, chord.b)}).second);
    for (int v : {chord.a, chord.b})
      for (const auto& tri : {set.triangles[t - 1], set.triangles[t]})
        EXPECT_EQ(std::count(tri.begin(), tri.end(), v), 1)
            << "chord " << t - 1 << " lies between its triangles";
    EXPECT_NE((chord.a + 1) % m, chord.b);
    EXPECT_NE((chord.b + 1) % m, chord.a);
    chord_area += chord.area;
  }
  const auto area_of = [&](const std::array<int, 3>& t) {
    return signed_area({polygon.uv[t[0]], polygon.uv[t[1]], polygon.uv[t[2]]});
  };
  EXPECT_NEAR(area, signed_area(polygon.uv), 1e-9);
  EXPECT_NEAR(chord_area, area - (area_of(set.triangles.front()) + area_of(set.triangles.back())) / 2, 1e-6);
}

TEST(BestRulings, OnACylinderRunAlongTheAxis) {
  for (const double angle : {0.8, shapes::kPi / 2, shapes::kPi}) {
    const double spacing = 0.1;
    const Ruled r(shapes::cylinder_patch(40, 16, 1, 1, angle), spacing);
    const RulingSet set = r.best(params_for(0.05));
    expect_strip(r.polygon, set);
    // An arc over one step of the outline is all that is left: sagitta s^2 / 8.
    EXPECT_LT(set.predicted_error, 1.2 * spacing * spacing / 8);
    for (const auto& c : set.chords)
      if (r.length(c) > 0.9) {
        EXPECT_LT(degrees(r.direction(c).head<2>().norm()), 8.6) << "one and a half steps aside";
      }
  }
}

TEST(BestRulings, OnACylinderThatIsLongAlongItsAxisToo) {
  const Ruled r(shapes::cylinder_patch(24, 48, 1, 3, 0.8), 0.1);
  const RulingSet set = r.best(params_for(0.05));
  expect_strip(r.polygon, set);
  EXPECT_LT(set.predicted_error, 1.2 * 0.01 / 8);
  for (const auto& c : set.chords)
    if (r.length(c) > 1) {
      EXPECT_LT(degrees(r.direction(c).head<2>().norm()), 6);
    }
}

TEST(BestRulings, SearchChartIsGoodEnoughForACylinder) {
  const Ruled r(shapes::cylinder_patch(40, 16), 0.1, ChartParams{});
  const RulingSet set = r.best(params_for(0.05));
  double along = 0, all = 0;
  for (const auto& c : set.chords) {
    if (r.length(c) < 0.9) continue;
    all += r.length(c);
    if (degrees(r.direction(c).head<2>().norm()) < 15) along += r.length(c);
    EXPECT_LT(degrees(r.direction(c).head<2>().norm()), 20);
  }
  EXPECT_GT(along, 0.85 * all);
}

TEST(BestRulings, OnAConeFanOutFromTheApex) {
  for (const double angle : {1.2, 4.0}) {
    const Ruled r(shapes::cone_sector(60, 20, angle, 0.6), 0.1);
    const RulingSet set = r.best(error_only(0.05));
    expect_strip(r.polygon, set);
    EXPECT_LT(set.predicted_error, 1.2 * 0.01 / 8);
    for (const auto& c : set.chords) {
      const Vector3 &a = r.polygon.point[c.a], &b = r.polygon.point[c.b];
      if (r.length(c) < 0.5) continue;
      EXPECT_LT(degrees(r.direction(c).cross((a + b).normalized()).norm()), 12) << "points at the apex";
    }
  }
}

TEST(BestRulings, OnASaddleRunAlongOneOfItsTwoFamiliesOfLines) {
  const double k = 0.2, spacing = 0.08;
  const Ruled r(shapes::saddle(30, k), spacing);
  const RulingSet set = r.best(error_only(0.02));
  expect_strip(r.polygon, set);
  int along_x = 0, along_y = 0;
  for (const auto& c : set.chords) {
    if (r.length(c) < 1) continue;
    const Vector3 d = r.direction(c);
    ++(std::abs(d.x()) > std::abs(d.y()) ? along_x : along_y);
    EXPECT_LT(degrees(std::min(std::abs(d.x()), std::abs(d.y()))), 15);
  }
  EXPECT_TRUE(along_x == 0 || along_y == 0) << along_x << ' ' << along_y;
  // A diagonal over one step leaves k s l / 4 of height; the chart adds its strain.
  EXPECT_LT(set.predicted_error, 0.01);
}

TEST(BestRulings, OnATwistedRibbonRunAcross) {
  // A narrow helicoid: its straight lines are short and horizontal, and everything else is bent.
  const Ruled r(shapes::helicoid(12, 80, 0.3, 3, 0.5), 0.1);
  const RulingSet set = r.best(error_only(0.01));
  expect_strip(r.polygon, set);
  int across = 0;
  for (const auto& c : set.chords) {
    const Vector3 &a = r.polygon.point[c.a], &b = r.polygon.point[c.b];
    if (std::min(a.z(), b.z()) < 0.3 || std::max(a.z(), b.z()) > 2.7)
      continue;  // both ends are closed by a fan
    ++across;
    EXPECT_LT(std::abs(a.z() - b.z()), 0.16);
  }
  EXPECT_GT(across, 30);
}

TEST(BestRulings, PlaneCostsNothing) {
  const Ruled r(shapes::plane(12), 0.1);
  const RulingSet set = r.best(params_for(0.01));
  expect_strip(r.polygon, set);
  EXPECT_LT(set.predicted_error, 1e-7);
  EXPECT_LT(set.cost, 1e-9);
}

// Of the one patch of a drawing in the plane.
RulingSet flat_rulings(const char* text, PatchPolygon* outline = nullptr) {
  const shapes::Drawing d = shapes::drawn(text);
  const PatchLayout layout = d.layout();
  const PatchChart chart = parametrize(d.mesh, layout, layout.patches[0], {200, 0});
  SurfaceGuide guide;
  guide.ruling_direction.assign(d.mesh.faces.size(), Vector3::Zero());
  guide.strength.assign(d.mesh.faces.size(), 0);
  guide.normal.assign(d.mesh.faces.size(), Vector3::UnitZ());
  std::vector<std::vector<double>> samples;
  for (const Arch& a : layout.arches) samples.push_back(sample_arch(d.mesh, a, 0.25));
  const PatchPolygon polygon = patch_polygon(d.mesh, layout, layout.patches[0], chart, samples);
  if (outline != nullptr) *outline = polygon;
  return best_rulings(polygon, ChartRaster(d.mesh, guide, layout.patches[0], chart, 3000), params_for(0.02));
}

TEST(BestRulings, AreAStripOnConcaveOutlines) {
  for (const char* text : {"AAA/A.A", "A../A../AAA", "AAAA/A..A/A.AA", "..A/AAA/A..", ".A./AAA/.A."}) {
    PatchPolygon polygon;
    const RulingSet set = flat_rulings(text, &polygon);
    ASSERT_TRUE(set.found) << text;
    expect_strip(polygon, set);
  }
}

TEST(BestRulings, HasNoStripWhereEveryOneWouldLeaveTheOutline) {
  // Three arms with bends: the far end of none can be swept from outside of the arm, and a strip has two
  // ends.
  EXPECT_FALSE(flat_rulings("AA...AA/.A...A./.AAAAA./...A.../...AA..").found);
}

TEST(BestRulings, UsesNoForbiddenChord) {
  const Ruled r(shapes::cylinder_patch(40, 16), 0.15);
  const RulingSet free = r.best(params_for(0.05));
  const auto banned = free.chords[free.chords.size() / 2];
  const std::function<bool(int, int)> forbidden = [&](int a, int b) {
    return std::minmax(a, b) == std::minmax(banned.a, banned.b);
  };
  const RulingSet other = best_rulings(r.polygon, r.raster, params_for(0.05), &forbidden);
  expect_strip(r.polygon, other);
  for (const auto& c : other.chords) EXPECT_FALSE(forbidden(c.a, c.b));
  EXPECT_GE(other.cost, free.cost);
  const std::function<bool(int, int)> all = [](int, int) { return true; };
  EXPECT_FALSE(best_rulings(r.polygon, r.raster, params_for(0.05), &all).found);
}

TEST(BestRulings, AlignmentTurnsRulingsToTheLeastCurvature) {
  // A cylinder so flat that no chord costs an error: only the guide tells the axis.
  const Ruled r(shapes::cylinder_patch(30, 30, 1, 0.6, 0.6), 0.06);
  RulingParams params = params_for(10);
  params.twist_weight = 0;
  params.align_weight = 1;
  const RulingSet set = r.best(params);
  double along = 0, all = 0;
  for (const auto& c : set.chords) {
    if (r.length(c) < 0.3) continue;
    all += r.length(c);
    if (degrees(r.direction(c).head<2>().norm()) < 15) along += r.length(c);
  }
  EXPECT_GT(along, 0.95 * all);
}

TEST(BestRulings, TwistIsAvoidedWhenItCosts) {
  const auto twist = [](const Ruled& r, const RulingSet& set) {
    double sum = 0;
    for (const auto& c : set.chords) {
      const Vector2 &a = r.polygon.uv[c.a], &b = r.polygon.uv[c.b];
      const int s = r.raster.triangle_at(a + 0.1 * (b - a)), t = r.raster.triangle_at(b - 0.1 * (b - a));
      sum += c.area * (1 - r.raster.normal(s).dot(r.raster.normal(t)));
    }
    return sum;
  };
  const Ruled r(shapes::saddle(24, 0.2), 0.12);
  RulingParams with = error_only(0.05);
  with.twist_weight = 5;
  EXPECT_LT(twist(r, r.best(with)), 0.95 * twist(r, r.best(error_only(0.05))));
}

TEST(BestRulings, DoNotDependOnTheUnitOrThePlace) {
  TriangleSoup moved = shapes::cylinder_patch(24, 12);
  const Ruled a(moved, 0.15);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vector3(3, 1, 2).normalized()).toRotationMatrix();
  for (Vector3& p : moved.points) p = 4 * (turn * p) + Vector3(10, 20, 30);
  const Ruled b(moved, 0.6);
  RulingParams big = params_for(0.2);
  big.min_height *= 4;
  const RulingSet x = a.best(params_for(0.05)), y = b.best(big);
  EXPECT_NEAR(x.cost, y.cost, 1e-4);
  EXPECT_NEAR(4 * x.predicted_error, y.predicted_error, 1e-4);
}

// A face of a mesh that is a part of its own, far narrower than triangles should be high.
TEST(BestRulings, OfASliverHaveNoTriangleWithoutArea) {
  Ruled r({{{0, 0, 0}, {6.2e-3, 0, 0}, {6.2e-3, 2e-4, 0}}, {{0, 1, 2}}}, 1);
  r.polygon = {};
  for (int side = 0; side < 3; ++side)
    for (double t : {0.0, 0.5}) {
      const auto between = [&](const auto& at) {  // a trifle outside: no side is quite straight
        const auto middle = ((1 - t) * at[side] + t * at[(side + 1) % 3]).eval();
        return (middle + 1e-5 * t * (middle - at[(side + 2) % 3])).eval();
      };
      r.polygon.uv.emplace_back(between(r.shape.chart.uv));
      r.polygon.point.emplace_back(between(r.shape.mesh.points));
    }
  RulingParams params = params_for(0.02);
  params.min_height = 4.5e-4;
  params.flat_cost = 0.1;
  const RulingSet set = r.best(params);
  expect_strip(r.polygon, set);
  for (const auto& [a, b, c] : set.triangles) {
    const Vector3 &p = r.polygon.point[a], &q = r.polygon.point[b], &s = r.polygon.point[c];
    EXPECT_GT((q - p).cross(s - p).norm(), 1e-9) << a << " " << b << " " << c;
  }
}

}  // namespace
}  // namespace sheetform
