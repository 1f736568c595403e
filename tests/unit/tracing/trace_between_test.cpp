#include <gtest/gtest.h>

#include "unit/tracing/traced_shape.h"

namespace sheetform {
namespace {

class TraceBetween : public testing::Test {
 protected:
  static constexpr int kN = 16;
  static int at(int i, int j) { return j * (kN + 1) + i; }
  // Vertices strictly inside a rectangle of columns and rows.
  std::vector<char> inside(int i0, int i1, int j0, int j1) const {
    std::vector<char> allowed(shape_.mesh.points.size(), 0);
    for (int j = j0 + 1; j < j1; ++j)
      for (int i = i0 + 1; i < i1; ++i) allowed[at(i, j)] = 1;
    return allowed;
  }
  int direction_towards(int v, const Vector3& w) const {
    for (int d = 0; d < 4; ++d)
      if (shape_.field.direction(v, d).dot(w) > 0.9) return d;
    return 0;
  }
  // Nodes of column i that travel towards +x, rows j0 < j < j1.
  std::vector<int> column(int i, int j0, int j1) const {
    std::vector<int> nodes;
    for (int j = j0 + 1; j < j1; ++j)
      nodes.push_back(TracingGraph::node(at(i, j), direction_towards(at(i, j), Vector3::UnitX())));
    return nodes;
  }
  Path trace(const std::vector<int>& sources, const std::vector<int>& targets,
             const std::vector<char>& allowed) const {
    return trace_between(shape_.mesh, shape_.graph, shape_.field, sources, targets, allowed, {});
  }
  const TracedShape shape_{shapes::plane(kN)};
};

TEST_F(TraceBetween, CrossesAPatchStraight) {
  const Path p = trace(column(3, 7, 9), column(12, 3, 13), inside(3, 12, 3, 13));
  ASSERT_EQ(p.vertices.size(), 10u);
  EXPECT_FALSE(p.loop);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(p.vertices[i], at(3 + i, 8));
  EXPECT_NEAR(p.drift, 0, 1e-4);
}

TEST_F(TraceBetween, StaysInsideItsMask) {
  // A wall across the patch with a gap at row 10: the way has to go through the gap.
  std::vector<char> allowed = inside(3, 12, 3, 13);
  for (int j = 4; j < 13; ++j)
    if (j != 10) allowed[at(7, j)] = 0;
  const Path p = trace(column(3, 7, 9), column(12, 3, 13), allowed);
  ASSERT_FALSE(p.vertices.empty());
  bool gap = false;
  for (std::size_t i = 0; i < p.vertices.size(); ++i) {
    gap = gap || p.vertices[i] == at(7, 10);
    if (i > 0 && i + 1 < p.vertices.size()) {
      EXPECT_TRUE(allowed[p.vertices[i]]);
    }
  }
  EXPECT_TRUE(gap);
}

TEST_F(TraceBetween, IsEmptyWhenNoWayExists) {
  std::vector<char> allowed = inside(3, 12, 3, 13);
  for (int j = 0; j <= kN; ++j)
    for (int i = 6; i <= 9; ++i) allowed[at(i, j)] = 0;  // wider than any arc
  EXPECT_TRUE(trace(column(3, 7, 9), column(12, 3, 13), allowed).vertices.empty());
  EXPECT_TRUE(trace({}, column(12, 3, 13), inside(3, 12, 3, 13)).vertices.empty());
}

TEST_F(TraceBetween, TakesTheCheapestPairOfEnds) {
  // Only row 6 is both a source and a target row.
  const Path p = trace(column(3, 5, 7), column(12, 3, 13), inside(3, 12, 3, 13));
  ASSERT_FALSE(p.vertices.empty());
  EXPECT_EQ(p.vertices.front(), at(3, 6));
  EXPECT_EQ(p.vertices.back(), at(12, 6));
}

TEST_F(TraceBetween, DoesNotJumpBetweenNeighboursOnTheBoundary) {
  // Source and target are joined by one edge that runs along the patch's boundary.
  const int v = at(3, 8), w = at(4, 8);
  const int d = direction_towards(v, Vector3::UnitX());
  const Path p = trace({TracingGraph::node(v, d)}, {TracingGraph::node(w, d)}, inside(3, 12, 8, 13));
  for (std::size_t i = 1; i + 1 < p.vertices.size(); ++i) EXPECT_GT(p.vertices[i] / (kN + 1), 8);
  EXPECT_NE(p.vertices.size(), 2u);
}

}  // namespace
}  // namespace sheetform
