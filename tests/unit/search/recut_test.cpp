// Neighbours that are cut anew along a straight line: two for a shorter seam, three to become two.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sheetform/search/split.h"
#include "unit/search/drawn_surface.h"

namespace sheetform {
namespace {

using shapes::Drawing;
using shapes::drawn;

constexpr double kCell = 0.2;
const char* const kSlanted = "AAAAAABBB/AAAAABBBB/AABBBBBBB";

double seam_length(LayoutSearch& search) {
  double length = 0;
  for (const Arch& arch : search.layout().arches)
    if (arch.left >= 0 && arch.right >= 0) length += arch.length;
  return length;
}

TEST(ShortenSeams, AreStraightAcrossWhereTheyWereSlanted) {
  const Drawing d = drawn(kSlanted, bent(0.1));
  Begun s(d, 0.05);
  LayoutSearch& search = *s.search;
  ASSERT_GT(seam_length(search), 1.5 * 3 * kCell);
  EXPECT_EQ(search.shorten_seams(), 1);
  EXPECT_EQ(search.layout().patches.size(), 2u);
  EXPECT_LT(seam_length(search), 1.03 * 3 * kCell);
  expect_viable(search, 0.05);
}

TEST(ShortenSeams, StayWhereNothingIsWon) {
  Begun s(drawn("AAAAABBBBB", bent(0.1)), 0.05);
  const std::vector<int> before = s.network().edge_path;
  EXPECT_EQ(s.search->shorten_seams(), 0);
  EXPECT_EQ(s.network().edge_path, before);
}

TEST(ShortenSeams, CreasesStay) {
  Drawing d = drawn(kSlanted, bent(0.1));
  const std::vector<int> crease = d.line(6, 0, 6, 1);
  make_crease(d, crease);
  Begun s(d, 0.05);
  EXPECT_EQ(s.search->shorten_seams(), 0);
  for (int e : crease) EXPECT_TRUE(s.network().used(e));
}

// On a sphere shorter cuts soon leave a part that is too round.
TEST(ShortenSeams, WhatNoLongerFitsIsUndone) {
  Searched s(shapes::sphere(12), 0.03);
  s.reduce();
  const double before = seam_length(*s.search);
  const bool changed = s.search->shorten_seams() > 0;
  expect_viable(*s.search, 0.03);
  EXPECT_EQ(seam_length(*s.search) < before, changed);
  EXPECT_LE(seam_length(*s.search), before);
}

TEST(ShortenSeams, AreTheSameForAnyNumberOfThreads) {
  expect_same_for_any_number_of_threads(0.03, [](Searched& s) {
    s.reduce();
    s.search->shorten_seams();
  });
}

TEST(MakeThreesTwo, CutsThreeInARowAnew) {
  const Drawing d = drawn("AAABBBBBCCC/AAABBBBBCCC", bent(0.1));
  Begun s(d, 0.05);
  ASSERT_EQ(s.search->layout().patches.size(), 3u);
  EXPECT_EQ(s.search->make_threes_two(), 1);
  EXPECT_EQ(s.search->layout().patches.size(), 2u);
  EXPECT_LT(seam_length(*s.search), 1.05 * 2 * kCell);  // straight across
  const double whole = surface_area(s.bed.surface.mesh);
  for (const Patch& p : s.search->layout().patches) EXPECT_GT(p.area, 0.2 * whole);
  expect_viable(*s.search, 0.05);
}

TEST(MakeThreesTwo, GoesOnUntilTwoAreLeft) {
  Begun s(drawn("AABBCCDDEE/AABBCCDDEE", bent(0.1)), 0.05);
  EXPECT_EQ(s.search->make_threes_two(), 3);
  EXPECT_EQ(s.search->layout().patches.size(), 2u);
}

TEST(MakeThreesTwo, CreasesStay) {
  Drawing d = drawn("AAABBBBBCCC/AAABBBBBCCC", bent(0.1));
  make_crease(d, d.line(3, 0, 3, 2));
  Begun s(d, 0.05);
  EXPECT_EQ(s.search->make_threes_two(), 0);
  EXPECT_EQ(s.search->layout().patches.size(), 3u);
}

TEST(MakeThreesTwo, LeavesWhatIsViableOnASphere) {
  Searched s(shapes::sphere(12), 0.03);
  s.reduce();
  const std::size_t before = s.search->layout().patches.size();
  const int gone = s.search->make_threes_two();
  EXPECT_EQ(s.search->layout().patches.size(), before - gone);
  expect_viable(*s.search, 0.03);
  EXPECT_EQ(s.search->make_threes_two(), 0);
}

TEST(MakeThreesTwo, IsTheSameForAnyNumberOfThreads) {
  expect_same_for_any_number_of_threads(0.015, [](Searched& s) {
    s.search->insert();
    s.search->remove_paths();
    EXPECT_GT(s.search->make_threes_two(), 0);
  });
}

// The chart of a rectangle and the straight cuts through it.
TEST(StraightCuts, AreShortStraightAndApart) {
  const Drawing d = drawn("AAAAAA/AAAAAA", bent(0.1));
  const PatchLayout layout =
      extract_layout(d.mesh, d.network, std::vector<int>(d.mesh.points.size(), 0), LayoutRules());
  const PatchChart chart = parametrize(d.mesh, layout, layout.patches[0], {});
  const double width = 2 * kCell, area = layout.patches[0].area;
  const std::vector<StraightCut> cuts = straight_cuts(d.mesh, layout, 0, chart, 1.2 * width, 0.2 * area, 4);
  ASSERT_GE(cuts.size(), 2u);
  EXPECT_LE(cuts.size(), 4u);
  EXPECT_NEAR(cuts[0].length, width, 0.01 * width);
  double least = 0;
  for (const StraightCut& cut : cuts) {
    EXPECT_GE(cut.length, least);
    EXPECT_LT(cut.length, 1.2 * width);
    least = cut.length;
    PathNetwork halves = d.network;
    const int path = halves.add_path(PathKind::kCut);
    for (int e : cut.edges) halves.edge_path[e] = path;
    const PatchLayout both =
        extract_layout(d.mesh, halves, std::vector<int>(d.mesh.points.size(), 0), LayoutRules());
    ASSERT_EQ(both.patches.size(), 2u);
    for (const Patch& p : both.patches) EXPECT_GT(p.area, 0.15 * area);
  }
  EXPECT_TRUE(straight_cuts(d.mesh, layout, 0, chart, 0.9 * width, 0.2 * area, 4).empty());
  EXPECT_TRUE(straight_cuts(d.mesh, layout, 0, chart, 1.2 * width, 0.51 * area, 4).empty());
}

}  // namespace
}  // namespace sheetform
