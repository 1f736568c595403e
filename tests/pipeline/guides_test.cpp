// Seam strokes and regions to keep free, from what the user drew to the certified result.
#include <algorithm>
#include <functional>
#include <limits>

#include "pipeline/run.h"
#include "sheetform/guided.h"
#include "sheetform/mesh/keep_out.h"
#include "sheetform/sweep.h"

namespace sheetform {
namespace {

using shapes::kPi;

std::vector<Vector3> ring(int n, double radius, double z, double turn = 1) {
  std::vector<Vector3> points;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * kPi * turn * i / n;
    points.emplace_back(radius * std::cos(a), radius * std::sin(a), z);
  }
  return points;
}

UserGuides seams(std::vector<SeamStroke> strokes) { return {std::move(strokes), {}}; }

// Largest distance of a drawn line from the drawn seams of the result.
double farthest(const Decomposition& d, const std::vector<Vector3>& line, bool closed) {
  std::vector<std::array<int, 3>> segments;
  for (const StripMesh::Arch& a : d.strips.arches)
    for (std::size_t i = 0; a.drawn && i + 1 < a.vertices.size(); ++i)
      segments.push_back({a.vertices[i], a.vertices[i + 1], a.vertices[i + 1]});
  if (segments.empty()) return std::numeric_limits<double>::infinity();
  const ClosestPointTree tree(d.strips.points, segments);
  double worst = 0;
  for (std::size_t i = 0; i + (closed ? 0 : 1) < line.size(); ++i)
    for (int k = 0; k < 10; ++k)
      worst = std::max(
          worst, tree.closest(line[i] + 0.1 * k * (line[(i + 1) % line.size()] - line[i])).squared_distance);
  return std::sqrt(worst);
}

double drawn_length(const StripMesh& strips) {
  double sum = 0;
  for (const StripMesh::Arch& a : strips.arches)
    for (std::size_t i = 0; a.drawn && i + 1 < a.vertices.size(); ++i)
      sum += (strips.points[a.vertices[i + 1]] - strips.points[a.vertices[i]]).norm();
  return sum;
}

// Depth of the deepest seam in the regions.
double deepest(const TriangleSoup& soup, const Decomposition& d, const std::vector<BrushStroke>& regions) {
  const SurfaceMesh mesh = build_surface_mesh(soup.points, soup.faces);
  const KeepOut keep_out(mesh, regions, 0.01, {});
  double depth = 0;
  for (const StripMesh::Arch& a : d.strips.arches)
    for (std::size_t i = 0; a.patches[1] >= 0 && i + 1 < a.vertices.size(); ++i)
      for (double t : {0.0, 0.25, 0.5, 0.75})
        depth = std::max(depth, keep_out.depth((1 - t) * d.strips.points[a.vertices[i]] +
                                               t * d.strips.points[a.vertices[i + 1]]));
  return depth;
}

bool told(const Decomposition& d, const std::string& text) {
  return std::any_of(d.report.notes.begin(), d.report.notes.end(),
                     [&](const std::string& n) { return n.find(text) != std::string::npos; });
}

// ---- seams

TEST(SeamStrokes, TheEquatorOfASphereBecomesASeam) {
  const TriangleSoup soup = shapes::sphere(14);
  const auto equator = ring(24, 1, 0);
  const UserGuides guides = seams({{equator, true}});
  for (Effort effort : {Effort::kDraft, Effort::kNormal}) {
    DecomposeParams params = with_e_max(0.03);
    params.effort = effort;
    const Decomposition d = run(soup, params, 2, nullptr, &guides);
    expect_sound(soup, d);
    EXPECT_TRUE(d.report.e_max_met);
    EXPECT_LT(farthest(d, equator, true), 0.03 * d.bbox_diagonal + 0.01);
    EXPECT_NEAR(drawn_length(d.strips), 2 * kPi, 0.7);  // it may lie 0.1 outside
    EXPECT_TRUE(told(d, "guides"));
    EXPECT_FALSE(told(d, "as drawn is up to"));
    ASSERT_EQ(d.guides.seams.size(), 1u);
    EXPECT_EQ(d.guides.seams[0].points, equator);
  }
}

TEST(SeamStrokes, WithoutTJunctionsToo) {
  const TriangleSoup soup = shapes::sphere(14);
  const auto equator = ring(24, 1, 0.2);
  const UserGuides guides = seams({{equator, true}});
  DecomposeParams params = with_e_max(0.05);
  params.t_junctions = false;
  const Decomposition d = run(soup, params, 2, nullptr, &guides);
  expect_sound(soup, d);
  EXPECT_EQ(t_junctions(d.strips), 0);
  EXPECT_LT(farthest(d, equator, true), 0.05 * d.bbox_diagonal + 0.05);
}

TEST(SeamStrokes, TwoThatCrossAreBothThere) {
  const TriangleSoup soup = shapes::saddle(24, 0.4);
  const auto lift = [](double x, double y) { return Vector3(x, y, 0.4 * x * y); };
  std::vector<Vector3> a, b;
  for (int i = 0; i <= 10; ++i)
    a.push_back(lift(-0.7 + 0.14 * i, -0.2)), b.push_back(lift(0.1, -0.7 + 0.14 * i));
  const UserGuides guides = seams({{a, false}, {b, false}});
  const Decomposition d = run(soup, {}, 2, nullptr, &guides);
  expect_sound(soup, d);
  for (const auto& line : {a, b}) EXPECT_LT(farthest(d, line, false), 0.02 * d.bbox_diagonal + 0.03);
}

TEST(SeamStrokes, OneThatEndsOnTheBorderCutsASheetInTwo) {
  const TriangleSoup soup = shapes::cylinder_patch(24, 24);
  std::vector<Vector3> line;
  for (int i = 0; i <= 12; ++i) {
    const double a = kPi / 2 * (0.02 + 0.96 * i / 12);
    line.emplace_back(std::cos(a), std::sin(a), 0.3 + 0.3 * i / 12);
  }
  const UserGuides guides = seams({{line, false}});
  const Decomposition d = run(soup, {}, 1, nullptr, &guides);
  expect_sound(soup, d);
  EXPECT_EQ(d.strips.patches.size(), 2u);
  EXPECT_LT(farthest(d, line, false), 0.02 * d.bbox_diagonal);
  EXPECT_EQ(run(soup).strips.patches.size(), 1u);
}

TEST(SeamStrokes, OneThatEndsInsideGoesOn) {
  const TriangleSoup soup = shapes::cylinder_patch(24, 24);
  std::vector<Vector3> line;
  for (int i = 0; i <= 6; ++i) line.emplace_back(std::cos(0.5 + 0.1 * i), std::sin(0.5 + 0.1 * i), 0.5);
  const UserGuides guides = seams({{line, false}});
  const Decomposition d = run(soup, {}, 1, nullptr, &guides);
  expect_sound(soup, d);
  EXPECT_LT(farthest(d, line, false), 0.02 * d.bbox_diagonal);
  EXPECT_GE(d.strips.patches.size(), 2u);
}

TEST(SeamStrokes, EachComponentGetsItsOwn) {
  TriangleSoup soup = shapes::sphere(10);
  const int n = static_cast<int>(soup.points.size()), faces = static_cast<int>(soup.faces.size());
  for (int v = 0; v < n; ++v) soup.points.push_back(soup.points[v] + Vector3(3, 0, 0));
  for (int f = 0; f < faces; ++f) {
    const auto t = soup.faces[f];
    soup.faces.push_back({t[0] + n, t[1] + n, t[2] + n});
  }
  auto other = ring(16, 1, 0);
  for (Vector3& p : other) p.x() += 3;
  const UserGuides guides = seams({{other, true}});
  DecomposeParams params = with_e_max(0.05);
  params.effort = Effort::kDraft;
  const Decomposition d = run(soup, params, 2, nullptr, &guides);
  expect_sound(soup, d);
  EXPECT_LT(farthest(d, other, true), 0.05 * d.bbox_diagonal);
  for (const StripMesh::Arch& a : d.strips.arches)
    EXPECT_TRUE(!a.drawn || d.strips.patches[a.patches[0]].component == 1);
}

TEST(SeamStrokes, AreMirroredWithTheMesh) {
  const TriangleSoup soup = shapes::sphere(14);
  DecomposeParams params = with_e_max(0.05);
  params.symmetry = SymmetryMode::kPlane;
  params.plane = {Vector3::UnitX(), 0};
  // A circle on the negative side.
  std::vector<Vector3> circle;
  for (int i = 0; i < 20; ++i)
    circle.emplace_back(-0.8, 0.6 * std::cos(2 * kPi * i / 20), 0.6 * std::sin(2 * kPi * i / 20));
  const UserGuides guides = seams({{circle, true}});
  const Decomposition d = run(soup, params, 2, nullptr, &guides);
  expect_sound(soup, d);
  ASSERT_TRUE(d.mirror_plane);
  EXPECT_LT(farthest(d, circle, true), 0.05 * d.bbox_diagonal + 0.02);
  for (Vector3& p : circle) p.x() = -p.x();
  EXPECT_LT(farthest(d, circle, true), 0.05 * d.bbox_diagonal + 0.02);
  EXPECT_TRUE(told(d, "mirrored"));
}

TEST(SeamStrokes, AlongAndAcrossThePlaneOfSymmetryTheyStay) {
  const TriangleSoup soup = shapes::sphere(14);
  DecomposeParams params = with_e_max(0.08);
  params.symmetry = SymmetryMode::kPlane;
  params.plane = {Vector3::UnitX(), 0};
  std::vector<Vector3> meridian;
  for (int i = 0; i < 24; ++i)
    meridian.emplace_back(0, std::cos(2 * kPi * i / 24), std::sin(2 * kPi * i / 24));
  const UserGuides guides = seams({{meridian, true}, {ring(24, 1, 0), true}});
  const Decomposition d = run(soup, params, 2, nullptr, &guides);
  expect_sound(soup, d);
  ASSERT_TRUE(d.mirror_plane);
  EXPECT_LT(farthest(d, meridian, true), 0.08 * d.bbox_diagonal + 0.02);
  EXPECT_LT(farthest(d, ring(24, 1, 0), true), 0.08 * d.bbox_diagonal + 0.02);
}

TEST(SeamStrokes, ASweepFollowsThemForEveryTolerance) {
  const TriangleSoup soup = shapes::torus(40, 20);
  const auto top = ring(30, 1, 0.4);
  const UserGuides guides = seams({{top, true}});
  InputMesh input;
  input.soup = soup;
  RunContext context;
  context.threads = 2;
  DecomposeParams params;
  params.effort = Effort::kDraft;
  for (const Decomposition& d : sweep(input, params, {0.06, 0.03}, nullptr, context, &guides)) {
    expect_sound(soup, d);
    EXPECT_LT(farthest(d, top, true), d.params.e_max * d.bbox_diagonal + 0.03);
  }
}

TEST(SeamStrokes, OneTooSmallForTheMeshIsToldOf) {
  const TriangleSoup soup = shapes::plane(20);
  const UserGuides guides = seams({{{{0.5, 0.5, 0}, {0.505, 0.5, 0}}, false}});
  const Decomposition d = run(soup, {}, 1, nullptr, &guides);
  expect_sound(soup, d);
  EXPECT_TRUE(told(d, "seams[0] was left out"));
}

TEST(SeamStrokes, AnyNumberOfThreadsGivesTheSame) {
  const TriangleSoup soup = shapes::torus(40, 20);
  const UserGuides guides{{{ring(30, 1, 0.4), true}}, {{{{0, 1.4, 0}}, 0.2}}};
  DecomposeParams params = with_e_max(0.05);
  params.effort = Effort::kDraft;
  EXPECT_EQ(run(soup, params, 1, nullptr, &guides).strips.points,
            run(soup, params, 3, nullptr, &guides).strips.points);
}

// ---- regions to keep free

struct Region {
  const char* name;
  TriangleSoup soup;
  std::vector<BrushStroke> regions;
};

TEST(KeepOutRegions, NoSeamRunsThereAtAGenerousTolerance) {
  const Region cases[] = {
      {"sphere", shapes::sphere(14), {{{{1, 0, 0}}, 0.35}}},
      {"torus outside", shapes::torus(48, 24), {{{{1.4, 0, 0}}, 0.3}}},
      {"torus, a stroke", shapes::torus(48, 24), {{ring(12, 1.4, 0, 0.25), 0.15}}},
      {"tube", shapes::cylinder(48, 24), {{{{1, 0, 0.1}, {1, 0, 1.9}}, 0.3}, {{{-1, 0, 1}}, 0.4}}}};
  for (const Region& c : cases) {
    SCOPED_TRACE(c.name);
    const UserGuides guides{{}, c.regions};
    const Decomposition d = run(c.soup, with_e_max(0.05), 2, nullptr, &guides);
    expect_sound(c.soup, d);
    EXPECT_TRUE(d.report.e_max_met);
    EXPECT_LT(deepest(c.soup, d, c.regions), 0.01 * c.regions[0].radius);
    EXPECT_FALSE(told(d, "could not be kept free"));
  }
}

TEST(KeepOutRegions, WhereASeamCannotBeAvoidedThePlaceIsTold) {
  // Most of a sphere, at a tolerance that needs many parts.
  const TriangleSoup soup = shapes::sphere(12);
  const UserGuides guides{{}, {{{{0, 0, 1}}, 1.3}}};
  DecomposeParams params = with_e_max(0.02);
  params.effort = Effort::kDraft;
  const Decomposition d = run(soup, params, 2, nullptr, &guides);
  expect_sound(soup, d);
  EXPECT_TRUE(d.report.e_max_met);
  EXPECT_TRUE(told(d, "keep_out[0] could not be kept free"));
  EXPECT_LT(d.strips.patches.size(), 80u);
}

TEST(KeepOutRegions, ADrawnSeamThroughOneIsDrawnAllTheSame) {
  const TriangleSoup soup = shapes::sphere(12);
  const auto equator = ring(24, 1, 0);
  const UserGuides guides{{{equator, true}}, {{{{1, 0, 0}}, 0.3}}};
  DecomposeParams params = with_e_max(0.06);
  params.effort = Effort::kDraft;
  const Decomposition d = run(soup, params, 2, nullptr, &guides);
  expect_sound(soup, d);
  EXPECT_LT(farthest(d, equator, true), 0.06 * d.bbox_diagonal);
}

// ---- what is refused

struct Refused {
  const char* where;
  UserGuides guides;
};
void PrintTo(const Refused& r, std::ostream* out) { *out << r.where; }

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class RefusedGuides : public ::testing::TestWithParam<Refused> {};
TEST_P(RefusedGuides, AreNamed) {
  try {
    run(shapes::plane(6), {}, 1, nullptr, &GetParam().guides);
    FAIL() << "accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::kInvalidParameter);
    EXPECT_EQ(e.where(), GetParam().where);
    EXPECT_FALSE(e.summary().empty());
    EXPECT_FALSE(e.fix().empty());
  }
}
const std::vector<Vector3> kGood{{0.1, 0.1, 0}, {0.9, 0.1, 0}};
INSTANTIATE_TEST_SUITE_P(
    All, RefusedGuides,
    ::testing::Values(Refused{"guides, seams[0]", {{{{}, false}}, {}}},
                      Refused{"guides, seams[0]", {{{{{0, 0, 0}}, false}}, {}}},
                      Refused{"guides, seams[1]", {{{kGood, false}, {kGood, true}}, {}}},
                      Refused{"guides, seams[1], point 1",
                              {{{kGood, false}, {{{0, 0, 0}, {0, 0, 0.08}}, false}}, {}}},
                      Refused{"guides, seams[0], point 0", {{{{{kNaN, 0, 0}, {1, 0, 0}}, false}}, {}}},
                      Refused{"guides, keep_out[0]", {{}, {{{}, 0.1}}}},
                      Refused{"guides, keep_out[0]", {{}, {{kGood, 0}}}},
                      Refused{"guides, keep_out[0]", {{}, {{kGood, -1}}}},
                      Refused{"guides, keep_out[0]", {{}, {{kGood, kNaN}}}},
                      Refused{"guides, keep_out[1], point 0", {{}, {{kGood, 0.1}, {{{0, 0, 9}}, 0.1}}}}));

TEST(RefusedGuides, EndlessScribbleIsRefused) {
  SeamStroke scribble;
  for (int i = 0; i < 400; ++i) scribble.points.emplace_back(i % 2, 0.5, 0);
  EXPECT_THROW(check_guides({{scribble}, {}}, shapes::plane(6)), Error);
  scribble.points.resize(100);
  EXPECT_NO_THROW(check_guides({{scribble}, {}}, shapes::plane(6)));
}

}  // namespace
}  // namespace sheetform
