// Several tolerances in one run: every result as good as one of its own, parts that never get more.
#include "sheetform/sweep.h"

#include <algorithm>
#include <cmath>

#include "pipeline/run.h"
#include "sheetform/base/error.h"

namespace sheetform {
namespace {

TriangleSoup wavy() {
  return shapes::grid(
      {36, 36}, [](double u, double v) { return Vector3(u, v, 0.15 * std::sin(5 * u) * std::cos(4 * v)); });
}

std::vector<Decomposition> sweep_of(const TriangleSoup& soup, const std::vector<double>& e_max,
                                    DecomposeParams params = {}, int threads = 2) {
  InputMesh input;
  input.soup = soup;
  RunContext context;
  context.threads = threads;
  return sweep(input, params, e_max, nullptr, context);
}

TEST(SweepOfTolerances, EveryResultKeepsItsPromises) {
  const TriangleSoup soup = wavy();
  const std::vector<double> e_max{0.05, 0.01, 0.02};
  const std::vector<Decomposition> results = sweep_of(soup, e_max);
  ASSERT_EQ(results.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    SCOPED_TRACE(e_max[i]);
    EXPECT_EQ(results[i].params.e_max, e_max[i]) << "in the order given";
    expect_sound(soup, results[i]);
    EXPECT_TRUE(results[i].report.e_max_met);
  }
  EXPECT_LE(results[0].report.patches, results[2].report.patches);
  EXPECT_LE(results[2].report.patches, results[1].report.patches);
  EXPECT_LT(results[0].report.patches, results[1].report.patches);
}

TEST(SweepOfTolerances, TheFinestIsThatOfASingleRun) {
  const TriangleSoup soup = wavy();
  const std::vector<Decomposition> results = sweep_of(soup, {0.04, 0.02});
  const Decomposition single = run(soup, with_e_max(0.02), 1);
  EXPECT_EQ(results[1].strips.points, single.strips.points);
  EXPECT_EQ(results[1].strips.uvs, single.strips.uvs);
}

TEST(SweepOfTolerances, ThreadsDoNotMatter) {
  const TriangleSoup soup = shapes::sphere(12);
  const auto one = sweep_of(soup, {0.02, 0.05}, {}, 1), three = sweep_of(soup, {0.02, 0.05}, {}, 3);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(one[i].strips.points, three[i].strips.points);
    EXPECT_EQ(one[i].strips.uvs, three[i].strips.uvs);
  }
}

TEST(SweepOfTolerances, EqualTolerancesGiveEqualResults) {
  const TriangleSoup soup = shapes::closed_cylinder(32, 6);
  const auto results = sweep_of(soup, {0.03, 0.03});
  ASSERT_EQ(results.size(), 2u);
  EXPECT_EQ(results[0].strips.points, results[1].strips.points);
}

TEST(SweepOfTolerances, SymmetricResultsStaySymmetric) {
  TriangleSoup soup = shapes::sphere(12);
  for (Vector3& p : soup.points) p = p.cwiseProduct(Vector3(1, 1.4, 2));
  DecomposeParams params;
  params.symmetry = SymmetryMode::kPlane;
  for (const Decomposition& d : sweep_of(soup, {0.05, 0.025}, params)) {
    expect_sound(soup, d);
    ASSERT_TRUE(d.mirror_plane.has_value());
    for (std::size_t p = 0; p < d.strips.patches.size(); ++p) {
      const int image = d.strips.patches[p].mirror_of;
      EXPECT_TRUE(image < 0 || d.strips.patches[image].mirror_of == static_cast<int>(p));
    }
  }
}

TEST(SweepOfTolerances, EachResultIsHandedOverWhenItIsDoneAndProgressNeverFalls) {
  TriangleSoup soup = shapes::sphere(10);
  const TriangleSoup other = soup;
  const int n = static_cast<int>(soup.points.size());
  for (const Vector3& p : other.points) soup.points.push_back(p + Vector3(3, 0, 0));  // two components
  for (auto f : other.faces) soup.faces.push_back({f[0] + n, f[1] + n, f[2] + n});
  InputMesh input;
  input.soup = soup;
  RunContext context;
  std::vector<double> at, fractions;
  context.progress = [&](Stage, double fraction, const std::string&) { fractions.push_back(fraction); };
  const auto found = [&](const Decomposition& d) {
    expect_sound(soup, d);
    at.push_back(d.params.e_max);
    EXPECT_EQ(fractions.back() < 0.9, at.size() < 3) << at.size() << " of 3 are done";
  };
  sweep(input, {}, {0.02, 0.05, 0.03}, nullptr, context, nullptr, found);
  EXPECT_EQ(at, (std::vector<double>{0.02, 0.03, 0.05}));
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
}

TEST(SweepOfTolerances, WhoIsToldOfAResultMayEndTheSweep) {
  InputMesh input;
  input.soup = shapes::sphere(10);
  RunContext context;
  int told = 0;
  const auto stop = [&](const Decomposition&) {
    ++told;
    throw Error(ErrorCode::kInternal, "enough");  // the kind that other ways of searching may mend
  };
  EXPECT_THROW(sweep(input, {}, {0.02, 0.05}, nullptr, context, nullptr, stop), Error);
  EXPECT_EQ(told, 1);
}

TEST(SweepOfTolerances, WrongListsAreRefused) {
  const TriangleSoup soup = shapes::sphere(6);
  const std::vector<std::vector<double>> lists{{}, {0.02, 0}, {0.7}, {0.02, std::nan("")}};
  for (const std::vector<double>& list : lists) EXPECT_THROW(sweep_of(soup, list), Error);
  DecomposeParams millimetres;
  millimetres.e_max_mm = 2;
  EXPECT_THROW(sweep_of(soup, {0.02}, millimetres), Error);
}

}  // namespace
}  // namespace sheetform
