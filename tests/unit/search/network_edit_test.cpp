#include "sheetform/search/network_edit.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/drawing.h"

namespace sheetform {
namespace {

using shapes::Drawing;
using shapes::drawn;

// A straight path between two corners of cells; directions 0 right, 1 up, 2 left, 3 down.
Path straight(const Drawing& d, int column, int row, int to_column, int to_row) {
  Path path;
  const std::vector<int> edges = d.line(column, row, to_column, to_row);
  path.vertices.push_back(d.vertex_at(column, row));
  for (int e : edges) path.vertices.push_back(d.mesh.edges[e].other(path.vertices.back()));
  const signed char dir = to_column > column ? 0 : to_column < column ? 2 : to_row < row ? 1 : 3;
  path.dirs.assign(path.vertices.size(), dir);
  return path;
}

struct Board {
  Drawing d;
  EditableNetwork network;
  explicit Board(const char* text) : d(drawn(text)), network(d.mesh, d.network) {}
};

TEST(EditableNetwork, CrossingPathsFit) {
  Board b("AAA/AAA/AAA");
  const Path across = straight(b.d, 0, 1, 3, 1), down = straight(b.d, 1, 0, 1, 3);
  ASSERT_TRUE(b.network.fits(across));
  const int id = b.network.insert(across, PathKind::kTraced);
  EXPECT_EQ(b.network.edges_of_path(id).size(), across.vertices.size() - 1);
  EXPECT_FALSE(b.network.fits(across)) << "its edges are taken";
  EXPECT_TRUE(b.network.fits(down));
  b.network.insert(down, PathKind::kTraced);
  EXPECT_EQ(network_degree(b.d.mesh, b.network.network(), b.d.vertex_at(1, 1)), 4);
  EXPECT_TRUE(b.network.fits(straight(b.d, 0, 2, 3, 2)));
}

// The neighbour of v in this direction of the plane, -1 if none.
int neighbour(const SurfaceMesh& mesh, int v, const Vector2& way) {
  for (const int* e = mesh.ring_begin_of(v); e != mesh.ring_end_of(v); ++e) {
    const int w = mesh.edges[*e].other(v);
    if ((mesh.points[w] - mesh.points[v]).head<2>().normalized().dot(way.normalized()) > 0.999) return w;
  }
  return -1;
}

TEST(EditableNetwork, PathsThatTouchWithoutCrossingDoNotFit) {
  Board b("AAA/AAA/AAA");
  const SurfaceMesh& mesh = b.d.mesh;
  // Down to (1, 1) and up again beside it.
  Path bounce = straight(b.d, 1, 0, 1, 1);
  for (int v = neighbour(mesh, b.d.vertex_at(1, 1), {1, 1}); v >= 0; v = neighbour(mesh, v, {0, 1}))
    bounce.vertices.push_back(v), bounce.dirs.push_back(3);
  ASSERT_TRUE(mesh.border_vertex[bounce.vertices.back()]);
  ASSERT_GT(bounce.vertices.size(), 2 * straight(b.d, 1, 0, 1, 1).vertices.size() - 2);
  ASSERT_TRUE(b.network.fits(bounce)) << "as long as nothing runs through (1, 1)";
  b.network.insert(straight(b.d, 0, 1, 3, 1), PathKind::kTraced);
  EXPECT_FALSE(b.network.fits(bounce));
  EXPECT_TRUE(b.network.fits(straight(b.d, 1, 0, 1, 3))) << "straight through is a crossing";
}

TEST(EditableNetwork, PathsOfTheSameDirectionShareNoVertex) {
  Board b("AAA/AAA/AAA");
  b.network.insert(straight(b.d, 0, 1, 3, 1), PathKind::kTraced);
  // Crosses transversally, but travels in the same M2 sheet as the path that is there.
  Path down = straight(b.d, 1, 0, 1, 3);
  std::fill(down.dirs.begin(), down.dirs.end(), 2);
  EXPECT_FALSE(b.network.fits(down));
}

TEST(EditableNetwork, PathsEndOnBordersOncePerVertex) {
  Board b("AAA/AAA/AAA");
  const Path down = straight(b.d, 1, 0, 1, 3);
  b.network.insert(down, PathKind::kTraced);
  Path upwards = down;
  std::reverse(upwards.vertices.begin(), upwards.vertices.end());
  EXPECT_FALSE(b.network.fits(upwards));
  const Path inside = straight(b.d, 2, 1, 2, 3);
  EXPECT_FALSE(b.network.fits(inside)) << "starts where nothing is";
}

TEST(EditableNetwork, PathsEndOnCreasesOncePerSide) {
  Board b("AAA/AAA/AAA");
  b.network.insert_edges(b.d.line(0, 1, 3, 1), PathKind::kCrease);
  const Path above = straight(b.d, 1, 0, 1, 1), below = straight(b.d, 1, 3, 1, 1);
  ASSERT_TRUE(b.network.fits(above));
  b.network.insert(above, PathKind::kTraced);
  EXPECT_TRUE(b.network.fits(below)) << "the other side is free";
  Path slanted = straight(b.d, 2, 0, 2, 1);
  EXPECT_TRUE(b.network.fits(slanted));
}

TEST(EditableNetwork, RemovalIsUndoneByRestoring) {
  Board b("AAB/AAC");
  const std::vector<int> edges = b.d.line(2, 1, 3, 1);
  const std::vector<int> before = b.network.network().edge_path;
  std::vector<int> paths;
  for (int e : edges) paths.push_back(before[e]);
  b.network.remove_edges(edges);
  for (int e : edges) EXPECT_FALSE(b.network.network().used(e));
  b.network.restore_edges(edges, paths);
  EXPECT_EQ(b.network.network().edge_path, before);
}

TEST(EditableNetwork, KnowsLooseEnds) {
  Board b("AAB/AAC");
  EXPECT_FALSE(b.network.leaves_loose_end(b.d.line(2, 1, 3, 1)))
      << "leaves the straight path through the T-junction";
  EXPECT_TRUE(b.network.leaves_loose_end({b.d.line(2, 1, 3, 1)[1]})) << "a gap in an arch";
  std::vector<int> all = b.d.line(2, 0, 2, 2);
  EXPECT_TRUE(b.network.leaves_loose_end(all)) << "the stem of the T would hang in the air";
  const std::vector<int> stem = b.d.line(2, 1, 3, 1);
  all.insert(all.end(), stem.begin(), stem.end());
  EXPECT_FALSE(b.network.leaves_loose_end(all));
}

}  // namespace
}  // namespace sheetform
