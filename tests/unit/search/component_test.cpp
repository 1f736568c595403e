#include "sheetform/search/component.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "sheetform/search/attempt.h"
#include "sheetform/search/fair_outlines.h"
#include "sheetform/search/finish.h"
#include "sheetform/strip/certificate.h"
#include "unit/search/drawn_surface.h"

namespace sheetform {
namespace {

TEST(Attempt, FarthestAreThoseBeyondHalfOfTheLargestExcess) {
  Attempt attempt;
  EXPECT_TRUE(attempt.farthest().empty());
  attempt.error = {1.3, 0.5, 1.6, 1.29, 3.0};  // the last one is invalid: it does not count
  attempt.too_far = {0, 2, 3};
  EXPECT_EQ(attempt.farthest(), (std::vector<int>{0, 2}));
  attempt.error = {0.999, 0.5, 0.9985, 0.2, 0.2};  // so near that all count
  attempt.too_far = {0, 2};
  EXPECT_EQ(attempt.farthest(), attempt.too_far);
}

ComponentInput input_of(const TriangleSoup& soup) {
  ComponentInput input;
  input.prepared.mesh = Searched::normalised(soup);
  input.prepared.crease_edge = detect_creases(input.prepared.mesh, 40);
  input.reference = {input.prepared.mesh.points, input.prepared.mesh.faces};
  return input;
}

ComponentParams params_of(double e_max) {
  ComponentParams params;
  params.evaluation.e_max = e_max;
  params.seeds = {60};
  params.improvements = 4;
  return params;
}

std::string text_of(const std::vector<Defect>& defects) {
  std::string text;
  for (const Defect& d : defects)
    text += d.check + " patch " + std::to_string(d.patch) + ": " + d.text + "\n";
  return text;
}

TEST(DecomposeComponent, KeepsItsPromises) {
  for (const TriangleSoup& soup : {shapes::torus(48, 24), shapes::saddle(24, 0.8)}) {
    const ComponentInput input = input_of(soup);
    RunContext context;
    const ComponentResult result = decompose_component(input, params_of(0.03), context);
    const auto defects = check_structure(result.strips, &input.prepared.mesh, 6, 1);
    EXPECT_TRUE(defects.empty()) << text_of(defects);
    EXPECT_LE(result.distance, 0.03);
    const ClosestPointTree tree(input.reference.points, input.reference.faces);
    EXPECT_LE(measure_distance(input.reference, tree, result.strips, 20000, context).hausdorff(),
              0.03 * 1.02);
    for (const char* stage : {"field", "trace", "insert", "remove", "final"})
      EXPECT_TRUE(result.seconds.count(stage)) << stage;
  }
}

// What the search takes for fitting and the last passes cannot keep is split.
TEST(DecomposeComponent, KeepsTheToleranceWhateverTheSearchTakesForFitting) {
  const ComponentInput input = input_of(shapes::torus(48, 24));
  std::set<std::size_t> parts;
  for (double aim : {0.8, 1.04, 1.5}) {
    ComponentParams params = params_of(0.03);
    params.aim = aim;
    RunContext context;
    const ComponentResult result = decompose_component(input, params, context);
    const auto defects = check_structure(result.strips, &input.prepared.mesh, 6, 1);
    EXPECT_TRUE(defects.empty()) << text_of(defects);
    EXPECT_LE(result.distance, 0.03) << aim;
    parts.insert(result.strips.patches.size());
  }
  EXPECT_GT(parts.size(), 1u);
}

double turning(const std::vector<Vector3>& line) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < line.size(); ++i)
    sum += angle_between(line[i] - line[i - 1], line[i + 1] - line[i]);
  return sum;
}

// What seams turn to and fro, in degrees a diagonal of length: without the last smoothing it is 8.6.
TEST(DecomposeComponent, SeamsAreSmooth) {
  RunContext context;
  const ComponentResult result = decompose_component(input_of(shapes::sphere(14)), params_of(0.02), context);
  double excess = 0, length = 0;
  for (const StripMesh::Arch& arch : result.strips.arches) {
    std::vector<Vector3> line;
    for (int v : arch.vertices) line.push_back(result.strips.points[v]);
    for (std::size_t i = 1; i < line.size(); ++i) length += (line[i] - line[i - 1]).norm();
    const std::vector<Vector3> fair = faired(line, 0.15, std::vector<double>(line.size(), 1));
    excess += std::max(0.0, turning(line) - turning(fair));
  }
  EXPECT_LT(excess / length * 180 / shapes::kPi, 3);
}

TEST(DecomposeComponent, SearchesAgainOnlyWhereTheToleranceIsMissed) {
  const ComponentInput input = input_of(shapes::saddle(12, 0.8));
  const auto searched = [&](std::vector<int> seeds) {
    ComponentParams params = params_of(0.015);
    params.improvements = 0;
    params.evaluation.normal_deviation = 9;  // just within reach
    params.seeds = std::move(seeds);
    RunContext context;
    return decompose_component(input, params, context);
  };
  const ComponentResult good = searched({60}), bad = searched({12}), first = searched({60, 12}),
                        second = searched({12, 60});
  ASSERT_LE(good.miss, 1);
  ASSERT_GT(bad.miss, 1);
  EXPECT_EQ(first.counts.evaluations, good.counts.evaluations);
  EXPECT_EQ(second.counts.evaluations, good.counts.evaluations + bad.counts.evaluations);
  EXPECT_EQ(first.strips.points, good.strips.points);
  EXPECT_EQ(second.strips.points, good.strips.points);
  EXPECT_EQ(second.miss, good.miss);
}

TEST(DecomposeComponent, WithoutTJunctionsTheBestOfItsSearchesCounts) {
  const ComponentInput input = input_of(shapes::saddle(24, 0.8));
  std::map<int, std::size_t> parts;  // by seeds; 0: both
  for (int seeds : {60, 12, 0}) {
    ComponentParams params = params_of(0.02);
    params.improvements = 0;
    params.evaluation.t_junctions = false;
    params.seeds = seeds == 0 ? std::vector<int>{60, 12} : std::vector<int>{seeds};
    RunContext context;
    parts[seeds] = decompose_component(input, params, context).strips.patches.size();
  }
  EXPECT_EQ(parts[0], std::min(parts[60], parts[12]));
}

TEST(FinalPass, ChordsAreEdgesOfTheirOwn) {
  Searched s(shapes::torus(48, 24), 0.03);
  s.search->insert();
  s.search->remove_paths();
  EvaluationParams fine = s.search->evaluator().params();
  fine.spacing = 0.015;
  FinalPass pass(s.bed.surface, s.search->network().network(), s.search->layout(), fine,
                 s.search->evaluator(), s.bed.context);
  const FinishedLayout finished = pass.solve(4);
  std::set<std::pair<int, int>> taken;
  for (const auto& arch : finished.source.arches)
    for (std::size_t i = 0; i + 1 < arch.points.size(); ++i)
      EXPECT_TRUE(taken.insert(std::minmax(arch.points[i], arch.points[i + 1])).second);
  const std::set<int> failing(finished.failing.begin(), finished.failing.end());
  for (int p = 0; p < static_cast<int>(finished.source.patches.size()); ++p) {
    if (failing.count(p)) continue;
    const auto& patch = finished.source.patches[p];
    EXPECT_EQ(patch.triangles.size() + 2, patch.outline.size());
    EXPECT_EQ(patch.rulings.size() + 3, patch.outline.size());
    for (const auto& r : patch.rulings)
      EXPECT_TRUE(taken.insert(std::minmax(patch.outline[r[0]], patch.outline[r[1]])).second)
          << "three faces would meet there";
  }
}

TEST(FinalPass, OutlinesAreTheArchesInOrder) {
  Searched s(shapes::torus(48, 24), 0.03);
  s.search->insert();
  const PatchLayout& layout = s.search->layout();
  FinalPass pass(s.bed.surface, s.search->network().network(), layout, s.search->evaluator().params(),
                 s.search->evaluator(), s.bed.context);
  const FinishedLayout finished = pass.solve(2);
  for (std::size_t p = 0; p < layout.patches.size(); ++p) {
    std::vector<int> outline;
    for (const ArchUse& use : layout.patches[p].boundary) {
      std::vector<int> points = finished.source.arches[use.arch].points;
      if (!use.forward) std::reverse(points.begin(), points.end());
      outline.insert(outline.end(), points.begin(), points.end() - 1);
    }
    EXPECT_EQ(finished.source.patches[p].outline, outline);
  }
}

// A place that is too far pulls, and the longer it stays so the more.
TEST(FinalPass, StripsAreDrawnToPlaces) {
  Searched s(shapes::torus(48, 24), 0.03);
  s.search->insert();
  FinalPass pass(s.bed.surface, s.search->network().network(), s.search->layout(),
                 s.search->evaluator().params(), s.search->evaluator(), s.bed.context);
  FinishedLayout now = pass.solve(4);
  const StripSource::Patch patch = now.source.patches[0];
  FarPlace far;
  for (int k = 0; k < 3; ++k) far.triangle[k] = patch.outline[patch.triangles[patch.triangles.size() / 2][k]];
  far.barycentric = Vector3::Constant(1.0 / 3);
  const auto middle = [&] {
    Vector3 sum = Vector3::Zero();
    for (int v : far.triangle) sum += now.source.points[v] / 3;
    return sum;
  };
  const auto side = [&](int k) -> Vector3 {
    return now.source.points[far.triangle[k]] - now.source.points[far.triangle[0]];
  };
  far.on_input = middle() + 0.01 * side(1).cross(side(2)).normalized();
  double last = 0.01, won = 0;
  for (int step = 0; step < 3; ++step) {
    pass.draw_to({far});
    now = pass.solve(4);
    const double left = (middle() - far.on_input).norm();
    EXPECT_GT(last - left, won) << step;
    won = last - left, last = left;
  }
}

// What it asks for here cannot be had, and would cost the tolerance.
TEST(DecomposeComponent, KeepsTheToleranceWhereTheNormalDeviationCannotBeMet) {
  TriangleSoup lumpy = shapes::sphere(12);
  for (Vector3& p : lumpy.points)
    p *= 1 + 0.4 * std::max(0.0, std::sin(5 * p.x()) * std::sin(5 * p.y() + 1) * std::cos(5 * p.z()));
  ComponentParams params = params_of(0.03);
  params.evaluation.normal_deviation = 10;
  params.seeds = {200}, params.improvements = 20;
  RunContext context;
  const ComponentResult result = decompose_component(input_of(lumpy), params, context);
  EXPECT_LE(result.distance, 0.03);
}

TEST(DecomposeComponent, GivesTheSameTwice) {
  const ComponentInput input = input_of(shapes::sphere(12));
  RunContext one, two;
  two.threads = 2;
  const ComponentResult a = decompose_component(input, params_of(0.04), one),
                        b = decompose_component(input, params_of(0.04), two);
  EXPECT_EQ(a.strips.points, b.strips.points);
  EXPECT_EQ(a.strips.uvs, b.strips.uvs);
  EXPECT_EQ(a.distance, b.distance);
}

// Which evaluations are forgotten depends on the threads.
TEST(DecomposeComponent, GivesTheSameWhereEvaluationsAreForgotten) {
  TriangleSoup lumpy = shapes::sphere(14);
  for (Vector3& p : lumpy.points)
    p *= 1 + 0.3 * std::sin(4 * p.x()) * std::sin(4 * p.y() + 1) * std::cos(4 * p.z());
  const ComponentInput input = input_of(lumpy);
  RunContext context;
  ComponentParams params = params_of(0.03);
  const auto results = [&] {
    std::vector<ComponentResult> found;
    sweep_component(input, params, {0.03, 0.04}, context,
                    [&](std::size_t, ComponentResult r) { found.push_back(std::move(r)); });
    return found;
  };
  const std::vector<ComponentResult> a = results();
  params.evaluation.remembered = 1;
  const std::vector<ComponentResult> b = results();
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(a[k].strips.points, b[k].strips.points);
    EXPECT_EQ(a[k].strips.uvs, b[k].strips.uvs);
  }
  EXPECT_GT(b[0].counts.evaluations, 1.2 * a[0].counts.evaluations);
}

// Its corners are those of the search, also where that has forgotten the patch.
TEST(FinalPass, HoldsWhatTheSearchKnows) {
  EvaluationParams params;
  params.e_max = 0.03;
  Searched s(shapes::torus(48, 24), params.e_max);
  s.search->insert();
  params.remembered = 1;
  LayoutEvaluator forgetful(s.bed.surface, params, s.bed.context);
  params.spacing /= 2;
  const FinalPass pass(s.bed.surface, s.search->network().network(), s.search->layout(), params, forgetful,
                       s.bed.context);
  for (const Patch& patch : s.search->layout().patches) EXPECT_TRUE(forgetful.known(patch));
}

}  // namespace
}  // namespace sheetform
