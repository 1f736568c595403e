#include "sheetform/mesh/working_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sheetform/mesh/mesh_repair.h"
#include "support/shapes.h"

namespace sheetform {
namespace {

struct Kept {
  double off = 0;   // largest distance of the working mesh from the input, at vertices and middles of edges
  int creases = 0;  // edges
};

// Of a box of a diagonal of 1, from few large triangles.
Kept kept(std::optional<double> crease_angle) {
  TriangleSoup box = shapes::box(2, {6, 3, 2});
  for (Vector3& p : box.points) p /= 7;
  const SurfaceMesh input = build_surface_mesh(std::move(box.points), std::move(box.faces));
  const ClosestPointTree tree(input.points, input.faces);
  const PreparedMesh prepared = working_mesh(input, tree, {0.05, crease_angle, false}, {});
  EXPECT_TRUE(prepared.remeshed);
  Kept kept;
  kept.creases = static_cast<int>(std::count(prepared.crease_edge.begin(), prepared.crease_edge.end(), 1));
  const auto& points = prepared.mesh.points;
  for (const auto& e : prepared.mesh.edges)
    for (double t : {0.0, 0.5})
      kept.off = std::max(
          kept.off,
          std::sqrt(tree.closest(points[e.v0] + t * (points[e.v1] - points[e.v0])).squared_distance));
  return kept;
}

TEST(WorkingMesh, SharpEdgesStayInPlaceThatAreNoCreases) {
  const Kept creased = kept(40), off = kept(std::nullopt), blunt = kept(100), sharp = kept(80);
  EXPECT_GT(creased.creases, 0);
  EXPECT_EQ(sharp.creases, creased.creases);
  EXPECT_EQ(off.creases, 0);
  EXPECT_EQ(blunt.creases, 0);
  for (const Kept& k : {creased, off, blunt, sharp}) EXPECT_LT(k.off, 1e-9);
}

// Its details are no reason to leave a mesh as it is whose triangles are far larger than parts may have to
// be.
TEST(WorkingMesh, CoarseMeshesWithDetailsAreRemeshed) {
  TriangleSoup rough = shapes::sphere(10, 0.28);
  for (Vector3& p : rough.points) p *= 1 + 0.05 * std::sin(60 * p.x()) * std::sin(60 * p.y() + 1);
  const SurfaceMesh input = build_surface_mesh(std::move(rough.points), std::move(rough.faces));
  const ClosestPointTree tree(input.points, input.faces);
  const double present = mean_edge_length(input);
  EXPECT_LT(mean_edge_length(working_mesh(input, tree, {0.005, 40.0, false}, {}).mesh), 0.5 * present);
}

// Of a coarse model no point is given up, and paths may run across its facets; where these are far apart in
// tolerances they are parts.
TEST(WorkingMesh, LargeFacetsAreKeptAndHaveVerticesInside) {
  TriangleSoup ball = shapes::sphere(4, 0.3);
  const SurfaceMesh input = build_surface_mesh(std::move(ball.points), std::move(ball.faces));
  const ClosestPointTree tree(input.points, input.faces);
  for (double e_max : {0.005, 0.0002}) {
    const PreparedMesh working = working_mesh(input, tree, {e_max, 40.0, false}, {});
    const ClosestPointTree of_working(working.mesh.points, working.mesh.faces);
    EXPECT_LT(mean_edge_length(working.mesh), 0.3 * mean_edge_length(input));
    double off = 0, creases = 0, edges = 0;
    for (const Vector3& p : working.mesh.points) off = std::max(off, tree.closest(p).squared_distance);
    for (const Vector3& p : input.points) off = std::max(off, of_working.closest(p).squared_distance);
    EXPECT_LT(std::sqrt(off), 1e-9);
    for (int e = 0; e < working.mesh.edge_count(); ++e)
      if (working.crease_edge[e]) creases += working.mesh.edge_length(e);
    for (int e = 0; e < input.edge_count(); ++e) edges += input.edge_length(e);
    if (e_max > 0.001)
      EXPECT_EQ(creases, 0);
    else
      EXPECT_GT(creases, 0.5 * edges);
  }
}

}  // namespace
}  // namespace sheetform
