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
  flatten(c.faces, {}, {}, 2e-3, c.points);
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
  flatten({c.faces[0]}, {}, {}, 1e-5, c.points);
  EXPECT_EQ(c.points, before);
}

TEST(Flatten, PointsOnThePlaneOfSymmetryStayThere) {
  Cube c = cube(6);
  std::vector<char> on_plane(c.points.size(), 0);
  for (int i : c.faces[0]) on_plane[i] = 1;
  shake(1e-3, c.points);
  for (int i : c.faces[0]) c.points[i].x() = 0;
  const std::vector<std::vector<int>> around(c.faces.begin() + 2, c.faces.end());
  flatten(around, {}, on_plane, 2e-3, c.points);
  for (int i : c.faces[0]) EXPECT_EQ(c.points[i].x(), 0);
  for (const auto& face : around) EXPECT_LT(unevenness(face, c.points), 1e-9);
}

// A roof of two faces, and between them a chamfer that is far narrower than the slack and ends in a point:
// all of it is as good as on either face.
TEST(Flatten, SliversBetweenTwoPlanesKeepTheirArea) {
  std::vector<Vector3> points;
  const int n = 12;
  const double width = 1e-4;
  const auto row = [&](const auto& at) {
    std::vector<int> ids;
    for (int i = 0; i <= n; ++i)
      ids.push_back(static_cast<int>(points.size())), points.push_back(at(double(i) / n));
    return ids;
  };
  const auto narrow = [&](double t) { return width * t; };
  const std::vector<int> left = row([&](double t) { return Vector3(t, -narrow(t), -narrow(t)); });
  std::vector<int> right = row([&](double t) { return Vector3(t, narrow(t), -narrow(t)); });
  const std::vector<int> down_left = row([](double t) { return Vector3(t, -1, -1); });
  const std::vector<int> down_right = row([](double t) { return Vector3(t, 1, -1); });
  right[0] = left[0];
  std::vector<std::vector<int>> patches{left, right, left};
  patches[0].insert(patches[0].end(), down_left.begin(), down_left.end());
  patches[1].insert(patches[1].end(), down_right.begin(), down_right.end());
  // The short end of the chamfer, a point in its middle, belongs to the face on the left as well.
  const int end = static_cast<int>(points.size());
  points.emplace_back(1, 0, -width);
  patches[0].insert(patches[0].end(), {end, right.back()});
  patches[2].push_back(end);
  patches[2].insert(patches[2].end(), right.begin() + 1, right.end());
  std::vector<std::array<int, 3>> triangles;
  for (int i = 1; i + 1 < n; ++i) {
    triangles.push_back({left[i], left[i + 1], right[i + 1]});
    triangles.push_back({left[i], right[i + 1], right[i]});
  }
  triangles.push_back({left[0], left[1], right[1]});
  triangles.push_back({left[n - 1], left[n], end});
  triangles.push_back({left[n - 1], end, right[n - 1]});
  triangles.push_back({right[n - 1], end, right[n]});
  const auto area2 = [&](const std::array<int, 3>& t) {
    return (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).norm();
  };
  std::vector<double> before;
  for (const auto& t : triangles) before.push_back(area2(t));
  flatten(patches, triangles, {}, 2e-3, points);
  for (std::size_t k = 0; k < triangles.size(); ++k) EXPECT_GT(area2(triangles[k]), 0.05 * before[k]) << k;
  EXPECT_LT(unevenness(down_left, points), 1e-9);
}

}  // namespace
}  // namespace sheetform
