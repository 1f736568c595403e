#include "sheetform/mesh/closest_point.h"

#include <gtest/gtest.h>

#include <random>

#include "support/shapes.h"

namespace sheetform {
namespace {

double distance2_to_segment(const Vector3& q, const Vector3& a, const Vector3& b) {
  const Vector3 d = b - a;
  const double t = d.squaredNorm() > 0 ? std::clamp((q - a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
  return (q - a - t * d).squaredNorm();
}

// Independent of the tree's method: the plane's foot point when it lies inside, else the nearest side.
double distance2_to_triangle(const Vector3& q, const Vector3& a, const Vector3& b, const Vector3& c) {
  double best =
      std::min({distance2_to_segment(q, a, b), distance2_to_segment(q, b, c), distance2_to_segment(q, c, a)});
  const Vector3 n = (b - a).cross(c - a);
  if (n.squaredNorm() == 0) return best;
  const Vector3 p = q - n * (n.dot(q - a) / n.squaredNorm());
  const bool inside = n.dot((b - a).cross(p - a)) >= 0 && n.dot((c - b).cross(p - b)) >= 0 &&
                      n.dot((a - c).cross(p - c)) >= 0;
  return inside ? std::min(best, (q - p).squaredNorm()) : best;
}

double brute_force(const TriangleSoup& s, const Vector3& q) {
  double best = std::numeric_limits<double>::infinity();
  for (const auto& t : s.faces)
    best = std::min(best, distance2_to_triangle(q, s.points[t[0]], s.points[t[1]], s.points[t[2]]));
  return best;
}

void expect_same_as_brute_force(const TriangleSoup& s, double spread, int queries) {
  const ClosestPointTree tree(s.points, s.faces);
  std::mt19937_64 rng(7);
  std::uniform_real_distribution<double> uniform(-spread, spread);
  const double size = bounding_box_diagonal(s.points);
  Vector3 middle = Vector3::Zero();
  for (const Vector3& p : s.points) middle += p / static_cast<double>(s.points.size());
  for (int i = 0; i < queries; ++i) {
    const Vector3 q = middle + size * Vector3(uniform(rng), uniform(rng), uniform(rng));
    const ClosestPoint c = tree.closest(q);
    ASSERT_GE(c.face, 0);
    ASSERT_NEAR(std::sqrt(c.squared_distance), std::sqrt(brute_force(s, q)), 1e-12 * size * (1 + spread));
    const auto& t = s.faces[c.face];
    const Vector3 p = c.barycentric[0] * s.points[t[0]] + c.barycentric[1] * s.points[t[1]] +
                      c.barycentric[2] * s.points[t[2]];
    ASSERT_LT((p - c.point).norm(), 1e-12 * size);
    ASSERT_NEAR((q - c.point).squaredNorm(), c.squared_distance, 1e-12 * size * size * (1 + spread * spread));
    ASSERT_NEAR(c.barycentric.sum(), 1, 1e-12);
    ASSERT_GE(c.barycentric.minCoeff(), -1e-12);
  }
}

TEST(ClosestFrom, FindsTheNearestPointFromFacesAround) {
  const TriangleSoup soup = shapes::torus(40, 20);
  const SurfaceMesh mesh = build_surface_mesh(soup.points, soup.faces);
  const ClosestPointTree tree(soup.points, soup.faces);
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> off(-0.1, 0.1);
  for (int f = 0; f < mesh.face_count(); f += 7) {
    const Vector3 q = mesh.face_middle(f) + Vector3(off(rng), off(rng), off(rng));
    const int start = mesh.edges[mesh.face_edges[f][0]].other_face(f);
    const ClosestPoint from = closest_from(mesh, start, q), all = tree.closest(q);
    EXPECT_NEAR(from.squared_distance, all.squared_distance, 1e-15);
    const auto& t = mesh.faces[from.face];
    const Vector3 p = from.barycentric[0] * mesh.points[t[0]] + from.barycentric[1] * mesh.points[t[1]] +
                      from.barycentric[2] * mesh.points[t[2]];
    EXPECT_LT((p - from.point).norm(), 1e-12);
  }
}

TEST(ClosestFrom, StaysOnItsSideOfAThinWall) {
  const TriangleSoup soup = shapes::box(8, Vector3(1, 1, 0.01));
  const SurfaceMesh mesh = build_surface_mesh(soup.points, soup.faces);
  const ClosestPointTree tree(soup.points, soup.faces);
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Vector3 middle = mesh.face_middle(f), up = mesh.face_normal_raw(f).normalized();
    if (std::abs(up.z()) < 0.9 || std::abs(middle.x()) > 0.3 || std::abs(middle.y()) > 0.3) continue;
    const Vector3 q = middle - 0.009 * up;  // nearer to the other side
    EXPECT_LT(mesh.face_normal_raw(tree.closest(q).face).dot(up), 0);
    EXPECT_GT(mesh.face_normal_raw(closest_from(mesh, f, q).face).dot(up), 0);
  }
}

TEST(ClosestPoint, AgreesWithBruteForceNearAndFar) {
  for (const TriangleSoup& s :
       {shapes::torus(24, 12), shapes::sphere(6), shapes::box(4, {1, 2, 3}), shapes::saddle(9)}) {
    expect_same_as_brute_force(s, 0.7, 300);
    expect_same_as_brute_force(s, 50, 100);
  }
}

TEST(ClosestPoint, WorksFarFromTheOriginAndForTinyMeshes) {
  TriangleSoup far = shapes::torus(24, 12);
  for (Vector3& p : far.points) p += Vector3(1e5, -2e5, 3e5);
  const ClosestPointTree tree(far.points, far.faces);
  const Vector3 q = far.points[17] + Vector3(0.01, 0.02, 0.03);
  EXPECT_NEAR(tree.closest(q).squared_distance, brute_force(far, q), 1e-9);
  TriangleSoup tiny = shapes::torus(24, 12);
  for (Vector3& p : tiny.points) p *= 1e-20;
  expect_same_as_brute_force(tiny, 0.7, 100);
}

TEST(ClosestPoint, RandomTrianglesAndSlivers) {
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> u(-1, 1);
  TriangleSoup s;
  for (int i = 0; i < 400; ++i) {
    const Vector3 a(u(rng), u(rng), u(rng)), d(u(rng), u(rng), u(rng)), e(u(rng), u(rng), u(rng));
    const double thin = i % 4 == 0 ? 1e-13 : i % 4 == 1 ? 1e-6 : i % 4 == 2 ? 0 : 0.3;
    const int n = static_cast<int>(s.points.size());
    s.points.insert(s.points.end(), {a, a + 0.3 * d, a + 0.2 * d + thin * e});
    s.faces.push_back({n, n + 1, n + 2});
  }
  expect_same_as_brute_force(s, 0.6, 500);
}

TEST(ClosestPoint, DegenerateTrianglesArePointsAndSegments) {
  TriangleSoup s;
  s.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 5, 5}};
  s.faces = {{0, 1, 2}, {3, 3, 3}};
  const ClosestPointTree tree(s.points, s.faces);
  EXPECT_NEAR(tree.closest({1.5, 2, 0}).squared_distance, 4, 1e-14);
  EXPECT_EQ(tree.closest({5, 5, 6}).face, 1);
  EXPECT_NEAR(tree.closest({5, 5, 6}).squared_distance, 1, 1e-14);
}

TEST(ClosestPoint, BoundAndEmptyAndNotFinite) {
  const TriangleSoup s = shapes::sphere(4);
  const ClosestPointTree tree(s.points, s.faces);
  EXPECT_EQ(tree.closest({3, 0, 0}, 3.9).face, -1);
  EXPECT_GE(tree.closest({3, 0, 0}, 4.1).face, 0);
  EXPECT_EQ(tree.closest({std::nan(""), 0, 0}).face, -1);
  EXPECT_EQ(ClosestPointTree().closest({0, 0, 0}).face, -1);
  EXPECT_TRUE(ClosestPointTree({}, {}).empty());
}

TEST(ClosestPoint, TiesGoToTheLowerFaceWhateverTheTree) {
  // All faces of a box are at the same distance from its centre; every triangle is doubled with a higher id.
  TriangleSoup s = shapes::box(5, {2, 2, 2});
  const int n = static_cast<int>(s.faces.size());
  for (int f = n - 1; f >= 0; --f) s.faces.push_back(s.faces[f]);
  const ClosestPointTree tree(s.points, s.faces);
  const ClosestPoint c = tree.closest({0, 0, 0});
  EXPECT_NEAR(c.squared_distance, 1, 1e-15);
  int lowest = -1;
  for (int f = 2 * n - 1; f >= 0; --f) {
    const TriangleSoup one{s.points, {s.faces[f]}};
    if (ClosestPointTree(one.points, one.faces).closest({0, 0, 0}).squared_distance == c.squared_distance)
      lowest = f;
  }
  EXPECT_EQ(c.face, lowest);
}

TEST(ClosestPoint, ManyEqualTrianglesDoNotDeepenTheTree) {
  TriangleSoup s{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}};
  s.faces.assign(5000, {0, 1, 2});
  const ClosestPointTree tree(s.points, s.faces);
  EXPECT_EQ(tree.closest({0.2, 0.2, 1}).face, 0);
}

}  // namespace
}  // namespace sheetform
