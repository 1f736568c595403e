// morph=full and the normal-deviation criterion, through the whole pipeline.
#include <algorithm>

#include "pipeline/run.h"

namespace sheetform {
namespace {

DecomposeParams draft(double e_max) {
  DecomposeParams params = with_e_max(e_max);
  params.effort = Effort::kDraft;
  return params;
}

TEST(FullMorphResult, KeepsEveryPromise) {
  for (const TriangleSoup& soup : {shapes::torus(36, 18), shapes::saddle(20, 1.2)}) {
    DecomposeParams params = draft(0.03);
    const Decomposition reduced = run(soup, params, 2);
    params.morph = MorphKind::kFull;
    const Decomposition full = run(soup, params, 2);
    expect_sound(soup, full);
    EXPECT_TRUE(full.report.e_max_met);
    EXPECT_EQ(full.strips.patches.size(), reduced.strips.patches.size()) << "the layout is the same";
    EXPECT_NE(full.strips.points, reduced.strips.points) << "the shape is not";
  }
}

TEST(FullMorphResult, IsTheSameForAnyNumberOfThreads) {
  DecomposeParams params = draft(0.03);
  params.morph = MorphKind::kFull;
  const TriangleSoup soup = shapes::saddle(20, 1.2);
  EXPECT_EQ(run(soup, params, 1).strips.points, run(soup, params, 3).strips.points);
}

// A saddle's strips use the tolerance up: the paper's sums of squares miss it where the minimax of the search
// does not. The result must not.
TEST(FullMorphResult, PartsThatItWouldSpoilKeepTheReducedShape) {
  DecomposeParams params = draft(0.03);
  params.morph = MorphKind::kFull;
  const TriangleSoup soup = shapes::saddle(24, 1.2);
  const Decomposition d = run(soup, params, 2);
  expect_sound(soup, d);
  EXPECT_TRUE(d.report.e_max_met);
  EXPECT_TRUE(std::any_of(d.report.notes.begin(), d.report.notes.end(), [](const std::string& note) {
    return note.find("the reduced morph") != std::string::npos;
  }));
}

TEST(NormalDeviation, IsKeptWhereItIsAskedFor) {
  const TriangleSoup soup = shapes::sphere(10);
  DecomposeParams params = draft(0.08);
  const Decomposition free = run(soup, params, 2);
  EXPECT_TRUE(free.report.normal_deviation_met) << "nothing was asked for";
  params.normal_deviation = 15;
  ASSERT_GT(free.report.normal_deviation, 15);
  const Decomposition d = run(soup, params, 2);
  expect_sound(soup, d);
  EXPECT_TRUE(d.report.e_max_met);
  EXPECT_TRUE(d.report.normal_deviation_met);
  EXPECT_LE(d.report.normal_deviation, 15);
  EXPECT_LT(d.report.normal_mean, free.report.normal_mean);
  EXPECT_GT(d.strips.patches.size(), free.strips.patches.size());
}

// Noise tilts every face; no layout helps, and the run must end all the same.
TEST(NormalDeviation, ThatCannotBeMetIsReportedWithItsPlace) {
  TriangleSoup soup = shapes::grid({6, 6}, [](double u, double v) {
    const double bump = std::fmod(1000 * (std::sin(91 * u + 57 * v) + 2), 1.0);
    return Vector3(u, v, 0.012 * bump);
  });
  DecomposeParams params = draft(0.05);
  params.normal_deviation = 2;
  const Decomposition d = run(soup, params, 2);
  expect_sound(soup, d);
  EXPECT_FALSE(d.report.normal_deviation_met);
  EXPECT_GT(d.report.normal_deviation, 2);
  ASSERT_FALSE(d.report.notes.empty());
  EXPECT_NE(d.report.notes.back().find("normal deviation of 2 degrees is not met"), std::string::npos);
}

}  // namespace
}  // namespace sheetform
