// The last smoothing of seams.
#include "sheetform/search/fair_outlines.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace sheetform {
namespace {

constexpr int kPoints = 41;

// A stretch of a circle, every other point off it by so much, but for the ends.
std::vector<Vector3> zigzag_arc(double height, double radius = 0.5, double angle = 1) {
  std::vector<Vector3> line;
  for (int i = 0; i < kPoints; ++i) {
    const bool end = i == 0 || i == kPoints - 1;
    const double r = radius + (end ? 0 : i % 2 == 0 ? height : -height), a = angle * i / (kPoints - 1);
    line.emplace_back(r * std::cos(a), r * std::sin(a), 0.1 * a);
  }
  return line;
}

double off_circle(const std::vector<Vector3>& line, double radius = 0.5) {
  double worst = 0;
  for (const Vector3& p : line) worst = std::max(worst, std::abs(p.head<2>().norm() - radius));
  return worst;
}

double turning(const std::vector<Vector3>& line) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < line.size(); ++i)
    sum += angle_between(line[i] - line[i - 1], line[i + 1] - line[i]);
  return sum;
}

const std::vector<double> kEven(kPoints, 1);

TEST(Faired, ZigzagGoesAndTheArcStays) {
  const std::vector<Vector3> rough = zigzag_arc(0.004), fair = faired(rough, 0.2, kEven);
  EXPECT_GT(turning(rough), 10);
  EXPECT_NEAR(turning(fair), 1, 0.1);
  EXPECT_LT(off_circle(fair), 0.0006);
  EXPECT_EQ(fair.front(), rough.front());
  EXPECT_EQ(fair.back(), rough.back());
}

TEST(Faired, SmoothCurvesStay) {
  const std::vector<Vector3> arc = zigzag_arc(0), fair = faired(arc, 0.2, kEven);
  for (int i = 0; i < kPoints; ++i) EXPECT_LT((fair[i] - arc[i]).norm(), 1e-4);
}

TEST(Faired, ShortLinesAndNoWavelengthChangeNothing) {
  const std::vector<Vector3> rough = zigzag_arc(0.01), three(rough.begin(), rough.begin() + 3);
  EXPECT_EQ(faired(rough, 0, kEven), rough);
  EXPECT_EQ(faired(three, 0.2, {1, 1, 1}), three);
}

TEST(Faired, AHeavyPointStaysCloser) {
  const std::vector<Vector3> rough = zigzag_arc(0.004);
  std::vector<double> weight = kEven;
  weight[20] = 1e4;
  const double free = (faired(rough, 0.2, kEven)[20] - rough[20]).norm(),
               held = (faired(rough, 0.2, weight)[20] - rough[20]).norm();
  EXPECT_GT(free, 0.003);
  EXPECT_LT(held, 0.1 * free);
}

// Two strips side by side with a zigzag seam between them.
StripSource two_strips(double height) {
  constexpr int n = 21;
  StripSource source;
  for (int row = 0; row < 3; ++row)
    for (int i = 0; i < n; ++i) {
      const bool inside = row == 1 && i > 0 && i < n - 1;
      const double y = 0.2 * row + (inside ? (i % 2 == 0 ? height : -height) : 0);
      source.points.emplace_back(0.02 * i, y, 0);
    }
  const auto row = [](int r) {
    std::vector<int> ids(n);
    std::iota(ids.begin(), ids.end(), r * n);
    return ids;
  };
  for (int p = 0; p < 2; ++p) {
    StripSource::Patch patch;
    patch.outline = row(p);
    const std::vector<int> above = row(p + 1);
    patch.outline.insert(patch.outline.end(), above.rbegin(), above.rend());
    for (int i = 0; i + 1 < n; ++i) {
      patch.triangles.push_back({i, i + 1, 2 * n - 1 - i});
      patch.triangles.push_back({i + 1, 2 * n - 2 - i, 2 * n - 1 - i});
    }
    patch.arches = {p, p + 1};
    source.patches.push_back(patch);
  }
  for (int r = 0; r < 3; ++r) source.arches.push_back({row(r), {r == 2 ? 1 : 0, r == 1 ? 1 : -1}});
  return source;
}

bool anywhere(const Vector3&, const Vector3&) { return true; }

TEST(OutlineFairing, MovesTheSeamAndNothingElse) {
  const StripSource source = two_strips(0.004);
  const std::vector<Vector3> fair = OutlineFairing(source, {0, 1, 0}, anywhere).places();
  for (int i = 0; i < 63; ++i) {
    if (i > 21 && i < 41) {
      EXPECT_NEAR(fair[i].y(), 0.2, 0.001);
    } else {
      EXPECT_EQ(fair[i], source.points[i]);
    }
  }
  EXPECT_EQ(OutlineFairing(source, {0, 0, 0}, anywhere).places(), source.points);
}

TEST(OutlineFairing, WhatIsHeldGoesBackUntilItStays) {
  const StripSource source = two_strips(0.004);
  OutlineFairing fairing(source, {0, 1, 0}, anywhere);
  const std::vector<Vector3> first = fairing.places();
  ASSERT_TRUE(fairing.hold({30}));
  const std::vector<Vector3> second = fairing.places();
  EXPECT_LT((second[30] - source.points[30]).norm(), 0.5 * (first[30] - source.points[30]).norm());
  EXPECT_NEAR(second[24].y(), 0.2, 0.002) << "the rest of the seam is still smooth";
  while (fairing.hold_outlines({0})) {
  }
  EXPECT_EQ(fairing.places(), source.points);
  EXPECT_FALSE(fairing.hold({30}));
}

TEST(OutlineFairing, PointsThatMayNotGoStay) {
  const StripSource source = two_strips(0.004);
  const auto only_up = [](const Vector3& from, const Vector3& to) { return to.y() >= from.y(); };
  const std::vector<Vector3> fair = OutlineFairing(source, {0, 1, 0}, only_up).places();
  int moved = 0;
  for (int i = 21; i < 42; ++i) {
    EXPECT_GE(fair[i].y(), source.points[i].y());
    moved += fair[i] != source.points[i];
  }
  EXPECT_GT(moved, 5);
}

// An ear of the seam, a triangle of three of its points, that would lie upside down on the smooth seam.
TEST(OutlineFairing, NoTriangleTurnsOver) {
  StripSource source = two_strips(0);
  for (int i = 0; i < 21; ++i) source.points[21 + i].y() += 0.5 * std::pow(0.02 * (i - 10), 2);
  source.points[31].y() += 0.004;
  const auto height = [](const std::vector<Vector3>& x) { return x[31].y() - (x[30].y() + x[32].y()) / 2; };
  const auto smoothed = [&] { return height(OutlineFairing(source, {0, 1, 0}, anywhere).places()); };
  EXPECT_LT(smoothed(), 0);
  // By places in the outline of the upper patch, which begins with the seam.
  source.patches[1].triangles.push_back({11, 10, 9});
  EXPECT_GT(smoothed(), 0);
  EXPECT_LE(smoothed(), height(source.points));
}

}  // namespace
}  // namespace sheetform
