#include "sheetform/morph/full_remesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "sheetform/base/error.h"
#include "unit/morph/ruled_scene.h"

namespace sheetform {
namespace {

double area(const RuledMesh& mesh, const std::array<int, 3>& t) {
  return (mesh.rest[t[1]] - mesh.rest[t[0]]).cross(mesh.rest[t[2]] - mesh.rest[t[0]]).norm() / 2;
}

std::map<std::pair<int, int>, int> edge_uses(const RuledMesh& mesh) {
  std::map<std::pair<int, int>, int> uses;
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) ++uses[std::minmax(t[k], t[(k + 1) % 3])];
  return uses;
}

TEST(TriangulateConvex, KeepsStraightCornersAndMakesNoFlatTriangle) {
  // A triangle with two points on one side and one on another.
  const std::vector<Vector2> uv{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {1.5, 1}, {0, 2}};
  std::vector<std::array<int, 3>> triangles;
  triangulate_convex({0, 1, 2, 3, 4, 5}, uv, triangles);
  ASSERT_EQ(triangles.size(), 4u);
  double sum = 0;
  for (const auto& t : triangles) {
    const double twice = cross(uv[t[1]] - uv[t[0]], uv[t[2]] - uv[t[0]]);
    EXPECT_GT(twice, 0.1);
    sum += twice / 2;
  }
  EXPECT_NEAR(sum, 3, 1e-12);
}

TEST(RuledMesh, CoversTheSurfaceWithDisks) {
  for (const RuledScene* s : {&torus_sections(), &saddle_parts()}) {
    const RuledMesh& mesh = s->problem.mesh;
    double covered = 0;
    for (const auto& t : mesh.triangles) {
      covered += area(mesh, t);
      EXPECT_GT(cross(mesh.uv[t[1]] - mesh.uv[t[0]], mesh.uv[t[2]] - mesh.uv[t[0]]), 0);
      for (int v : t) EXPECT_EQ(mesh.patch[v], mesh.patch[t[0]]);
    }
    EXPECT_NEAR(covered, surface_area(s->surface.mesh), 1e-12);
    const auto edges = edge_uses(mesh);
    for (const auto& [edge, uses] : edges) EXPECT_LE(uses, 2);
    const long long euler =
        mesh.size() - static_cast<long long>(edges.size()) + static_cast<long long>(mesh.triangles.size());
    EXPECT_EQ(euler, static_cast<long long>(s->patches.size()));
  }
}

TEST(RuledMesh, RulingsAreChainsOfEdgesOnTheirChords) {
  for (const RuledScene* s : {&torus_sections(), &saddle_parts()}) {
    const RuledMesh& mesh = s->problem.mesh;
    const auto edges = edge_uses(mesh);
    const double edge = mean_edge_length(s->surface.mesh);
    std::size_t chords = 0;
    for (const auto& p : s->patches) chords += p->rulings.chords.size();
    EXPECT_LT(s->problem.dropped, 0.005 * static_cast<double>(chords));
    ASSERT_EQ(mesh.rulings.size() + s->problem.dropped, chords);
    for (const auto& r : mesh.rulings) {
      EXPECT_TRUE(mesh.on_border[r.vertices.front()] && mesh.on_border[r.vertices.back()]);
      const Vector2 from = mesh.uv[r.vertices.front()], d = (mesh.uv[r.vertices.back()] - from).normalized();
      for (std::size_t k = 0; k < r.vertices.size(); ++k) {
        EXPECT_TRUE(mesh.on_ruling[r.vertices[k]]);
        EXPECT_LT(std::abs(cross(d, mesh.uv[r.vertices[k]] - from)), 2e-3 * edge);
        if (k == 0) continue;
        EXPECT_GT(r.at[k], r.at[k - 1]);
        EXPECT_TRUE(edges.count(std::minmax(r.vertices[k - 1], r.vertices[k])));
      }
    }
  }
}

// Brute force over all edges of the chart: each crossing has its vertex, each vertex is a crossing.
TEST(RuledMesh, EveryCrossedEdgeIsSplit) {
  const RuledScene& s = saddle_parts();
  const RuledMesh& mesh = s.problem.mesh;
  const double edge = mean_edge_length(s.surface.mesh);
  for (const auto& r : mesh.rulings) {
    const PatchChart& chart = *s.patches[r.patch]->chart;
    const Vector2 p = mesh.uv[r.vertices.front()], d = mesh.uv[r.vertices.back()] - p;
    std::vector<double> crossings;
    for (const auto& t : chart.triangles)
      for (int k = 0; k < 3; ++k) {
        const Vector2 a = chart.uv[t[k]], b = chart.uv[t[(k + 1) % 3]];
        const double sa = cross(d, a - p), sb = cross(d, b - p);
        if ((sa < 0) == (sb < 0)) continue;
        const double at = ((a + (b - a) * sa / (sa - sb)) - p).dot(d) / d.squaredNorm();
        if (at > 1e-6 && at < 1 - 1e-6) crossings.push_back(at);
      }
    const double near = 5e-2 * edge / d.norm();  // crossings at flat angles move further along the ruling
    for (double c : crossings)
      EXPECT_TRUE(std::any_of(r.at.begin(), r.at.end(), [&](double at) { return std::abs(at - c) < near; }))
          << c;
    for (std::size_t k = 1; k + 1 < r.at.size(); ++k)
      EXPECT_TRUE(std::any_of(crossings.begin(), crossings.end(),
                              [&](double c) { return std::abs(r.at[k] - c) < near; }));
  }
}

TEST(RuledMesh, CopiesOfASeamMatch) {
  const RuledScene& s = torus_sections();
  EXPECT_EQ(s.problem.mesh.sides.size(), 2 * s.layout.arches.size());
  for (const auto& [a, b] : s.problem.seams) {
    EXPECT_LT(a, b);
    EXPECT_LT((s.problem.mesh.rest[a] - s.problem.mesh.rest[b]).norm(), 1e-12);
    EXPECT_TRUE(s.problem.mesh.on_border[a] && s.problem.mesh.on_border[b]);
  }
}

TEST(RuledMesh, APatchCanBeGluedToItself) {
  const RuledScene s(shapes::cylinder(30, 12, 1, 1), {{30, 12, true, false}, {0}, {}});
  ASSERT_EQ(s.patches.size(), 1u);
  EXPECT_GE(s.problem.seams.size(), 13u);
  const FullMorphResult result = full_morph(s.problem, {}, RunContext{});
  EXPECT_LT(result.gap, 1e-3);
  EXPECT_LT(largest(result.patch_displacement), 0.02);
}

// Three unit squares in the shape of an L, each cut from lower left to upper right; vertex (x, y) is 3 y + x.
PatchChart l_shape() {
  PatchChart chart;
  for (int i = 0; i < 8; ++i) chart.uv.emplace_back(i % 3, i / 3);
  chart.triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}, {3, 4, 7}, {3, 7, 6}};
  return chart;
}

TEST(CutChart, ALineHasAPointOnEveryEdgeThatItCrosses) {
  const PatchChart chart = l_shape();
  CutChart cut(chart);
  const int from = cut.add_on_edge(0, 3, 0.25), to = cut.add_on_edge(5, 2, 0.75);
  const std::vector<int> line = cut.add_line(from, to);
  ASSERT_EQ(line.size(), 5u);
  const std::vector<Vector2> expected{{0, 0.25}, {0.25, 0.25}, {1, 0.25}, {1.25, 0.25}, {2, 0.25}};
  for (int k = 0; k < 5; ++k) EXPECT_LT((cut.uv(line[k]) - expected[k]).norm(), 1e-12);
  EXPECT_EQ(cut.pieces_of(0).size(), 1u);
  EXPECT_TRUE(cut.pieces_of(4).empty());
  EXPECT_EQ(cut.outline_of(0).size(), 5u);
}

TEST(CutChart, ALineMayTouchTheOutlineButNotLeaveIt) {
  const PatchChart chart = l_shape();
  CutChart cut(chart);
  EXPECT_TRUE(cut.add_line(5, 7).empty());
  EXPECT_TRUE(cut.add_line(cut.add_on_edge(2, 5, 0.5), cut.add_on_edge(6, 7, 0.5)).empty());
  const std::vector<int> touching = cut.add_line(2, 6);
  ASSERT_EQ(touching.size(), 5u);
  EXPECT_EQ(touching[2], 4);
}

TEST(CutChart, LinesThatCrossAnEarlierOneAreRefused) {
  const PatchChart chart = l_shape();
  CutChart cut(chart);
  ASSERT_FALSE(cut.add_line(cut.add_on_edge(0, 1, 0.3), cut.add_on_edge(6, 7, 0.4)).empty());
  const int left = cut.add_on_edge(0, 3, 0.4), right = cut.add_on_edge(1, 4, 0.5), before = cut.point_count();
  EXPECT_TRUE(cut.add_line(left, right).empty());
  EXPECT_EQ(cut.point_count(), before);
}

TEST(CutChart, CrossingsNearAVertexAreMovedToIt) {
  const PatchChart chart = l_shape();
  CutChart cut(chart);
  const std::vector<int> line = cut.add_line(cut.add_on_edge(6, 7, 0.5002), cut.add_on_edge(1, 2, 0.5));
  ASSERT_EQ(line.size(), 5u);
  EXPECT_EQ(line[2], 4);
  // A vertex beside the end of a line is not on it.
  CutChart fresh(chart);
  EXPECT_EQ(fresh.add_line(fresh.add_on_edge(0, 1, 0.9996), fresh.add_on_edge(6, 7, 0.9996)).size(), 4u);
}

TEST(CutChart, ALineAlongAnEdgeTakesThePointsOnIt) {
  const PatchChart chart = l_shape();
  CutChart cut(chart);
  const std::vector<int> line = cut.add_line(0, 5);
  const std::vector<int> along = cut.add_line(3, 4);
  ASSERT_EQ(along, (std::vector<int>{3, 4}));
  const int middle = cut.add_on_edge(3, 4, 0.5);
  EXPECT_EQ(cut.with_points_between(along), (std::vector<int>{3, middle, 4}));
  EXPECT_EQ(cut.with_points_between(line), line);
}

TEST(CutChart, AnEdgeThatIsNotThereIsAnError) {
  const PatchChart chart = l_shape();
  CutChart cut(chart);
  EXPECT_THROW(cut.add_on_edge(0, 5, 0.5), Error);
}

TEST(RuledMesh, DroppedLinesAreCounted) {
  const RuledScene& s = flat_parts();
  auto ruled = s.ruled_patches();
  const auto& boundary = s.layout.patches[0].boundary;
  const auto n0 = static_cast<double>(s.layout.arches[boundary[0].arch].edges.size());
  const auto n2 = static_cast<double>(s.layout.arches[boundary[2].arch].edges.size());
  const auto across = [&](double t0, double t2) {
    const double a = boundary[0].forward ? t0 : 1 - t0, b = boundary[2].forward ? 1 - t2 : t2;
    return RulingLine{{0, a * n0}, {2, b * n2}};
  };
  ruled[0].lines = {across(0.31, 0.32), across(0.23, 0.61), across(0.72, 0.74)};
  const RunContext context;
  const auto problem = full_morph_problem(s.surface.mesh, s.layout, ruled, s.arch_samples, nullptr, context);
  EXPECT_EQ(problem.dropped, 1);
  EXPECT_EQ(problem.mesh.rulings[1].patch, 0);
  EXPECT_EQ(problem.mesh.rulings[2].patch, 1);
}

TEST(RuledMesh, DoesNotDependOnTheNumberOfThreads) {
  const RuledScene& s = torus_sections();
  RunContext three;
  three.threads = 3;
  const auto other =
      full_morph_problem(s.surface.mesh, s.layout, s.ruled_patches(), s.arch_samples, &s.curvature, three);
  EXPECT_EQ(other.mesh.rest, s.problem.mesh.rest);
  EXPECT_EQ(other.mesh.triangles, s.problem.mesh.triangles);
  EXPECT_EQ(other.seams, s.problem.seams);
  EXPECT_EQ(full_morph(other, {}, three).position, full_morph(s.problem, {}, RunContext{}).position);
}

TEST(RuledMesh, PartsThatDoNotFitTogetherAreRefused) {
  const RuledScene& s = flat_parts();
  const RunContext context;
  const auto build = [&](const std::vector<RuledPatch>& ruled,
                         const std::vector<std::vector<double>>& samples) {
    return full_morph_problem(s.surface.mesh, s.layout, ruled, samples, nullptr, context);
  };
  const auto ruled = s.ruled_patches();
  auto samples = s.arch_samples;
  samples.pop_back();
  EXPECT_THROW(build(ruled, samples), Error);
  samples = s.arch_samples;
  samples[0].back() += 1;
  EXPECT_THROW(build(ruled, samples), Error);
  EXPECT_THROW(build({ruled[0]}, s.arch_samples), Error);
  auto swapped = ruled;
  std::swap(swapped[0].chart, swapped[5].chart);
  EXPECT_THROW(build(swapped, s.arch_samples), Error);
  auto beyond = ruled;
  beyond[1].lines[0].to.use = 4;
  EXPECT_THROW(build(beyond, s.arch_samples), Error);
  beyond = ruled;
  beyond[1].lines[0].to.at = -0.5;
  EXPECT_THROW(build(beyond, s.arch_samples), Error);
}

}  // namespace
}  // namespace sheetform
