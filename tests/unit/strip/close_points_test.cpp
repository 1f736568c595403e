#include "sheetform/strip/close_points.h"

#include <gtest/gtest.h>

#include "sheetform/strip/assemble.h"
#include "sheetform/strip/certificate.h"
#include "support/strip_shapes.h"

namespace sheetform {
namespace {

// Two tubes of which one stands on a point of the rim of the other.
StripMesh tubes_that_touch() {
  StripMesh strips = shapes::tube(24);
  StripMesh other = strips;
  const Vector3 touch = strips.points[strips.patches[0].boundary[0]];
  double high = -1e300, low = 1e300;
  for (const Vector3& p : strips.points) high = std::max(high, p.z()), low = std::min(low, p.z());
  const Vector3 step(0, 0, touch.z() == low ? low - high : high - low);
  for (Vector3& p : other.points) p += step;
  // Turned half around, so that a single point is in one place with one of the first.
  for (Vector3& p : other.points) p = Vector3(2 * touch.x() - p.x(), 2 * touch.y() - p.y(), p.z());
  append(strips, other, 1);
  return strips;
}

std::size_t in_one_place(const StripMesh& strips, double distance) {
  std::vector<int> all;
  for (int i = 0; i < static_cast<int>(strips.points.size()); ++i) all.push_back(i);
  return close_points(strips.points, all, distance).size();
}

TEST(ClosePoints, AreToldInPairs) {
  const std::vector<Vector3> points{{0, 0, 0}, {1, 0, 0}, {0, 0, 1e-9}, {1, 0, 2e-3}, {0, 1e-9, 0}};
  const auto found = close_points(points, {0, 1, 2, 3, 4}, 1e-6);
  ASSERT_EQ(found.size(), 3u);
  for (const auto& [a, b] : found) EXPECT_TRUE(a % 2 == 0 && b % 2 == 0 && a != b) << a << " " << b;
  EXPECT_EQ(close_points(points, {0, 1, 3}, 1e-6).size(), 0u);
  EXPECT_EQ(close_points(points, {1, 3}, 1e-2).size(), 1u);
}

TEST(ClosePoints, OfTwoSurfacesArePartedAndThePatchesUnfoldedAnew) {
  StripMesh strips = tubes_that_touch();
  ASSERT_EQ(in_one_place(strips, 1e-9), 1u);
  ASSERT_FALSE(check_structure(strips, nullptr, 6, 1).empty());
  const std::vector<Vector3> before = strips.points;
  part_close_points(strips, 1);
  EXPECT_EQ(in_one_place(strips, 5e-7), 0u);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_LT((strips.points[i] - before[i]).norm(), 3e-6);
  for (const Defect& d : check_structure(strips, nullptr, 6, 1)) ADD_FAILURE() << d.check << " " << d.text;
}

TEST(ClosePoints, WhatIsApartStaysAsItIs) {
  StripMesh strips = shapes::torus_bands(6, 24);
  const StripMesh before = strips;
  part_close_points(strips, 1);
  EXPECT_EQ(strips.points, before.points);
  EXPECT_EQ(strips.uvs, before.uvs);
}

}  // namespace
}  // namespace sheetform
