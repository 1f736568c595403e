#include "sheetform/search/spacing.h"

#include <gtest/gtest.h>

#include <random>

namespace sheetform {
namespace {

TEST(Spacing, WithoutBoundsTheWantedOneIsTaken) {
  EXPECT_EQ(SpacingBounds{}.divide(1, 0.3), 0.3);
  EXPECT_FALSE(SpacingBounds{}.any());
}

TEST(Spacing, EveryLengthAboveTheLeastIsDividedWithinBounds) {
  std::mt19937 random(5);
  for (int i = 0; i < 2000; ++i) {
    std::uniform_real_distribution<double> unit(0.01, 1);
    SpacingBounds bounds;
    bounds.least = 0.1 * unit(random), bounds.most = bounds.least * (2 + 5 * unit(random));
    const double length = bounds.least * (1 + 40 * unit(random)), wanted = unit(random);
    const double spacing = bounds.divide(length, wanted);
    EXPECT_NEAR(std::round(length / spacing), length / spacing, 1e-9);
    EXPECT_LE(spacing, bounds.most * (1 + 1e-12));
    EXPECT_GE(spacing, bounds.least * (1 - 1e-12));
  }
}

TEST(Spacing, TheNearestDivisionIsTaken) {
  SpacingBounds bounds;
  bounds.most = 0.25;
  EXPECT_DOUBLE_EQ(bounds.divide(1, 0.1), 0.1);
  EXPECT_DOUBLE_EQ(bounds.divide(1, 0.6), 0.25);
  EXPECT_DOUBLE_EQ(bounds.divide(1.01, 0.6), 1.01 / 5);
}

// Points along x as one arch.
StripMesh chain(const std::vector<double>& at, bool closed = false) {
  StripMesh strips;
  StripMesh::Arch arch;
  for (double x : at)
    arch.vertices.push_back(static_cast<int>(strips.points.size())), strips.points.emplace_back(x, 0, 0);
  if (closed) arch.vertices.push_back(0);
  arch.patches = {0, 1};
  strips.arches.push_back(arch);
  return strips;
}

TEST(Spacing, MissesAreFactorsWithTheirPlace) {
  SpacingBounds bounds;
  bounds.least = 0.5, bounds.most = 1;
  const SpacingMiss miss = spacing_miss(chain({0, 1, 2.5, 2.75}), bounds);
  EXPECT_DOUBLE_EQ(miss.over, 1.5);
  EXPECT_EQ(miss.over_place, Vector3(1.75, 0, 0));
  EXPECT_DOUBLE_EQ(miss.under, 2);
  EXPECT_EQ(miss.under_place, Vector3(2.625, 0, 0));
  EXPECT_TRUE(miss.any());
  EXPECT_FALSE(spacing_miss(chain({0, 1, 1.5, 2.25}), bounds).any());
  const SpacingBounds tighter = tightened(bounds, miss);
  EXPECT_LT(tighter.most, 1 / 1.5);
  EXPECT_GT(tighter.least, 1);
}

TEST(Spacing, WhatCannotBeCoarserMayBeShort) {
  SpacingBounds bounds;
  bounds.least = 0.5;
  EXPECT_FALSE(spacing_miss(chain({0, 0.1, 0.2}), bounds).any());
  EXPECT_TRUE(spacing_miss(chain({0, 0.1, 0.2, 0.3}), bounds).any());
  EXPECT_FALSE(spacing_miss(chain({0, 0.1, 0.2, 0.3, 0.2, 0.1}, true), bounds).any());
}

}  // namespace
}  // namespace sheetform
