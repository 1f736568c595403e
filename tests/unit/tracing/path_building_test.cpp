#include "sheetform/tracing/path_building.h"

#include <gtest/gtest.h>

#include "unit/tracing/traced_shape.h"

namespace sheetform {
namespace {

class PathBuilding : public testing::Test {
 protected:
  static constexpr int kN = 10;
  // Vertex in column i and row j of the flat grid. Diagonals rise from (i, j) to (i+1, j+1) where i + j is
  // even.
  static int at(int i, int j) { return j * (kN + 1) + i; }
  Path finish(const std::vector<int>& vertices, bool loop) const {
    Walk walk;
    for (int v : vertices) walk.steps.push_back({v, 0});
    walk.length = 1;
    return PathBuilder{shape_.mesh, shape_.graph, shape_.field}.finish(walk, loop);
  }
  const TracedShape shape_{shapes::plane(kN)};
};

TEST_F(PathBuilding, KeepsAPlainChain) {
  const std::vector<int> chain{at(2, 5), at(3, 5), at(4, 5), at(5, 5)};
  EXPECT_EQ(finish(chain, false).vertices, chain);
  EXPECT_NEAR(finish(chain, false).length, 0.3, 1e-12);
}

TEST_F(PathBuilding, RemovesSpikes) {
  EXPECT_EQ(finish({at(2, 5), at(3, 5), at(3, 6), at(3, 5), at(4, 5)}, false).vertices,
            (std::vector<int>{at(2, 5), at(3, 5), at(4, 5)}));
}

TEST_F(PathBuilding, RemovesShortCycles) {
  EXPECT_EQ(finish({at(2, 5), at(3, 5), at(4, 5), at(4, 6), at(3, 6), at(3, 5), at(3, 4), at(3, 3)}, false)
                .vertices,
            (std::vector<int>{at(2, 5), at(3, 5), at(3, 4), at(3, 3)}));
}

TEST_F(PathBuilding, ReplacesTwoSidesOfATriangleByTheThird) {
  // (2,2), (3,2), (3,3) is a triangle.
  EXPECT_EQ(finish({at(1, 2), at(2, 2), at(3, 2), at(3, 3), at(3, 4)}, false).vertices,
            (std::vector<int>{at(1, 2), at(2, 2), at(3, 3), at(3, 4)}));
}

TEST_F(PathBuilding, CleansALoopAcrossItsSeam) {
  // A ring of eight around (4,4) that starts with a spike out of it.
  const Path p = finish(
      {at(2, 4), at(3, 4), at(3, 3), at(4, 3), at(5, 3), at(5, 4), at(5, 5), at(4, 5), at(3, 5), at(3, 4)},
      true);
  EXPECT_TRUE(p.loop);
  for (int v : p.vertices) EXPECT_NE(v, at(2, 4));
  EXPECT_LE(p.vertices.size(), 8u);
  EXPECT_GE(p.vertices.size(), 4u);
}

TEST_F(PathBuilding, RejectsWhatComesBackNextToItself) {
  std::vector<int> hairpin;
  for (int i = 1; i <= 8; ++i) hairpin.push_back(at(i, 4));
  hairpin.push_back(at(9, 5));
  for (int i = 8; i >= 5; --i) hairpin.push_back(at(i, 6));
  EXPECT_FALSE(finish(hairpin, false).vertices.empty());  // two rows apart: fine
  for (int i = 5; i >= 3; --i) hairpin.push_back(at(i, 5));
  EXPECT_TRUE(finish(hairpin, false).vertices.empty());  // one row apart at last
}

TEST_F(PathBuilding, RejectsWhatPassesTheBorder) {
  EXPECT_TRUE(finish({at(1, 1), at(1, 0), at(3, 1)}, false).vertices.empty());
  EXPECT_TRUE(finish({at(2, 1), at(1, 0), at(0, 1), at(1, 2)}, false).vertices.empty());
  EXPECT_EQ(finish({at(3, 0), at(3, 1), at(3, 2)}, false).vertices.size(), 3u);
}

TEST_F(PathBuilding, RejectsAGap) { EXPECT_TRUE(finish({at(2, 2), at(5, 5)}, false).vertices.empty()); }

TEST(ReversedWalk, TurnsDirectionsRound) {
  Walk walk;
  walk.steps = {{7, 0}, {8, 1}, {9, 3}};
  const Walk back = reversed(walk);
  EXPECT_EQ(back.steps[0].vertex, 9);
  EXPECT_EQ(back.steps[0].dir, 1);
  EXPECT_EQ(back.steps[1].dir, 3);
  EXPECT_EQ(back.steps[2].dir, 2);
}

TEST(ArcCost, IsQuadraticInTheDrift) {
  TracingGraph::Arc arc{};
  arc.length = 2;
  arc.drift = 22.5;
  EXPECT_NEAR(arc_cost(arc, 50), 2 * (1 + 50 * 0.25), 1e-12);
}

}  // namespace
}  // namespace sheetform
