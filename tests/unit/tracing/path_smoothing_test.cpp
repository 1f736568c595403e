#include "sheetform/tracing/path_smoothing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "sheetform/base/error.h"
#include "unit/tracing/traced_shape.h"

namespace sheetform {
namespace {

SurfaceMesh build(TriangleSoup soup) {
  return build_surface_mesh(std::move(soup.points), std::move(soup.faces));
}

std::vector<char> edges_of(const SurfaceMesh& mesh, const std::vector<std::vector<int>>& chains) {
  std::vector<char> edge(mesh.edges.size(), 0);
  for (const auto& chain : chains)
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) edge[mesh.find_edge(chain[i], chain[i + 1])] = 1;
  return edge;
}

std::vector<int> smooth(SurfaceMesh& mesh, const std::vector<char>& path_edge, SmoothParams params = {},
                        const SurfaceMesh* surface = nullptr) {
  RunContext context;
  const SurfaceMesh& s = surface != nullptr ? *surface : mesh;
  const ClosestPointTree tree(s.points, s.faces);
  return smooth_paths(mesh, path_edge, std::vector<char>(mesh.points.size(), 0), tree, params, context);
}

// A staircase over the flat n x n grid of unit squares, from (2, 0) on: two up, two right, and so on. Its
// corners are not the corners of one triangle.
std::vector<int> staircase(int n) {
  std::vector<int> chain{2};
  for (int i = 2, j = 0; i < n;) {
    for (int k = 0; k < 2; ++k) chain.push_back(++j * (n + 1) + i);
    for (int k = 0; k < 2; ++k) chain.push_back(j * (n + 1) + ++i);
  }
  return chain;
}

void expect_no_flip_nor_sliver(const SurfaceMesh& before, const SurfaceMesh& after) {
  for (int f = 0; f < after.face_count(); ++f) {
    EXPECT_GT(after.face_normal_raw(f).dot(before.face_normal_raw(f)), 0) << f;
    const auto& t = after.faces[f];
    EXPECT_GE(radius_ratio(after.points[t[0]], after.points[t[1]], after.points[t[2]]), 0.1) << f;
  }
}

double turning(const SurfaceMesh& mesh, const std::vector<int>& chain) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < chain.size(); ++i) {
    const Vector3 a = mesh.points[chain[i]] - mesh.points[chain[i - 1]],
                  b = mesh.points[chain[i + 1]] - mesh.points[chain[i]];
    sum += std::atan2(a.cross(b).norm(), a.dot(b));
  }
  return sum;
}

TEST(RadiusRatio, KnownTriangles) {
  EXPECT_NEAR(radius_ratio({0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(3) / 2, 0}), 1, 1e-12);
  // Right isosceles: r = (2 - sqrt 2) / 2, R = sqrt 2 / 2 for legs of 1.
  EXPECT_NEAR(radius_ratio({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), (2 - std::sqrt(2)) * std::sqrt(2), 1e-12);
  EXPECT_EQ(radius_ratio({0, 0, 0}, {1, 0, 0}, {2, 0, 0}), 0);
  EXPECT_EQ(radius_ratio({1, 1, 1}, {1, 1, 1}, {1, 1, 1}), 0);
}

TEST(SmoothPaths, StraightensAStaircaseInThePlane) {
  const int n = 16;
  const SurfaceMesh before = build(shapes::plane(n, n));
  SurfaceMesh mesh = before;
  const std::vector<int> chain = staircase(n);
  smooth(mesh, edges_of(mesh, {chain}));
  EXPECT_LT(turning(mesh, chain), 0.1 * turning(before, chain));
  for (const Vector3& p : mesh.points) EXPECT_NEAR(p.z(), 0, 1e-12);
  expect_no_flip_nor_sliver(before, mesh);
}

TEST(SmoothPaths, LeavesBorderEndsAndFarVerticesAlone) {
  const int n = 16;
  const SurfaceMesh before = build(shapes::plane(n, n));
  SurfaceMesh mesh = before;
  const std::vector<int> chain = staircase(n);
  const std::vector<int> moved = smooth(mesh, edges_of(mesh, {chain}));
  const std::set<int> set(moved.begin(), moved.end());
  EXPECT_TRUE(std::is_sorted(moved.begin(), moved.end()));
  EXPECT_GT(moved.size(), 40u);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    EXPECT_EQ(set.count(v) == 1, mesh.points[v] != before.points[v]);
    const int i = v % (n + 1), j = v / (n + 1);
    if (before.border_vertex[v] || std::abs(i - j) > 7) {
      EXPECT_EQ(mesh.points[v], before.points[v]);
    }
  }
}

TEST(SmoothPaths, DoesNothingToAStraightPathAndWithoutPaths) {
  const int n = 12;
  SurfaceMesh mesh = build(shapes::plane(n, n));
  std::vector<int> row;
  for (int i = 0; i <= n; ++i) row.push_back(6 * (n + 1) + i);
  EXPECT_TRUE(smooth(mesh, edges_of(mesh, {row})).empty());
  EXPECT_TRUE(smooth(mesh, edges_of(mesh, {})).empty());
}

TEST(SmoothPaths, FixedVerticesStay) {
  const int n = 12;
  SurfaceMesh mesh = build(shapes::plane(n, n));
  const SurfaceMesh before = mesh;
  const std::vector<int> chain = staircase(n);
  std::vector<char> fixed(mesh.points.size(), 0);
  fixed[chain[9]] = fixed[chain[12]] = 1;
  RunContext context;
  const ClosestPointTree tree(mesh.points, mesh.faces);
  EXPECT_FALSE(smooth_paths(mesh, edges_of(mesh, {chain}), fixed, tree, {}, context).empty());
  EXPECT_EQ(mesh.points[chain[9]], before.points[chain[9]]);
  EXPECT_EQ(mesh.points[chain[12]], before.points[chain[12]]);
}

TEST(SmoothPaths, KeepsCirclesOfATorusAndMakesThemRound) {
  // Grid lines that wind around the tube once: circles around the axis are staircases on them.
  const TracedShape s(shapes::grid({64, 32, true, true}, [](double u, double v) {
    const double a = 2 * shapes::kPi * u, b = 2 * shapes::kPi * (u + v);
    return Vector3((1 + 0.4 * std::cos(b)) * std::cos(a), (1 + 0.4 * std::cos(b)) * std::sin(a),
                   0.4 * std::sin(b));
  }));
  const ClosestPointTree tree(s.mesh.points, s.mesh.faces);
  const Path* parallel = nullptr;
  double worst = 0;
  const auto height_range = [](const SurfaceMesh& mesh, const Path& p) {
    double lo = 1e9, hi = -1e9;
    for (int v : p.vertices) lo = std::min(lo, mesh.points[v].z()), hi = std::max(hi, mesh.points[v].z());
    return hi - lo;
  };
  const std::vector<Path> paths = s.candidates();
  for (const Path& p : paths)
    if (turns_around_axis(s.mesh, p) != 0 && height_range(s.mesh, p) > worst)
      worst = height_range(s.mesh, p), parallel = &p;
  ASSERT_NE(parallel, nullptr);
  std::vector<int> chain = parallel->vertices;
  chain.push_back(chain.front());
  SurfaceMesh mesh = s.mesh;
  smooth(mesh, edges_of(mesh, {chain}));
  EXPECT_LT(height_range(mesh, *parallel), 0.7 * worst);
  for (int v : chain) EXPECT_LT(tree.closest(mesh.points[v]).squared_distance, 1e-20);
  expect_no_flip_nor_sliver(s.mesh, mesh);
}

TEST(SmoothPaths, StraightensBothPathsOfACrossing) {
  const int n = 16;
  const SurfaceMesh before = build(shapes::plane(n, n));
  SurfaceMesh mesh = before;
  // Two zigzags of amplitude one that cross at the centre.
  std::vector<int> a, b;
  for (int i = 0; i <= n; ++i) a.push_back((8 + (i % 4 == 1 ? 1 : 0)) * (n + 1) + i);
  for (int j = 0; j <= n; ++j) b.push_back(j * (n + 1) + 8 + (j % 4 == 3 ? 1 : 0));
  std::vector<char> path(mesh.edges.size(), 0);
  const auto mark = [&](const std::vector<int>& c) {
    for (std::size_t i = 0; i + 1 < c.size(); ++i) {
      const int e = mesh.find_edge(c[i], c[i + 1]);
      if (e < 0) return false;
      path[e] = 1;
    }
    return true;
  };
  ASSERT_TRUE(mark(a));
  ASSERT_TRUE(mark(b));
  smooth(mesh, path);
  EXPECT_LT(turning(mesh, a), 0.2 * turning(before, a));
  EXPECT_LT(turning(mesh, b), 0.2 * turning(before, b));
  expect_no_flip_nor_sliver(before, mesh);
}

TEST(SmoothPaths, AStemDoesNotBendItsBar) {
  const int n = 12;
  const SurfaceMesh before = build(shapes::plane(n, n));
  SurfaceMesh mesh = before;
  std::vector<int> bar, stem;
  for (int i = 0; i <= n; ++i) bar.push_back(6 * (n + 1) + i);
  for (int j = 6; j <= n; ++j) stem.push_back(j * (n + 1) + 6);
  smooth(mesh, edges_of(mesh, {bar, stem}));
  for (int v : bar) EXPECT_EQ(mesh.points[v], before.points[v]);
}

TEST(SmoothPaths, IsRepeatableFromTheRestPositions) {
  const TracedShape s(shapes::sphere(20));
  SurfaceMesh mesh = s.mesh;
  std::vector<char> path(mesh.edges.size(), 0);
  const std::vector<Path> paths = s.candidates();
  ASSERT_FALSE(paths.empty());
  for (std::size_t i = 0; i < paths[0].vertices.size(); ++i)
    path[mesh.find_edge(paths[0].vertices[i], paths[0].vertices[(i + 1) % paths[0].vertices.size()])] = 1;
  SmoothParams params;
  params.rest = &s.mesh.points;
  EXPECT_FALSE(smooth(mesh, path, params, &s.mesh).empty());
  const SurfaceMesh once = mesh;
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(smooth(mesh, path, params, &s.mesh).empty());
  EXPECT_EQ(mesh.points, once.points);
}

TEST(SmoothPaths, VerticesGoBackWhenTheirPathIsGone) {
  const int n = 16;
  const SurfaceMesh rest = build(shapes::plane(n, n));
  SurfaceMesh mesh = rest;
  SmoothParams params;
  params.rest = &rest.points;
  const std::vector<int> there = smooth(mesh, edges_of(mesh, {staircase(n)}), params, &rest);
  EXPECT_FALSE(there.empty());
  EXPECT_EQ(smooth(mesh, edges_of(mesh, {}), params, &rest), there);
  for (int v = 0; v < mesh.vertex_count(); ++v) EXPECT_LT((mesh.points[v] - rest.points[v]).norm(), 0.02);
}

TEST(SmoothPaths, NeverFlipsNorMakesSlivers) {
  // Crude on purpose: few, large, uneven triangles, all candidate paths at once.
  for (const TriangleSoup& soup :
       {shapes::torus(16, 7, 1, 0.4), shapes::sphere(5), shapes::helicoid(10, 7, 1, 1, 1)}) {
    const TracedShape s(soup);
    SurfaceMesh mesh = s.mesh;
    std::vector<char> path(mesh.edges.size(), 0);
    for (const Path& p : s.candidates())
      for (std::size_t i = 0; i + 1 < p.vertices.size(); i += 2)
        path[mesh.find_edge(p.vertices[i], p.vertices[i + 1])] = 1;
    smooth(mesh, path, {}, &s.mesh);
    expect_no_flip_nor_sliver(s.mesh, mesh);
  }
}

// A staircase over hills, each one vertex high.
TEST(SmoothPaths, LeavesNoTipBehind) {
  const int n = 16;
  const double height = 0.02, most = 0.004;  // edges are 1/16 long
  TriangleSoup soup = shapes::plane(n, n);
  for (Vector3& p : soup.points) p /= n;
  const std::vector<int> chain = staircase(n);
  for (std::size_t i = 3; i + 3 < chain.size(); i += 4) soup.points[chain[i]].z() = height;
  const SurfaceMesh rest = build(soup);
  const auto farthest_left = [&](const SurfaceMesh& mesh) {
    const ClosestPointTree tree(mesh.points, mesh.faces);
    double far = 0;
    for (const Vector3& p : rest.points) far = std::max(far, std::sqrt(tree.closest(p).squared_distance));
    return far;
  };
  SmoothParams params;
  SurfaceMesh mesh = rest;
  smooth(mesh, edges_of(mesh, {chain}), params, &rest);
  EXPECT_GT(farthest_left(mesh), 2 * most) << "the test needs a path that leaves tips behind";
  mesh = rest;
  params.most_left = most;
  EXPECT_FALSE(smooth(mesh, edges_of(mesh, {chain}), params, &rest).empty());
  EXPECT_LE(farthest_left(mesh), most);
  EXPECT_LT(turning(mesh, chain), 0.9 * turning(rest, chain));
}

TEST(SmoothPaths, Cancels) {
  SurfaceMesh mesh = build(shapes::plane(8, 8));
  const std::atomic<bool> stop{true};
  RunContext context;
  context.cancelled = &stop;
  const ClosestPointTree tree(mesh.points, mesh.faces);
  const std::vector<char> fixed(mesh.points.size(), 0);
  EXPECT_THROW(smooth_paths(mesh, edges_of(mesh, {staircase(8)}), fixed, tree, {}, context), Error);
}

}  // namespace
}  // namespace sheetform
