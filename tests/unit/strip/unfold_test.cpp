#include "sheetform/strip/unfold.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "sheetform/strip/outline.h"
#include "support/shapes.h"

namespace sheetform {
namespace {

using Triangles = std::vector<std::array<int, 3>>;

double worst_edge(const std::vector<Vector3>& points, const Triangles& triangles,
                  const std::vector<Vector2>& flat) {
  double worst = 0;
  for (const auto& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      worst = std::max(worst, std::abs((flat[a] - flat[b]).norm() - (points[a] - points[b]).norm()));
    }
  return worst;
}

void expect_counter_clockwise(const Triangles& triangles, const std::vector<Vector2>& flat) {
  for (const auto& t : triangles) EXPECT_GT(signed_area({flat[t[0]], flat[t[1]], flat[t[2]]}), 0);
}

// Points of two polylines in turn, triangles between them.
Triangles zigzag(int points) {
  Triangles t;
  for (int i = 0; i + 2 < points; ++i)
    t.push_back(i % 2 ? std::array{i + 1, i, i + 2} : std::array{i, i + 1, i + 2});
  return t;
}

TEST(Unfold, KeepsLengthsOfRandomStrips) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> u(-0.3, 0.3);
  for (int trial = 0; trial < 30; ++trial) {
    std::vector<Vector3> points;
    for (int i = 0; i < 200; ++i)
      points.emplace_back(0.5 * i + u(random), (i % 2) + u(random), 3 * u(random));
    Triangles triangles = zigzag(200);
    std::shuffle(triangles.begin(), triangles.end(), random);  // any order, as long as they hang together
    const std::vector<Vector2> flat = unfold(points, triangles);
    EXPECT_LT(worst_edge(points, triangles, flat), 1e-12 * 100);
    expect_counter_clockwise(triangles, flat);
  }
}

TEST(Unfold, RollsACylinderOutToItsCircumference) {
  const int n = 60;
  std::vector<Vector3> points;
  for (int i = 0; i <= n; ++i)
    for (int side = 0; side < 2; ++side)
      points.emplace_back(std::cos(2 * shapes::kPi * i / n), std::sin(2 * shapes::kPi * i / n),
                          3.0 * (1 - side));
  const std::vector<Vector2> flat = unfold(points, zigzag(2 * n + 2));
  const double around = n * 2 * std::sin(shapes::kPi / n);
  EXPECT_NEAR((flat[0] - flat[2 * n]).norm(), around, 1e-11);
  EXPECT_NEAR((flat[1] - flat[2 * n + 1]).norm(), around, 1e-11);
  EXPECT_NEAR((flat[0] - flat[2 * n + 1]).norm(), std::hypot(around, 3), 1e-11);
}

TEST(Unfold, ConeOpensToItsSector) {
  // Slant 1, half angle 30 degrees: the sector has half of a full turn.
  const int n = 200;
  std::vector<Vector3> points{{0, 0, std::sqrt(3) / 2}};
  Triangles triangles;
  for (int i = 0; i <= n; ++i) {
    points.emplace_back(0.5 * std::cos(2 * shapes::kPi * i / n), 0.5 * std::sin(2 * shapes::kPi * i / n), 0);
    if (i > 0) triangles.push_back({0, i, i + 1});
  }
  const std::vector<Vector2> flat = unfold(points, triangles);
  const Vector2 a = flat[1] - flat[0], b = flat[n + 1] - flat[0];
  EXPECT_NEAR(a.norm(), 1, 1e-12);
  EXPECT_NEAR(b.norm(), 1, 1e-12);
  EXPECT_NEAR(std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b))), shapes::kPi, 0.001);
}

TEST(Unfold, FlatStripsStayAsTheyAre) {
  std::vector<Vector3> points;
  for (int i = 0; i < 12; ++i) points.emplace_back(0.7 * i, i % 2 ? -1 : 0.2 * i, 0);
  const Triangles triangles = zigzag(12);
  const std::vector<Vector2> flat = unfold(points, triangles);
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < i; ++j)
      EXPECT_NEAR((flat[i] - flat[j]).norm(), (points[i] - points[j]).norm(), 1e-12);
}

TEST(Unfold, TreesThatBranchUnfoldToo) {
  const std::vector<Vector3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1}, {-1, 1, 1}, {1, -1, 1}};
  const Triangles triangles{{0, 1, 2}, {2, 1, 3}, {0, 2, 4}, {1, 0, 5}};
  const std::vector<Vector2> flat = unfold(points, triangles);
  EXPECT_LT(worst_edge(points, triangles, flat), 1e-15);
  expect_counter_clockwise(triangles, flat);
}

TEST(Unfold, KeepsLengthsAtEveryScale) {
  for (double scale : {1e-6, 1.0, 1e6}) {
    std::vector<Vector3> points;
    for (int i = 0; i < 60; ++i)
      points.push_back(scale * Vector3(std::cos(0.1 * i), std::sin(0.1 * i) + (i % 2 ? -0.5 : 0), 0.05 * i));
    const Triangles triangles = zigzag(60);
    EXPECT_LT(worst_edge(points, triangles, unfold(points, triangles)), 1e-13 * scale);
  }
}

// ---- outlines
// ------------------------------------------------------------------------------------------------------

std::vector<Vector2> ring_strip(double turn, double width, int n) {
  // A flat ring of this turn, inner radius 1: it meets itself beyond 2 pi.
  std::vector<Vector2> outline;
  for (int i = 0; i <= n; ++i)
    outline.emplace_back((1 + width) * std::cos(turn * i / n), (1 + width) * std::sin(turn * i / n));
  for (int i = n; i >= 0; --i) outline.emplace_back(std::cos(turn * i / n), std::sin(turn * i / n));
  return outline;
}

TEST(SimpleOutline, AcceptsOutlinesThatKeepClear) {
  EXPECT_TRUE(simple_outline({{0, 0}, {1, 0}, {0, 1}}, 1e-7));
  EXPECT_TRUE(simple_outline({{0, 0}, {2, 0}, {2, 2}, {1, 0.5}, {0, 2}}, 1e-7));
  EXPECT_TRUE(simple_outline(ring_strip(6.0, 0.3, 60), 1e-7));
}

TEST(SimpleOutline, FindsOverlap) {
  EXPECT_FALSE(simple_outline(ring_strip(6.5, 0.3, 60), 1e-7));
  EXPECT_FALSE(simple_outline({{0, 0}, {1, 1}, {1, 0}, {0, 1}}, 1e-7)) << "a bow tie";
}

TEST(SimpleOutline, FindsContact) {
  // A notch whose tip comes to rest on the opposite edge.
  const auto notch = [](double tip) {
    return std::vector<Vector2>{{0, 0}, {2, 0}, {2, 1}, {1, tip}, {0, 1}};
  };
  EXPECT_TRUE(simple_outline(notch(0.01), 1e-7));
  EXPECT_FALSE(simple_outline(notch(0), 1e-7));
  EXPECT_FALSE(simple_outline(notch(1e-8), 1e-7));
  EXPECT_TRUE(simple_outline(notch(1e-6), 1e-7));
  EXPECT_FALSE(simple_outline(notch(0.01), 0.02)) << "the gap is the caller's";
  EXPECT_FALSE(simple_outline({{0, 0}, {2, 0}, {2, 2}, {1, 1}, {0, 2}, {1, 1}}, 1e-7))
      << "touches itself at a point";
}

TEST(SimpleOutline, FindsFoldedNeighbours) {
  EXPECT_FALSE(simple_outline({{0, 0}, {2, 0}, {1, 0}, {1, 1}}, 1e-7));
  EXPECT_TRUE(simple_outline({{0, 0}, {1, 0}, {2, 0}, {1, 1}}, 1e-7)) << "a straight angle is none";
}

// Against the other implementation: the certificate's own test of contact.
TEST(SimpleOutline, AgreesWithTheCertificateOnRandomOutlines) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> u(0.4, 1);
  int simple = 0, crossing = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const int n = 5 + static_cast<int>(random() % 12);
    std::vector<Vector2> outline;
    for (int i = 0; i < n; ++i) {
      const double a = 2 * shapes::kPi * (i + (trial % 2 ? 6.0 : 0.4) * (u(random) - 0.7)) / n;
      outline.push_back(u(random) * Vector2(std::cos(a), std::sin(a)));
    }
    const bool free = self_contact(outline, 1e-7).i < 0;
    (free ? simple : crossing)++;
    EXPECT_EQ(simple_outline(outline, 1e-7), free) << trial;
  }
  EXPECT_GT(simple, 50);
  EXPECT_GT(crossing, 50);
}

}  // namespace
}  // namespace sheetform
