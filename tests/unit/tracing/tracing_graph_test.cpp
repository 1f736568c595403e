#include <gtest/gtest.h>

#include <algorithm>

#include "sheetform/base/error.h"
#include "unit/tracing/traced_shape.h"

namespace sheetform {
namespace {

const TracingGraph::Arc* find_arc(const TracingGraph& g, int from, int to) {
  for (int a = g.arc_begin[from]; a < g.arc_begin[from + 1]; ++a)
    if (g.arcs[a].to == to) return &g.arcs[a];
  return nullptr;
}

int arcs_out(const TracingGraph& g, int node) { return g.arc_begin[node + 1] - g.arc_begin[node]; }

TEST(TracingGraph, NodeArithmetic) {
  EXPECT_EQ(TracingGraph::node(5, 3), 23);
  EXPECT_EQ(TracingGraph::node(5, -1), 23);
  EXPECT_EQ(TracingGraph::vertex(23), 5);
  EXPECT_EQ(TracingGraph::opposite(23), 21);
  EXPECT_EQ(TracingGraph::opposite(TracingGraph::opposite(20)), 20);
}

TEST(TracingGraph, ChainsAreMeshEdgesOfTheStatedLength) {
  const TracedShape s(shapes::torus(40, 20));
  for (int node = 0; node < s.graph.node_count(); ++node)
    for (int a = s.graph.arc_begin[node]; a < s.graph.arc_begin[node + 1]; ++a) {
      const auto& arc = s.graph.arcs[a];
      double length = 0;
      int at = TracingGraph::vertex(node);
      for (int i = arc.chain_begin; i <= arc.chain_end; ++i) {
        const int next = i < arc.chain_end ? s.graph.chain[i] : TracingGraph::vertex(arc.to);
        const int e = s.mesh.find_edge(at, next);
        ASSERT_GE(e, 0);
        length += s.mesh.edge_length(e);
        at = next;
      }
      ASSERT_NEAR(arc.length, length, 1e-6);
      ASSERT_LE(arc.length, 3.2 * mean_edge_length(s.mesh) * 1.0001);
    }
}

TEST(TracingGraph, WithoutSomeEdgesNoArcRunsOverThemAndAllOthersStay) {
  const TracedShape s(shapes::torus(40, 20));
  std::vector<char> edges(s.mesh.edges.size(), 0);
  for (int e = 0; e < s.mesh.edge_count(); ++e) edges[e] = s.mesh.points[s.mesh.edges[e].v0].x() > 1;
  const TracingGraph less = without_edges(s.mesh, s.graph, edges);
  ASSERT_EQ(less.node_count(), s.graph.node_count());
  int kept = 0;
  for (int node = 0; node < s.graph.node_count(); ++node)
    for (int a = s.graph.arc_begin[node]; a < s.graph.arc_begin[node + 1]; ++a) {
      const auto& arc = s.graph.arcs[a];
      bool over = false;
      int at = TracingGraph::vertex(node);
      for (int i = arc.chain_begin; i <= arc.chain_end; ++i) {
        const int next = i < arc.chain_end ? s.graph.chain[i] : TracingGraph::vertex(arc.to);
        over |= edges[s.mesh.find_edge(at, next)] != 0;
        at = next;
      }
      ASSERT_EQ(find_arc(less, node, arc.to) == nullptr, over);
      kept += !over;
    }
  EXPECT_EQ(kept, static_cast<int>(less.arcs.size()));
  EXPECT_LT(less.arcs.size(), s.graph.arcs.size());
  EXPECT_EQ(without_edges(s.mesh, s.graph, {}).arcs.size(), s.graph.arcs.size());
}

TEST(TracingGraph, EveryArcHasItsReverse) {
  const TracedShape s(shapes::closed_cylinder(36, 12), 40);
  int count = 0;
  for (int node = 0; node < s.graph.node_count(); ++node)
    for (int a = s.graph.arc_begin[node]; a < s.graph.arc_begin[node + 1]; ++a) {
      const auto& arc = s.graph.arcs[a];
      const auto* back = find_arc(s.graph, TracingGraph::opposite(arc.to), TracingGraph::opposite(node));
      ASSERT_NE(back, nullptr);
      ASSERT_NEAR(back->drift, arc.drift, 1e-4);
      ASSERT_NEAR(back->length, arc.length, 1e-6);
      ++count;
    }
  EXPECT_GT(count, 1000);
}

TEST(TracingGraph, ArcsAreSortedByDriftAndWithinTheAngle) {
  const TracedShape s(shapes::sphere(12));
  for (int node = 0; node < s.graph.node_count(); ++node)
    for (int a = s.graph.arc_begin[node]; a < s.graph.arc_begin[node + 1]; ++a) {
      ASSERT_LE(s.graph.arcs[a].drift, 40);
      if (a > s.graph.arc_begin[node]) {
        ASSERT_LE(s.graph.arcs[a - 1].drift, s.graph.arcs[a].drift);
      }
    }
}

TEST(TracingGraph, NoDriftAlongTheLinesOfAFlatGrid) {
  const int n = 12;
  const TracedShape s(shapes::plane(n));
  const int v = 6 * (n + 1) + 6;
  for (int d = 0; d < 4; ++d) {
    const Vector3 direction = s.field.direction(v, d);
    const int right = v + static_cast<int>(std::lround(direction.x())) +
                      (n + 1) * static_cast<int>(std::lround(direction.y()));
    bool found = false;
    for (int a = s.graph.arc_begin[4 * v + d]; a < s.graph.arc_begin[4 * v + d + 1]; ++a)
      if (TracingGraph::vertex(s.graph.arcs[a].to) == right) {
        EXPECT_NEAR(s.graph.arcs[a].drift, 0, 0.5);
        found = true;
      }
    EXPECT_TRUE(found) << d;
  }
}

TEST(TracingGraph, DriftIsTheMeanDeviation) {
  // On the flat grid the field is parallel: an arc to (2, 1) deviates by atan(1/2) at both ends.
  const int n = 12;
  const TracedShape s(shapes::plane(n));
  const int v = 6 * (n + 1) + 6, target = v + 2 + (n + 1);
  int hits = 0;
  for (int d = 0; d < 4; ++d)
    for (int a = s.graph.arc_begin[4 * v + d]; a < s.graph.arc_begin[4 * v + d + 1]; ++a)
      if (TracingGraph::vertex(s.graph.arcs[a].to) == target) {
        EXPECT_NEAR(s.graph.arcs[a].drift, std::atan(0.5) * 180 / shapes::kPi, 0.5);
        ++hits;
      }
  EXPECT_EQ(hits, 1);
}

TEST(TracingGraph, BorderIsLeftInwardsOnly) {
  const int n = 12;
  const TracedShape s(shapes::plane(n));
  for (int v = 0; v < s.mesh.vertex_count(); ++v) {
    EXPECT_EQ(s.graph.terminal[v], s.mesh.border_vertex[v]);
    if (!s.mesh.border_vertex[v]) continue;
    const int i = v % (n + 1), j = v / (n + 1);
    const bool corner = (i == 0 || i == n) && (j == 0 || j == n);
    int usable = 0;
    for (int d = 0; d < 4; ++d) {
      if (arcs_out(s.graph, 4 * v + d) == 0) continue;
      ++usable;
      const Vector3 inward(i == 0 ? 1 : i == n ? -1 : 0, j == 0 ? 1 : j == n ? -1 : 0, 0);
      EXPECT_GT(s.field.direction(v, d).dot(inward), 0.99);
    }
    EXPECT_EQ(usable, corner ? 0 : 1) << i << "," << j;
  }
}

TEST(TracingGraph, ConcaveCornerIsLeftAcrossBothOfItsSides) {
  // An L: the flat grid without its upper right quarter. At the inner corner the sides go up and right.
  const int n = 12;
  TriangleSoup soup = shapes::plane(n, n), l;
  std::vector<int> id(soup.points.size(), -1);
  for (const auto& t : soup.faces) {
    const Vector3 centre = (soup.points[t[0]] + soup.points[t[1]] + soup.points[t[2]]) / 3;
    if (centre.x() > n / 2.0 && centre.y() > n / 2.0) continue;
    std::array<int, 3> face{};
    for (int k = 0; k < 3; ++k) {
      if (id[t[k]] < 0) id[t[k]] = static_cast<int>(l.points.size()), l.points.push_back(soup.points[t[k]]);
      face[k] = id[t[k]];
    }
    l.faces.push_back(face);
  }
  const int corner = id[(n / 2) * (n + 1) + n / 2];
  const TracedShape s(l);
  int usable = 0;
  for (int d = 0; d < 4; ++d) {
    if (arcs_out(s.graph, 4 * corner + d) == 0) continue;
    ++usable;
    const Vector3 direction = s.field.direction(corner, d);
    EXPECT_LT(std::min(direction.x(), direction.y()), -0.95);
  }
  EXPECT_EQ(usable, 2);
}

TEST(TracingGraph, CreasesAreTerminalAndOpenOnBothSides) {
  const TracedShape s(shapes::closed_cylinder(36, 12), 40);
  int on_crease = 0;
  for (int v = 0; v < s.mesh.vertex_count(); ++v) {
    if (!s.graph.terminal[v]) continue;
    ++on_crease;
    int usable = 0;
    for (int d = 0; d < 4; ++d) usable += arcs_out(s.graph, 4 * v + d) > 0;
    EXPECT_EQ(usable, 2);
  }
  EXPECT_EQ(on_crease, 72);
  for (int v : s.graph.chain) EXPECT_FALSE(s.graph.terminal[v]);
}

TEST(TracingGraph, DoesNotDependOnTheNumberOfThreads) {
  const TracedShape s(shapes::sphere(16));
  RunContext two;
  two.threads = 2;
  const TracingGraph other = tracing_graph(s.mesh, s.crease, s.field, {}, two);
  ASSERT_EQ(other.arc_begin, s.graph.arc_begin);
  EXPECT_EQ(other.chain, s.graph.chain);
  for (std::size_t a = 0; a < other.arcs.size(); ++a) {
    EXPECT_EQ(other.arcs[a].to, s.graph.arcs[a].to);
    EXPECT_EQ(other.arcs[a].drift, s.graph.arcs[a].drift);
  }
}

TEST(TracingGraph, Cancels) {
  const TracedShape s(shapes::torus(20, 10));
  const std::atomic<bool> stop{true};
  RunContext context;
  context.cancelled = &stop;
  EXPECT_THROW(tracing_graph(s.mesh, s.crease, s.field, {}, context), Error);
  EXPECT_THROW(trace_candidates(s.mesh, s.graph, s.field, {}, context), Error);
}

}  // namespace
}  // namespace sheetform
