#include <gtest/gtest.h>

#include "unit/tracing/traced_shape.h"

namespace sheetform {
namespace {

// Bellman-Ford: slow and obviously right.
std::vector<double> brute_force(const TracingGraph& g, const std::vector<int>& sources, double cap) {
  std::vector<double> distance(g.node_count(), cap);
  std::vector<char> is_source(g.node_count(), 0);
  for (int s : sources) distance[s] = 0, is_source[s] = 1;
  for (bool changed = true; changed;) {
    changed = false;
    for (int node = 0; node < g.node_count(); ++node) {
      if (g.terminal[TracingGraph::vertex(node)] && !is_source[node]) continue;
      for (int a = g.arc_begin[node]; a < g.arc_begin[node + 1]; ++a) {
        const double d = distance[node] + g.arcs[a].length;
        if (d < distance[g.arcs[a].to]) distance[g.arcs[a].to] = d, changed = true;
      }
    }
  }
  return distance;
}

std::vector<int> nodes_of(const Path& p) {
  std::vector<int> nodes;
  for (std::size_t i = 0; i < p.vertices.size(); ++i) {
    nodes.push_back(TracingGraph::node(p.vertices[i], p.dirs[i]));
    nodes.push_back(TracingGraph::opposite(nodes.back()));
  }
  return nodes;
}

TEST(NodeDistance, EqualsBruteForceAfterEveryInsertion) {
  for (const TracedShape& s :
       {TracedShape(shapes::sphere(8)), TracedShape(shapes::closed_cylinder(30, 8), 40)}) {
    const std::vector<Path> paths = s.candidates();
    ASSERT_GT(paths.size(), 4u);
    const double cap = bounding_box_diagonal(s.mesh.points);
    NodeDistance distance(s.graph, cap);
    std::vector<int> sources;
    for (int i = 0; i < 4; ++i) {
      distance.add(paths[i]);
      for (int node : nodes_of(paths[i])) sources.push_back(node);
      const std::vector<double> expected = brute_force(s.graph, sources, cap);
      for (int node = 0; node < s.graph.node_count(); ++node)
        ASSERT_NEAR(distance.at(node), expected[node], 1e-9);
    }
  }
}

TEST(NodeDistance, IsTheCapWithoutSources) {
  const TracedShape s(shapes::plane(6));
  const NodeDistance distance(s.graph, 3.5);
  for (int node = 0; node < s.graph.node_count(); ++node) EXPECT_EQ(distance.at(node), 3.5);
}

TEST(NodeDistance, SeesTheOwnSheetOnly) {
  // A meridian of a torus is near parallel meridians and as far as can be from the circles that cross it.
  const TracedShape s(shapes::torus(40, 20));
  NodeDistance distance(s.graph, 100);
  const std::vector<Path> paths = s.candidates();
  const Path* meridian = nullptr;
  for (const Path& p : paths)
    if (turns_around_axis(s.mesh, p) == 0) meridian = &p;
  ASSERT_NE(meridian, nullptr);
  distance.add(*meridian);
  EXPECT_EQ(distance.mean(*meridian), 0);
  for (const Path& p : paths)
    if (turns_around_axis(s.mesh, p) == 0)
      EXPECT_LT(distance.mean(p), 100);
    else
      EXPECT_EQ(distance.mean(p), 100);  // no singularity: the two sheets never meet
}

TEST(NodeDistance, AddNodesMakesSourcesOfNodesAsGiven) {
  const TracedShape s(shapes::torus(20, 10));
  NodeDistance distance(s.graph, 10);
  distance.add_nodes({4, 9});
  const std::vector<double> expected = brute_force(s.graph, {4, 9}, 10);
  for (int node = 0; node < s.graph.node_count(); ++node)
    EXPECT_NEAR(distance.at(node), expected[node], 1e-9);
}

}  // namespace
}  // namespace sheetform
