#include "sheetform/tracing/seeds.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/shapes.h"

namespace sheetform {
namespace {

SurfaceMesh build(TriangleSoup soup) {
  return build_surface_mesh(std::move(soup.points), std::move(soup.faces));
}

std::vector<double> distances(const SurfaceMesh& mesh, const std::vector<int>& sources) {
  std::vector<double> d(mesh.points.size(), std::numeric_limits<double>::infinity());
  for (int s : sources) d[s] = 0;
  for (bool changed = true; changed;) {
    changed = false;
    for (int e = 0; e < mesh.edge_count(); ++e)
      for (const auto& [a, b] :
           {std::pair(mesh.edges[e].v0, mesh.edges[e].v1), std::pair(mesh.edges[e].v1, mesh.edges[e].v0)})
        if (d[a] + mesh.edge_length(e) < d[b]) d[b] = d[a] + mesh.edge_length(e), changed = true;
  }
  return d;
}

TEST(FarthestPointSamples, EqualsBruteForce) {
  const SurfaceMesh mesh = build(shapes::torus(18, 9));
  const std::vector<char> all(mesh.points.size(), 1), none(mesh.points.size(), 0);
  const std::vector<int> samples = farthest_point_samples(mesh, all, none, 12);
  ASSERT_EQ(samples.size(), 12u);
  std::vector<int> expected;
  while (expected.size() < 12) {
    const std::vector<double> d = distances(mesh, expected);
    int best = 0;
    for (int v = 1; v < mesh.vertex_count(); ++v)
      if (d[v] > d[best]) best = v;
    expected.push_back(best);
  }
  EXPECT_EQ(samples, expected);
}

TEST(FarthestPointSamples, TakesCandidatesOnlyAndKeepsAwayFromTheStart) {
  const SurfaceMesh mesh = build(shapes::plane(10));
  std::vector<char> candidate(mesh.points.size(), 0);
  for (int v = 0; v < mesh.vertex_count(); ++v) candidate[v] = !mesh.border_vertex[v];
  const std::vector<int> samples = farthest_point_samples(mesh, candidate, mesh.border_vertex, 3);
  ASSERT_EQ(samples.size(), 3u);
  EXPECT_EQ(samples[0], 5 * 11 + 5);  // the centre of the square
  for (int v : samples) EXPECT_FALSE(mesh.border_vertex[v]);
}

TEST(FarthestPointSamples, EndsWhenAllCandidatesAreTaken) {
  const SurfaceMesh mesh = build(shapes::plane(2));
  const std::vector<char> all(9, 1), none(9, 0);
  EXPECT_EQ(farthest_point_samples(mesh, all, none, 100).size(), 9u);
  EXPECT_TRUE(farthest_point_samples(mesh, none, none, 100).empty());
}

TEST(FarthestPointSamples, CoversEveryComponent) {
  TriangleSoup two = shapes::plane(3), other = shapes::plane(3);
  for (auto& t : other.faces)
    for (int& v : t) v += 16;
  for (auto& p : other.points) two.points.push_back(p + Vector3(10, 0, 0));
  two.faces.insert(two.faces.end(), other.faces.begin(), other.faces.end());
  const SurfaceMesh mesh = build(two);
  const std::vector<char> all(32, 1), none(32, 0);
  const std::vector<int> samples = farthest_point_samples(mesh, all, none, 2);
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_NE(samples[0] < 16, samples[1] < 16);
}

}  // namespace
}  // namespace sheetform
