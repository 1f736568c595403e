#include <gtest/gtest.h>

#include <algorithm>
#include <queue>
#include <set>

#include "sheetform/tracing/path_search.h"
#include "unit/tracing/traced_shape.h"

namespace sheetform {
namespace {

std::set<int> sheet_nodes(const Path& p) {
  std::set<int> out;
  for (std::size_t i = 0; i < p.vertices.size(); ++i) out.insert(2 * p.vertices[i] + (p.dirs[i] & 1));
  return out;
}

void expect_simple_chain(const SurfaceMesh& mesh, const Path& p) {
  const std::size_t n = p.vertices.size();
  ASSERT_EQ(p.dirs.size(), n);
  EXPECT_EQ(std::set<int>(p.vertices.begin(), p.vertices.end()).size(), n);
  double length = 0;
  for (std::size_t i = 0; i + (p.loop ? 0 : 1) < n; ++i) {
    const int e = mesh.find_edge(p.vertices[i], p.vertices[(i + 1) % n]);
    ASSERT_GE(e, 0);
    EXPECT_FALSE(mesh.edges[e].border());
    length += mesh.edge_length(e);
  }
  EXPECT_NEAR(p.length, length, 1e-9);
}

// Spread of an angle (radians) over a path, as the largest distance from its first value.
template <typename Angle>
double spread(const Path& p, const Angle& angle) {
  double worst = 0;
  for (int v : p.vertices)
    worst = std::max(worst, std::abs(std::remainder(angle(v) - angle(p.vertices[0]), 2 * shapes::kPi)));
  return worst;
}

TEST(TraceCandidates, LoopsOnATorusAreItsCircles) {
  const TracedShape s(shapes::torus(64, 32, 1, 0.4));
  const std::vector<Path> paths = s.candidates();
  const auto around_axis = [&](int v) { return std::atan2(s.mesh.points[v].y(), s.mesh.points[v].x()); };
  const auto around_tube = [&](int v) {
    return std::atan2(s.mesh.points[v].z(), std::hypot(s.mesh.points[v].x(), s.mesh.points[v].y()) - 1);
  };
  int meridians = 0, parallels = 0;
  for (const Path& p : paths) {
    EXPECT_TRUE(p.loop);
    expect_simple_chain(s.mesh, p);
    if (turns_around_axis(s.mesh, p) == 0) {
      ++meridians;
      EXPECT_LT(spread(p, around_axis), 1.5 * 2 * shapes::kPi / 64);
      EXPECT_NEAR(p.length, 2 * shapes::kPi * 0.4, 0.1 * 2 * shapes::kPi * 0.4);
    } else {
      ++parallels;
      EXPECT_EQ(std::abs(turns_around_axis(s.mesh, p)), 1);
      EXPECT_LT(spread(p, around_tube), 1.5 * 2 * shapes::kPi / 32);
    }
  }
  EXPECT_GT(meridians, 20);
  EXPECT_GT(parallels, 10);
}

TEST(TraceCandidates, CylinderHasRulingsFromBorderToBorderAndRoundLoops) {
  const TracedShape s(shapes::cylinder(48, 16, 1, 2));
  int rulings = 0, loops = 0;
  for (const Path& p : s.candidates()) {
    expect_simple_chain(s.mesh, p);
    if (p.loop) {
      ++loops;
      const double z = s.mesh.points[p.vertices[0]].z();
      for (int v : p.vertices) EXPECT_NEAR(s.mesh.points[v].z(), z, 1e-9);
      continue;
    }
    ++rulings;
    const Vector3 &a = s.mesh.points[p.vertices.front()], &b = s.mesh.points[p.vertices.back()];
    EXPECT_NEAR(std::abs(a.z() - b.z()), 2, 1e-9);
    EXPECT_NEAR(p.length, 2, 1e-9);
    EXPECT_NEAR(p.drift, 0, 1e-4);
  }
  EXPECT_EQ(rulings, 48);
  EXPECT_GE(loops, 13);
}

TEST(TraceCandidates, InteriorSeedsAloneFindBorderPathsToo) {
  const TracedShape s(shapes::cylinder(48, 16, 1, 2));
  TraceParams params;
  params.border_seeds = 0;
  int rulings = 0;
  for (const Path& p : s.candidates(params)) {
    if (p.loop) continue;
    ++rulings;
    EXPECT_NEAR(p.length, 2, 1e-9);
  }
  EXPECT_GT(rulings, 20);
}

TEST(TraceCandidates, PathsEndOnCreasesAndNeverPassThem) {
  const TracedShape s(shapes::closed_cylinder(48, 16, 1, 2), 40);
  int wall = 0, cap = 0;
  for (const Path& p : s.candidates()) {
    expect_simple_chain(s.mesh, p);
    for (std::size_t i = 0; i < p.vertices.size(); ++i) {
      const bool end = !p.loop && (i == 0 || i + 1 == p.vertices.size());
      EXPECT_EQ(s.graph.terminal[p.vertices[i]] != 0, end);
    }
    if (p.loop) continue;
    const double rise =
        std::abs(s.mesh.points[p.vertices.front()].z() - s.mesh.points[p.vertices.back()].z());
    (rise > 1 ? wall : cap) += 1;
    EXPECT_NEAR(rise, rise > 1 ? 2 : 0, 1e-9);
  }
  EXPECT_GT(wall, 20);
  EXPECT_GT(cap, 5);
}

TEST(TraceCandidates, FindsLoopsFromMostSeedsOnASphere) {
  const TracedShape s(shapes::sphere(16));
  TraceParams params;
  params.seeds = 60;
  const std::vector<Path> paths = s.candidates(params);
  EXPECT_GT(paths.size(), 20u);
  for (const Path& p : paths) {
    EXPECT_TRUE(p.loop);
    expect_simple_chain(s.mesh, p);
    EXPECT_LT(p.drift, 0.12);
  }
}

TEST(TraceCandidates, HoldsNoDuplicates) {
  const TracedShape s(shapes::sphere(14));
  std::vector<std::set<int>> nodes;
  for (const Path& p : s.candidates()) nodes.push_back(sheet_nodes(p));
  ASSERT_GT(nodes.size(), 10u);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      std::vector<int> shared;
      std::set_intersection(nodes[i].begin(), nodes[i].end(), nodes[j].begin(), nodes[j].end(),
                            std::back_inserter(shared));
      EXPECT_LE(static_cast<double>(shared.size()),
                0.8 * static_cast<double>(std::max(nodes[i].size(), nodes[j].size())));
    }
}

TEST(TraceCandidates, DoesNotDependOnTheNumberOfThreads) {
  const TracedShape s(shapes::closed_cylinder(36, 12), 40);
  const std::vector<Path> one = s.candidates({}, 1), three = s.candidates({}, 3);
  ASSERT_EQ(one.size(), three.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].vertices, three[i].vertices);
    EXPECT_EQ(one[i].dirs, three[i].dirs);
  }
}

TEST(TraceCandidates, TinyMeshesGiveNothing) {
  TriangleSoup triangle, tetrahedron;
  triangle.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  triangle.faces = {{0, 1, 2}};
  tetrahedron.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tetrahedron.faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  EXPECT_TRUE(TracedShape(triangle).candidates().empty());
  EXPECT_TRUE(TracedShape(tetrahedron, 40).candidates().empty());  // every edge is a crease
}

TEST(TraceCandidates, GivesUpBeyondTheCost) {
  const TracedShape s(shapes::torus(40, 20));
  TraceParams params;
  params.max_cost = 0.01;
  EXPECT_TRUE(s.candidates(params).empty());
}

// The cheapest loop through a node by a plain one-sided Dijkstra.
double brute_force_loop_cost(const TracingGraph& g, int source, double weight) {
  using Item = std::pair<double, int>;
  std::priority_queue<Item, std::vector<Item>, std::greater<>> heap;
  std::vector<double> best(g.node_count(), 1e300);
  const auto relax = [&](int node, double base) {
    for (int a = g.arc_begin[node]; a < g.arc_begin[node + 1]; ++a) {
      const double cost = base + arc_cost(g.arcs[a], weight);
      if (cost < best[g.arcs[a].to]) best[g.arcs[a].to] = cost, heap.emplace(cost, g.arcs[a].to);
    }
  };
  relax(source, 0);
  while (!heap.empty()) {
    const auto [cost, node] = heap.top();
    heap.pop();
    if (cost > best[node]) continue;
    if (node == source) return cost;
    relax(node, cost);
  }
  return 1e300;
}

TEST(PathSearch, FindsTheCheapestLoopFromBothSides) {
  const TracedShape s(shapes::sphere(12));
  PathSearch search(s.mesh, s.graph, s.field, 50, 1e9);
  int found = 0;
  for (int v = 0; v < s.mesh.vertex_count(); v += 37)
    for (int d : {0, 1}) {
      const Path p = search.through(TracingGraph::node(v, d));
      if (p.vertices.empty()) continue;  // it touched itself
      ++found;
      EXPECT_NEAR(search.last_cost(), brute_force_loop_cost(s.graph, TracingGraph::node(v, d), 50), 1e-9);
      // Removing ears only shortens the chain of edges.
      EXPECT_LE(p.length * (1 + 50 * p.drift), search.last_cost() * (1 + 1e-6));
    }
  EXPECT_GT(found, 20);
}

}  // namespace
}  // namespace sheetform
