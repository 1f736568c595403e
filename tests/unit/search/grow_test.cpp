// Patches that are too small to handle.
#include <gtest/gtest.h>

#include <algorithm>

#include "unit/search/drawn_surface.h"

namespace sheetform {
namespace {

using shapes::Drawing;
using shapes::drawn;

// Thirty times twelve cells of A and C side by side, and one cell of B: 0.28 % of the surface.
std::string sheet(int b_column, int b_row, int seam) {
  std::string rows;
  for (int y = 0; y < 12; ++y) {
    if (y > 0) rows += '/';
    for (int x = 0; x < 30; ++x) rows += x == b_column && y == b_row ? 'B' : x < seam ? 'A' : 'C';
  }
  return rows;
}

Drawing cornered() { return drawn(sheet(0, 0, 30), bent(0.03, 2, 0.05)); }

double share_of_smallest(LayoutSearch& search) {
  double least = 1e9, sum = 0;
  for (const Patch& p : search.layout().patches) least = std::min(least, p.area), sum += p.area;
  return least / sum;
}

TEST(GrowSlight, ACornerTakesWhatItLacksFromItsNeighbour) {
  const Drawing d = cornered();
  Begun s(d, 0.05);
  ASSERT_EQ(s.search->layout().patches.size(), 2u);
  ASSERT_LT(share_of_smallest(*s.search), 0.003);
  EXPECT_EQ(s.search->grow_slight(), 1);
  EXPECT_EQ(s.search->layout().patches.size(), 2u);
  EXPECT_GT(share_of_smallest(*s.search), 0.003);
  EXPECT_LT(share_of_smallest(*s.search), 0.01) << "no more than it needs";
  expect_viable(*s.search, 0.05);
  EXPECT_EQ(s.search->grow_slight(), 0);
}

// A bite out of the border leaves the neighbour two corners more.
TEST(GrowSlight, WhereGrowingLeavesTooManyCornersBothAreCutAnew) {
  const Drawing d = drawn(sheet(15, 0, 30), bent(0.03, 2, 0.05));
  EvaluationParams params = evaluation_params(0.05);
  params.max_sides = 5;
  Begun s(d, params);
  ASSERT_EQ(s.search->layout().patches.size(), 2u);
  EXPECT_EQ(s.search->grow_slight(), 1);
  EXPECT_EQ(s.search->layout().patches.size(), 2u);
  EXPECT_GT(share_of_smallest(*s.search), 0.02);
  expect_viable(*s.search, 0.05, 5);
}

TEST(GrowSlight, NothingIsTakenAcrossACrease) {
  Drawing d = cornered();
  const int path = d.network.add_path(PathKind::kCrease);
  for (const std::vector<int>& line : {d.line(1, 0, 1, 1), d.line(0, 1, 1, 1)})
    for (int e : line) d.network.edge_path[e] = path;
  Begun s(d, 0.05);
  EXPECT_EQ(s.search->grow_slight(), 0);
  EXPECT_LT(share_of_smallest(*s.search), 0.003);
}

TEST(GrowSlight, WhatStripsLoseOfAPatchCounts) {
  const Drawing d = drawn("BAAAAAAAAA/AAAAAAAAAA", bent(0.05, 6, 0.1));
  Begun s(d, 0.05);
  ASSERT_EQ(s.search->layout().patches.size(), 2u);
  EXPECT_EQ(s.search->grow_slight(), 0) << "a twentieth of the surface";
  std::vector<double> areas;
  for (const Patch& p : s.search->layout().patches) areas.push_back(p.area < 0.05 ? 0.05 * p.area : p.area);
  s.search->know_strip_areas(areas);
  EXPECT_EQ(s.search->grow_slight(), 1);
  EXPECT_GT(share_of_smallest(*s.search), 0.06);
}

TEST(GrowSlight, GoesAltogetherInTheEnd) {
  const Drawing d = cornered();
  Begun s(d, 0.05);
  EXPECT_EQ(s.search->grow_slight(1.1), 1);
  EXPECT_EQ(s.search->layout().patches.size(), 1u);
  expect_viable(*s.search, 0.05);
}

TEST(GrowSlight, IsTheSameForAnyNumberOfThreads) {
  std::vector<std::vector<int>> networks;
  for (int threads : {1, 3}) {
    const Drawing d = drawn(sheet(15, 6, 15), bent(0.03, 2, 0.05));
    Begun s(d, 0.05);
    s.bed.context.threads = threads;
    EXPECT_EQ(s.search->grow_slight(), 1);
    networks.push_back(s.network().edge_path);
  }
  EXPECT_EQ(networks[0], networks[1]);
}

}  // namespace
}  // namespace sheetform
