#include "sheetform/mesh/denoise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "sheetform/mesh/closest_point.h"
#include "sheetform/mesh/creases.h"
#include "sheetform/mesh/working_mesh.h"
#include "support/shapes.h"

namespace sheetform {
namespace {

SurfaceMesh build(TriangleSoup s) { return build_surface_mesh(std::move(s.points), std::move(s.faces)); }

// With every point moved by a normally distributed vector, of `noise` diagonals in any direction.
SurfaceMesh scanned(SurfaceMesh mesh, double noise) {
  std::mt19937_64 rng(7);
  std::normal_distribution<double> n(0, noise * bounding_box_diagonal(mesh.points));
  for (Vector3& p : mesh.points) p += Vector3(n(rng), n(rng), n(rng));
  return mesh;
}

// Of a diagonal near 1, edges of 2 % of it.
SurfaceMesh cuboid() { return build(shapes::box(24, {0.6, 0.6, 0.5})); }

double length(const SurfaceMesh& mesh, const std::vector<char>& crease) {
  double sum = 0;
  for (int e = 0; e < mesh.edge_count(); ++e)
    if (crease[e]) sum += mesh.edge_length(e);
  return sum;
}

double mean_distance(const SurfaceMesh& mesh, const SurfaceMesh& to) {
  const ClosestPointTree tree(to.points, to.faces);
  double sum = 0;
  for (const Vector3& p : mesh.points) sum += std::sqrt(tree.closest(p).squared_distance);
  return sum / mesh.vertex_count();
}

// Ridges and valleys in turn, one strip of triangles each.
SurfaceMesh corrugated(int strips) {
  TriangleSoup s = shapes::grid({strips, strips}, [=](double u, double v) {
    return Vector3(u, v, std::lround(u * strips) % 2 == 0 ? 0 : 0.2 / strips);
  });
  return build(s);
}

TEST(Noise, IsTheRoughnessOfAScan) {
  for (double noise : {0.001, 0.002, 0.005}) {
    EXPECT_TRUE(is_noisy(scanned(cuboid(), noise))) << noise;
    EXPECT_TRUE(is_noisy(scanned(build(shapes::sphere(24)), noise))) << noise;
    EXPECT_TRUE(is_noisy(scanned(build(shapes::plane(48)), noise))) << noise;
  }
}

TEST(Noise, IsNoneOnCleanShapes) {
  for (const SurfaceMesh& mesh :
       {cuboid(), build(shapes::box(1, {1, 1, 0.01})), build(shapes::closed_cylinder(12, 2)),
        build(shapes::sphere(4)), build(shapes::torus(12, 6)), build(shapes::saddle(6, 2)), corrugated(24)})
    EXPECT_FALSE(is_noisy(mesh)) << mesh.face_count();
}

TEST(Noise, IsNoneOnVeryUnevenMeshes) {
  // A sheet of a few long strips, rough in all but name: each is a facet of its own.
  const SurfaceMesh mesh = build(shapes::grid(
      {40, 2}, [](double u, double v) { return Vector3(u, 4 * v, 0.01 * std::cos(40 * shapes::kPi * u)); }));
  EXPECT_FALSE(is_noisy(mesh));
}

TEST(Noise, GoesFromFacesAndLeavesEdges) {
  const SurfaceMesh clean = cuboid();
  const double edges = 4 * (0.6 + 0.6 + 0.5);
  for (double noise : {0.002, 0.004}) {
    const SurfaceMesh rough = scanned(clean, noise), calm = denoised(rough);
    EXPECT_LT(mean_distance(calm, clean), 0.6 * mean_distance(rough, clean)) << noise;
    const double found = length(calm, detect_creases(calm, 40));
    EXPECT_LT(length(rough, detect_creases(rough, 40)), 0.3 * edges) << noise;
    EXPECT_GT(found, 0.9 * edges) << noise;
    EXPECT_LT(found, 1.1 * edges) << noise;
  }
}

TEST(Noise, OfRoundShapesLeavesNoEdges) {
  for (double noise : {0.002, 0.005})
    for (const SurfaceMesh& clean : {build(shapes::sphere(24)), build(shapes::torus(64, 32))}) {
      const SurfaceMesh calm = denoised(scanned(clean, noise));
      EXPECT_EQ(length(calm, detect_creases(calm, 40)), 0) << noise;
    }
}

TEST(Noise, BordersAndTrianglesStay) {
  const SurfaceMesh rough = scanned(build(shapes::plane(24)), 0.003), calm = denoised(rough);
  EXPECT_EQ(calm.faces, rough.faces);
  for (int v = 0; v < rough.vertex_count(); ++v)
    EXPECT_EQ(rough.border_vertex[v] != 0, calm.points[v] == rough.points[v]);
}

PreparedMesh working_mesh_of(const SurfaceMesh& mesh, double e_max) {
  return working_mesh(mesh, ClosestPointTree(mesh.points, mesh.faces), {e_max, 40.0, false}, {});
}

TEST(WorkingMesh, OfAScannedPartHasItsCreases) {
  const SurfaceMesh clean = cuboid();
  const PreparedMesh working = working_mesh_of(scanned(clean, 0.002), 0.02);
  const double edges = 4 * (0.6 + 0.6 + 0.5), found = length(working.mesh, working.crease_edge);
  EXPECT_GT(found, 0.9 * edges);
  EXPECT_LT(found, 1.1 * edges);
  EXPECT_LT(mean_distance(working.mesh, clean), 0.0015);
}

TEST(WorkingMesh, KeepsWhatTheToleranceAsksFor) {
  const SurfaceMesh rough = scanned(cuboid(), 0.002);
  EXPECT_LT(mean_distance(working_mesh_of(rough, 0.004).mesh, rough), 1e-9);
  EXPECT_GT(mean_distance(working_mesh_of(rough, 0.02).mesh, rough), 5e-4);
}

}  // namespace
}  // namespace sheetform
