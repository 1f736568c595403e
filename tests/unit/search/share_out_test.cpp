// Small patches that are shared out among their neighbours.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "unit/search/drawn_surface.h"

namespace sheetform {
namespace {

using shapes::Drawing;
using shapes::drawn;

// B lies across the seam between A and C: whichever of them takes it gets eight corners.
const char* const kAcross = "AAAAAACCCCCC/AAAAABBCCCCC/AAAAAACCCCCC";

EvaluationParams four_sides() {
  EvaluationParams params = evaluation_params(0.05);
  params.max_sides = 4;
  return params;
}

TEST(ShareOut, NeighboursTakeTheirHalvesWhereNoneCanTakeTheWhole) {
  const Drawing d = drawn(kAcross, bent(0.1));
  Begun s(d, four_sides());
  LayoutSearch& search = *s.search;
  ASSERT_EQ(search.layout().patches.size(), 3u);
  EXPECT_EQ(search.share_out_small(), 1);
  ASSERT_EQ(search.layout().patches.size(), 2u);
  expect_viable(search, 0.05, 4);
  const double area = search.layout().patches[0].area;
  EXPECT_NEAR(search.layout().patches[1].area, area, 0.02 * area);
  for (const Arch& arch : search.layout().arches) {
    if (arch.left < 0 || arch.right < 0) continue;
    EXPECT_LT(arch.length, 1.1 * 3 * 0.2) << "straight across the three rows";
  }
}

TEST(ShareOut, NothingIsTakenAcrossACrease) {
  Drawing d = drawn(kAcross, bent(0.1));
  make_crease(d, d.line(5, 1, 5, 2));
  Begun s(d, four_sides());
  EXPECT_EQ(s.search->share_out_small(), 0);
  EXPECT_EQ(s.search->layout().patches.size(), 3u);
  for (int e : d.line(5, 1, 5, 2)) EXPECT_TRUE(s.network().used(e));
}

TEST(ShareOut, IsTheSameForAnyNumberOfThreads) {
  expect_same_for_any_number_of_threads(0.03, [](Searched& s) {
    s.reduce();
    s.search->share_out_small();
    expect_viable(*s.search, 0.03);
  });
}

}  // namespace
}  // namespace sheetform
