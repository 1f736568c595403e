#include "sheetform/search/flatten.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace sheetform {
namespace {

// Points on the faces of a unit cube, n x n each, shared along edges and at corners.
struct Cube {
  std::vector<Vector3> points;
  std::vector<std::vector<int>> faces{6};
};

Cube cube(int n) {
  Cube c;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j)
      for (int k = 0; k <= n; ++k) {
        const std::array<int, 3> at{i, j, k};
        bool used = false;
        for (int axis = 0; axis < 3; ++axis)
          for (int side : {0, 1})
            if (at[axis] == side * n)
              c.faces[2 * axis + side].push_back(static_cast<int>(c.points.size())), used = true;
        if (used) c.points.emplace_back(double(i) / n, double(j) / n, double(k) / n);
      }
  return c;
}

void shake(double by, std::vector<Vector3>& points) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-by, by);
  for (Vector3& p : points) p += Vector3(unit(random), unit(random), unit(random));
}

// How far points are from the plane through three of them that are far apart.
double unevenness(const std::vector<int>& face, const std::vector<Vector3>& points) {
  const Vector3 a = points[face[0]], b = points[face[face.size() / 2 + 1]], c = points[face.back()];
  Vector3 best = (b - a).cross(c - a);
  for (int i : face)
    if (const Vector3 n = (points[i] - a).cross(c - a); n.norm() > best.norm()) best = n;
  double worst = 0;
  for (int i : face) worst = std::max(worst, std::abs(best.normalized().dot(points[i] - a)));
  return worst;
}

TEST(Flatten, FacesThatShareTheirEdgesBecomePlanesThatMeet) {
  Cube c = cube(6);
  const std::vector<Vector3> exact = c.points;
  shake(1e-3, c.points);
  const std::vector<Vector3> shaken = c.points;
  flatten(c.faces, {}, 2e-3, c.points);
  for (const auto& face : c.faces) EXPECT_LT(unevenness(face, c.points), 1e-9);
  for (std::size_t i = 0; i < exact.size(); ++i) {
    EXPECT_LT((c.points[i] - shaken[i]).norm(), 4e-3);
    EXPECT_LT((c.points[i] - exact[i]).norm(), 4e-3);
  }
}

TEST(Flatten, WhatIsNoPlaneStaysAsItIs) {
  Cube c = cube(6);
  shake(1e-3, c.points);
  const std::vector<Vector3> before = c.points;
  flatten({c.faces[0]}, {}, 1e-5, c.points);
  EXPECT_EQ(c.points, before);
}

TEST(Flatten, PointsOnThePlaneOfSymmetryStayThere) {
  Cube c = cube(6);
  std::vector<char> on_plane(c.points.size(), 0);
  for (int i : c.faces[0]) on_plane[i] = 1;
  shake(1e-3, c.points);
  for (int i : c.faces[0]) c.points[i].x() = 0;
  const std::vector<std::vector<int>> around(c.faces.begin() + 2, c.faces.end());
  flatten(around, on_plane, 2e-3, c.points);
  for (int i : c.faces[0]) EXPECT_EQ(c.points[i].x(), 0);
  for (const auto& face : around) EXPECT_LT(unevenness(face, c.points), 1e-9);
}

}  // namespace
}  // namespace sheetform
