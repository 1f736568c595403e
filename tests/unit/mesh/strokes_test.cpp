// Strokes of the user on the mesh: projected, cut into it, tubes around them.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "sheetform/mesh/creases.h"
#include "sheetform/mesh/embed_strokes.h"
#include "sheetform/mesh/keep_out.h"
#include "sheetform/mesh/surface_curve.h"
#include "support/shapes.h"

namespace sheetform {
namespace {

using shapes::kPi;

SurfaceMesh build(TriangleSoup s) { return build_surface_mesh(std::move(s.points), std::move(s.faces)); }
ClosestPointTree tree_of(const SurfaceMesh& m) { return {m.points, m.faces}; }
PreparedMesh prepared(TriangleSoup s) {
  PreparedMesh p{build(std::move(s)), {}, false};
  p.crease_edge.assign(p.mesh.edges.size(), 0);
  return p;
}

std::vector<Vector3> ring(int n, double radius, double z) {
  std::vector<Vector3> points;
  for (int i = 0; i < n; ++i)
    points.emplace_back(radius * std::cos(2 * kPi * i / n), radius * std::sin(2 * kPi * i / n), z);
  return points;
}

// ---- curves on the surface

TEST(SurfaceCurve, FollowsAGreatCircleBetweenSparsePoints) {
  const SurfaceMesh mesh = build(shapes::sphere(24));
  const auto curve = curve_on_surface(tree_of(mesh), ring(6, 1, 0), true, 0.02);
  for (std::size_t i = 0; i < curve.size(); ++i) {
    EXPECT_NEAR(curve[i].point.norm(), 1, 0.005);
    EXPECT_NEAR(curve[i].point.z(), 0, 0.005);
    const std::size_t before = i > 0 ? i - 1 : 0;
    EXPECT_LE((curve[i].point - curve[before].point).norm(), 0.02 + 1e-12);
  }
  EXPECT_EQ(curve.front().point, curve.back().point);
}

TEST(SurfaceCurve, PointsOffTheSurfaceAreProjected) {
  const SurfaceMesh mesh = build(shapes::plane(10));
  const auto curve = curve_on_surface(tree_of(mesh), {{0.2, 0.2, 0.1}, {0.8, 0.5, -0.1}}, false, 0.05);
  for (const CurvePoint& p : curve) EXPECT_EQ(p.point.z(), 0);
  EXPECT_EQ(curve.front().point, Vector3(0.2, 0.2, 0));
  EXPECT_EQ(curve.back().point, Vector3(0.8, 0.5, 0));
}

// ---- chains of edges

struct Drawn {
  EmbeddedStrokes embedded;
  const SurfaceMesh& mesh() const { return embedded.prepared.mesh; }
  double length() const {
    double sum = 0;
    for (int e = 0; e < mesh().edge_count(); ++e)
      if (embedded.drawn_edge[e]) sum += mesh().edge_length(e);
    return sum;
  }
  // Number of vertices with this many drawn edges.
  int of_degree(int wanted) const {
    std::vector<int> degree(mesh().points.size(), 0);
    for (int e = 0; e < mesh().edge_count(); ++e)
      if (embedded.drawn_edge[e]) ++degree[mesh().edges[e].v0], ++degree[mesh().edges[e].v1];
    return static_cast<int>(std::count(degree.begin(), degree.end(), wanted));
  }
  template <class F>
  double farthest(const F& off) const {
    double worst = 0;
    for (int e = 0; e < mesh().edge_count(); ++e)
      if (embedded.drawn_edge[e])
        for (int v : {mesh().edges[e].v0, mesh().edges[e].v1}) worst = std::max(worst, off(mesh().points[v]));
    return worst;
  }
};

Drawn draw(const PreparedMesh& mesh, const std::vector<SeamStroke>& strokes) {
  Drawn d{embed_strokes(mesh, strokes, {})};
  EXPECT_TRUE(d.embedded.prepared.remeshed);
  EXPECT_EQ(d.embedded.drawn_edge.size(), d.mesh().edges.size());
  EXPECT_TRUE(uniform_enough(d.mesh()));
  return d;
}

TEST(EmbedStrokes, AStraightLineAcrossAPlaneEndsOnBothBorders) {
  const PreparedMesh plane = prepared(shapes::plane(24));
  const Drawn d = draw(plane, {{{{-0.01, 0.31, 0}, {0.99, 0.62, 0}}, false}});
  EXPECT_TRUE(d.embedded.left_out.empty());
  EXPECT_EQ(d.of_degree(1), 2);
  EXPECT_EQ(d.of_degree(3) + d.of_degree(4), 0);
  for (int e = 0; e < d.mesh().edge_count(); ++e) EXPECT_FALSE(d.embedded.prepared.crease_edge[e]);
  const Vector3 direction = Vector3(1, 0.31, 0).normalized();
  const double edge = mean_edge_length(plane.mesh);
  EXPECT_LT(
      d.farthest([&](const Vector3& p) { return (p - Vector3(-0.01, 0.31, 0)).cross(direction).norm(); }),
      0.6 * edge);  // at the borders it goes to the nearest vertex
  EXPECT_NEAR(d.length(), std::hypot(1, 0.31), 2 * edge);
  int ends = 0;
  for (int e = 0; e < d.mesh().edge_count(); ++e)
    if (d.embedded.drawn_edge[e])
      ends += d.mesh().border_vertex[d.mesh().edges[e].v0] + d.mesh().border_vertex[d.mesh().edges[e].v1];
  EXPECT_EQ(ends, 2);
}

TEST(EmbedStrokes, TheEquatorIsOneClosedChainWhereItWasDrawn) {
  const Drawn d = draw(prepared(shapes::sphere(20)), {{ring(40, 1, 0), true}});
  EXPECT_EQ(d.of_degree(1) + d.of_degree(3) + d.of_degree(4), 0);
  EXPECT_GT(d.of_degree(2), 30);
  EXPECT_NEAR(d.length(), 2 * kPi, 0.05);
  EXPECT_LT(d.farthest([](const Vector3& p) { return std::abs(p.z()); }), 0.01);
}

TEST(EmbedStrokes, AnOpenStrokeThatMeetsItselfIsClosed) {
  std::vector<Vector3> points = ring(40, 1, 0);
  points.push_back(points.front() + Vector3(0, 0.01, 0.01));
  EXPECT_EQ(draw(prepared(shapes::sphere(20)), {{points, false}}).of_degree(1), 0);
}

TEST(EmbedStrokes, TwoStrokesCrossInOneVertex) {
  const Drawn d = draw(prepared(shapes::plane(24)),
                       {{{{0.2, 0.2, 0}, {0.8, 0.8, 0}}, false}, {{{0.2, 0.75, 0}, {0.8, 0.25, 0}}, false}});
  EXPECT_EQ(d.of_degree(4), 1);
  EXPECT_EQ(d.of_degree(1), 4);
  EXPECT_EQ(d.of_degree(3), 0);
}

TEST(EmbedStrokes, AFigureOfEightCrossesItselfOnce) {
  std::vector<Vector3> eight;
  for (int i = 0; i < 60; ++i) {
    const double t = 2 * kPi * (i + 7.5) / 60;
    eight.emplace_back(0.5 + 0.35 * std::sin(t), 0.5 + 0.3 * std::sin(2 * t), 0);
  }
  const Drawn d = draw(prepared(shapes::plane(30)), {{eight, true}});
  EXPECT_EQ(d.of_degree(4), 1);
  EXPECT_EQ(d.of_degree(1) + d.of_degree(3), 0);
}

TEST(EmbedStrokes, EndsMeetWhatIsNear) {
  // A wall down the middle; strokes that stop short of it, or go a little too far.
  const double edge = mean_edge_length(build(shapes::plane(24)));
  const SeamStroke wall{{{0.5, -0.01, 0}, {0.5, 1.01, 0}}, false};
  for (double tip : {0.5 - edge, 0.5 + edge}) {
    const Drawn d = draw(prepared(shapes::plane(24)), {wall, {{{0.1, 0.4, 0}, {tip, 0.47, 0}}, false}});
    EXPECT_EQ(d.of_degree(3), 1) << tip;
    EXPECT_EQ(d.of_degree(1), 3) << tip;  // both ends of the wall, and the far end of the stroke
  }
}

TEST(EmbedStrokes, TheSameStrokeTwiceIsOne) {
  const SeamStroke line{{{0.2, 0.3, 0}, {0.8, 0.5, 0}}, false};
  SeamStroke again = line;
  for (Vector3& p : again.points) p.y() += 0.005;
  const Drawn once = draw(prepared(shapes::plane(24)), {line}),
              twice = draw(prepared(shapes::plane(24)), {line, again});
  EXPECT_TRUE(twice.embedded.left_out.empty());
  EXPECT_NEAR(once.length(), twice.length(), 0.06);
}

TEST(EmbedStrokes, TrembledLinesAreSimple) {
  std::vector<Vector3> points;
  for (int i = 0; i <= 400; ++i)
    points.emplace_back(0.15 + 0.7 * i / 400, 0.5 + 0.006 * std::sin(i * 2.1), 0.004 * std::cos(i * 1.3));
  const Drawn d = draw(prepared(shapes::plane(24)), {{points, false}});
  EXPECT_EQ(d.of_degree(1), 2);
  EXPECT_EQ(d.of_degree(3) + d.of_degree(4), 0);
  EXPECT_NEAR(d.length(), 0.7, 0.08);
}

TEST(EmbedStrokes, ScribbleIsFollowedWhateverItCrosses) {
  const TriangleSoup soups[] = {shapes::sphere(18), shapes::torus(48, 24), shapes::cylinder(48, 24),
                                shapes::saddle(30, 0.8)};
  for (int seed = 0; seed < 24; ++seed) {
    std::mt19937 random(seed);
    const auto unit = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
    const PreparedMesh mesh = prepared(soups[seed % 4]);
    const ClosestPointTree tree = tree_of(mesh.mesh);
    const double edge = mean_edge_length(mesh.mesh);
    std::vector<SeamStroke> strokes(1 + seed % 3);
    for (SeamStroke& s : strokes) {
      Vector3 at = mesh.mesh.points[random() % mesh.mesh.points.size()], way(unit(), unit(), unit());
      for (int i = 0; i < 40; ++i) {
        s.points.push_back(at);
        way = (way + 0.4 * Vector3(unit(), unit(), unit())).normalized();
        at = tree.closest(at + 1.2 * edge * way).point;
      }
    }
    const Drawn d = draw(mesh, strokes);
    std::vector<std::array<int, 3>> lines;
    for (int e = 0; e < d.mesh().edge_count(); ++e)
      if (d.embedded.drawn_edge[e] || d.mesh().edges[e].border())
        lines.push_back({d.mesh().edges[e].v0, d.mesh().edges[e].v1, d.mesh().edges[e].v1});
    const ClosestPointTree near(d.mesh().points, lines);
    for (const SeamStroke& s : strokes)
      for (const CurvePoint& p : curve_on_surface(tree, s.points, false, edge / 4))
        ASSERT_LT(std::sqrt(near.closest(p.point).squared_distance), 2.2 * edge) << seed;
  }
}

TEST(EmbedStrokes, CreasesStayCreases) {
  const SurfaceMesh box = build(shapes::box(12, {1, 1, 1}));
  const PreparedMesh given{box, detect_creases(box, 40), false};
  const Drawn d = draw(given, {{{{-0.6, -0.1, 0.5}, {0.6, 0.15, 0.5}}, false}});
  double creases = 0;
  for (int e = 0; e < d.mesh().edge_count(); ++e)
    if (d.embedded.prepared.crease_edge[e]) creases += d.mesh().edge_length(e);
  EXPECT_NEAR(creases, 12, 0.02);
  EXPECT_NEAR(d.length(), std::hypot(1, 0.2083), 0.1);
}

TEST(EmbedStrokes, TooSmallIsLeftOut) {
  const Drawn d = draw(prepared(shapes::plane(24)),
                       {{{{0.5, 0.5, 0}, {0.52, 0.5, 0}}, false}, {{{0.2, 0.5, 0}, {0.7, 0.5, 0}}, false}});
  EXPECT_EQ(d.embedded.left_out, std::vector<int>{0});
  EXPECT_GT(d.length(), 0.4);
}

TEST(EmbedStrokes, TheSameBytesAgain) {
  const PreparedMesh mesh = prepared(shapes::torus(40, 20));
  const std::vector<SeamStroke> strokes{{ring(20, 1.4, 0), true}, {ring(20, 1, 0.4), true}};
  const EmbeddedStrokes a = embed_strokes(mesh, strokes, {}), b = embed_strokes(mesh, strokes, {});
  EXPECT_EQ(a.prepared.mesh.points, b.prepared.mesh.points);
  EXPECT_EQ(a.drawn_edge, b.drawn_edge);
}

// ---- regions

TEST(KeepOut, DepthIsMeasuredFromTheRimOfTheTube) {
  const SurfaceMesh plane = build(shapes::plane(30));
  const KeepOut regions(plane, {{{{0.3, 0.5, 0}, {0.7, 0.5, 0}}, 0.1}, {{{0.5, 0.9, 0}}, 0.05}}, 0.02, {});
  int brush = -1;
  EXPECT_NEAR(regions.depth({0.5, 0.5, 0}, 0, &brush), 0.1, 1e-9);
  EXPECT_EQ(brush, 0);
  EXPECT_NEAR(regions.depth({0.5, 0.57, 0}), 0.03, 1e-9);
  EXPECT_EQ(regions.depth({0.5, 0.61, 0}), 0);
  EXPECT_NEAR(regions.depth({0.5, 0.61, 0}, 0.02), 0.01, 1e-9);
  EXPECT_NEAR(regions.depth({0.5, 0.92, 0}, 0, &brush), 0.03, 1e-9);
  EXPECT_EQ(brush, 1);
  EXPECT_NEAR(regions.pushed_out({0.5, 0.53, 0}, 0.01).y(), 0.61, 1e-9);
  EXPECT_EQ(regions.pushed_out({0.1, 0.1, 0}, 0.01), Vector3(0.1, 0.1, 0));
}

TEST(KeepOut, TheOtherSideOfAThinWallStaysFree) {
  const SurfaceMesh slab = build(shapes::box(20, {1, 1, 0.05}));
  const KeepOut regions(slab, {{{{0, 0, 0.025}}, 0.2}}, 0.02, {});
  EXPECT_GT(regions.depth({0.05, 0.05, 0.025}), 0.1);
  EXPECT_EQ(regions.depth({0.05, 0.05, -0.025}), 0);
}

TEST(KeepOut, EdgesInside) {
  const SurfaceMesh plane = build(shapes::plane(30));
  const KeepOut regions(plane, {{{{0.5, 0.5, 0}}, 0.2}}, 0.02, {});
  const std::vector<char> inside = edges_inside(plane, regions, 0);
  double length = 0;
  for (int e = 0; e < plane.edge_count(); ++e) {
    const Vector3 a = plane.points[plane.edges[e].v0] - Vector3(0.5, 0.5, 0),
                  b = plane.points[plane.edges[e].v1] - Vector3(0.5, 0.5, 0);
    EXPECT_TRUE(inside[e] || (a.norm() > 0.199 && b.norm() > 0.199));
    EXPECT_TRUE(!inside[e] || a.norm() < 0.26 || b.norm() < 0.26);
    length += inside[e];
  }
  EXPECT_GT(length, 0);
  EXPECT_TRUE(edges_inside(plane, {}, 0.1).empty());
}

}  // namespace
}  // namespace sheetform
