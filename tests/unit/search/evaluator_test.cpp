#include "sheetform/search/evaluator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "unit/search/drawn_surface.h"

namespace sheetform {
namespace {

using shapes::Canvas;
using shapes::Drawing;
using shapes::drawn;

// ---- the verdict on one patch

PatchVerdict verdict_of(const Drawing& d, char letter, EvaluationParams params,
                        const LayoutRules& rules = {}) {
  SearchBed bed(d.mesh);
  LayoutEvaluator evaluator(bed.surface, params, bed.context);
  const PatchLayout layout = d.layout(rules);
  return evaluator.patch(layout, d.patch_of(layout, letter))->verdict;
}

TEST(Verdict, RectangleOfACylinderIsViable) {
  EXPECT_EQ(verdict_of(drawn("AAB/AAC", bent(0.5)), 'A', evaluation_params(0.02)), PatchVerdict::kViable);
}

TEST(Verdict, RingIsNoDisk) {
  EXPECT_EQ(verdict_of(drawn("AAA/ABA/AAA"), 'A', evaluation_params(0.02)), PatchVerdict::kNotADisk);
}

TEST(Verdict, PatchThatMeetsItselfTouches) {
  EXPECT_EQ(verdict_of(drawn("AAA/ABA/AAB"), 'A', evaluation_params(0.02)), PatchVerdict::kTouches);
  EXPECT_EQ(verdict_of(drawn("AA|AA/AAAA"), 'A', evaluation_params(0.02), {true, false}),
            PatchVerdict::kTouches);
  EXPECT_EQ(verdict_of(drawn("AAAA|", rolled(4)), 'A', evaluation_params(0.02), {false}),
            PatchVerdict::kTouches);
}

TEST(Verdict, SidesAreCountedBetweenCorners) {
  const Drawing plus = drawn("BAC/AAA/DAE");
  EXPECT_EQ(verdict_of(plus, 'A', evaluation_params(0.02)), PatchVerdict::kTooManySides) << "8 ends of seams";
  const Drawing ell = drawn("A./AA");
  EXPECT_EQ(verdict_of(ell, 'A', evaluation_params(0.02)), PatchVerdict::kViable) << "6 sides";
  EvaluationParams five = evaluation_params(0.02);
  five.max_sides = 5;
  EXPECT_EQ(verdict_of(ell, 'A', five), PatchVerdict::kTooManySides);
}

// Of twelve corners six are left, and of eight that one neighbour lies around.
TEST(Verdict, BendsWhereNoSeamEndsCountOnlyAsFarAsThereIsRoom) {
  for (const char* text : {".A./AAA/.A.", "BBB/BAB/AAA"}) {
    const Drawing d = drawn(text);
    const PatchLayout layout = d.layout();
    for (int most : {5, 6}) {
      SearchBed bed(d.mesh);
      EvaluationParams params = evaluation_params(0.02);
      params.max_sides = most;
      LayoutEvaluator evaluator(bed.surface, params, bed.context);
      const auto e = evaluator.patch(layout, d.patch_of(layout, 'A'));
      EXPECT_EQ(e->verdict, most == 6 ? PatchVerdict::kViable : PatchVerdict::kTooManySides) << text;
      EXPECT_EQ(e->corners.size(), most == 6 ? 6u : text[0] == '.' ? 12u : 8u) << text;
    }
  }
}

// The ends of the seams stay corners, whatever bends more.
TEST(Verdict, EndsOfSeamsAreCornersBeforeBends) {
  const Drawing d = drawn("BBB/BAB/AAA");
  const PatchLayout layout = d.layout();
  SearchBed bed(d.mesh);
  LayoutEvaluator evaluator(bed.surface, evaluation_params(0.02), bed.context);
  const auto e = evaluator.patch(layout, d.patch_of(layout, 'A'));
  for (int vertex : {d.vertex_at(0, 2), d.vertex_at(3, 2)})
    EXPECT_TRUE(std::any_of(e->corners.begin(), e->corners.end(), [&](int i) {
      return (e->polygon.point[i] - d.mesh.points[vertex]).norm() < 1e-9;
    }));
}

// In a region the patches beyond are unknown; ends of seams are no bends for that.
TEST(Verdict, BendsAreToldInARegionToo) {
  const Drawing d = drawn("BAC/AAA/DAE");
  SearchBed bed(d.mesh);
  LayoutEvaluator evaluator(bed.surface, evaluation_params(0.02), bed.context);
  const PatchLayout region = extract_region(d.mesh, d.network, d.versions, {}, d.faces_of('A'));
  ASSERT_EQ(region.patches.size(), 1u);
  EXPECT_EQ(evaluator.patch(region, 0)->verdict, PatchVerdict::kTooManySides) << "8 ends of seams";
}

TEST(Verdict, TJunctionsOnASideAreNoCorners) {
  // B has four corners and five T-junctions on one of its sides.
  const Drawing d = drawn("BBBBBB/ACADAC");
  EvaluationParams params = evaluation_params(0.02);
  EXPECT_EQ(verdict_of(d, 'B', params), PatchVerdict::kViable);
  params.t_junctions = false;
  EXPECT_EQ(verdict_of(d, 'B', params), PatchVerdict::kTooManySides)
      << "without T-junctions every node is a corner";
}

TEST(Verdict, DomeIsTooCurvedForOneSheet) {
  Canvas dome;
  dome.steps = 12;
  dome.place = [](double x, double y) {
    return Vector3(x - 0.5, y - 0.5, 0.6 - 1.2 * ((x - 0.5) * (x - 0.5) + (y - 0.5) * (y - 0.5)));
  };
  const Drawing d = drawn("A", dome);
  EXPECT_EQ(verdict_of(d, 'A', evaluation_params(0.01)), PatchVerdict::kError);
  EXPECT_EQ(verdict_of(d, 'A', evaluation_params(0.3)), PatchVerdict::kViable);
}

TEST(Verdict, NamesAreForPeople) {
  for (PatchVerdict v :
       {PatchVerdict::kViable, PatchVerdict::kNotADisk, PatchVerdict::kTouches, PatchVerdict::kTooManySides,
        PatchVerdict::kFolded, PatchVerdict::kNoRulings, PatchVerdict::kOverlap, PatchVerdict::kError})
    EXPECT_STRNE(to_string(v), "");
}

// ---- the error

TEST(PatchEvaluation, ErrorOfAnArcIsHalfOfItsSagitta) {
  // A dome that is curved the same both ways, one patch: whatever the rulings, an arc of its width remains.
  const double k = 0.8;
  Canvas dome;
  dome.steps = 16;
  dome.place = [=](double x, double y) {
    return Vector3(x - 0.5, y - 0.5, -k / 2 * ((x - 0.5) * (x - 0.5) + (y - 0.5) * (y - 0.5)));
  };
  const Drawing d = drawn("A", dome);
  SearchBed bed(d.mesh);
  LayoutEvaluator evaluator(bed.surface, evaluation_params(0.01), bed.context);
  const PatchLayout layout = d.layout();
  const double sagitta = k / 8;
  const double error = evaluator.patch(layout, 0)->error;
  EXPECT_GT(error, 0.5 * sagitta * 0.9);
  EXPECT_LT(error, 0.5 * sagitta * 1.5);
}

// Below 0.8 of e_max displacement stands in for distance, so a small error only shows at a small tolerance:
// four times what the outline samples' own facets cost.
TEST(PatchEvaluation, DevelopablePatchesFitToTheirFacets) {
  const double spacing = 0.05, radius = 0.2 / 0.4, facet = spacing * spacing / (8 * radius);
  for (const char* text : {"AA/AA", "AAB/AAC"}) {
    const Drawing d = drawn(text, bent(0.4));
    SearchBed bed(d.mesh);
    LayoutEvaluator evaluator(bed.surface, evaluation_params(4 * facet), bed.context);
    const PatchLayout layout = d.layout();
    for (int p = 0; p < static_cast<int>(layout.patches.size()); ++p) {
      const auto e = evaluator.patch(layout, p);
      EXPECT_EQ(e->verdict, PatchVerdict::kViable) << text << ": " << to_string(e->verdict);
      EXPECT_LE(e->error, 4 * facet) << text;
    }
  }
}

TEST(PatchEvaluation, TubeFromOneSheetIsViableWithItsSeam) {
  const double spacing = 0.05, radius = 0.3, facet = spacing * spacing / (8 * radius);
  const Drawing d = drawn("AAAAAA|/AAAAAA|", rolled(6, 6, radius));
  SearchBed bed(d.mesh);
  LayoutEvaluator evaluator(bed.surface, evaluation_params(10 * facet), bed.context);
  const PatchLayout layout = d.layout();
  const auto e = evaluator.patch(layout, 0);
  EXPECT_EQ(e->verdict, PatchVerdict::kViable) << to_string(e->verdict) << ", error " << e->error;
  EXPECT_EQ(e->corners.size(), 4u);
}

// ---- patch_error

TEST(PatchError, IsTheDistanceWhereDisplacementIsTooStrict) {
  const TriangleSoup soup = shapes::plane(4, 1);
  const ClosestPointTree tree(soup.points, soup.faces);
  const std::vector<Vector3> position{{0.2, 0.2, 0.03}, {0.8, 0.2, 0.03}, {0.2, 0.8, 0.03}};
  MorphSample s{};
  s.normal = Vector3::UnitZ();
  s.unknown = {0, 1, 0};
  s.coefficient = {0.5, 0.5, 0};
  s.target = Vector3(0.5, 0.3, 0);  // 0.1 to the side of the chord's middle, 0.03 below
  const MorphSample* worst = nullptr;
  EXPECT_NEAR(patch_error({s}, {{0, 1, 2}}, position, tree, 0.01, &worst), 0.03, 1e-12);
  EXPECT_NE(worst, nullptr);
  EXPECT_NEAR(patch_error({s}, {{0, 1, 2}}, position, tree, 0.5, nullptr), std::hypot(0.1, 0.03), 1e-12)
      << "below the limit displacement will do";
}

TEST(PatchError, OfCoveredPointsIsTheirDistanceToTheStrips) {
  const TriangleSoup soup = shapes::plane(4, 1);
  const ClosestPointTree tree(soup.points, soup.faces);
  const std::vector<Vector3> position{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  MorphSample s{};
  s.normal = Vector3::UnitZ();
  s.unknown = {0, 1, 2};
  s.coefficient = {0.2, 0.4, 0.4};
  s.covers = true;
  for (const auto& [target, wanted] : {std::pair{Vector3(0.25, 0.25, 0.2), 0.2},  // above the inside
                                       {Vector3(0.5, -0.3, 0), 0.3},              // beside an edge
                                       {Vector3(-0.3, -0.4, 0), 0.5},             // beyond a corner
                                       {Vector3(1, 1, 0), std::sqrt(0.5)}}) {
    s.target = target;
    EXPECT_NEAR(patch_error({s}, {{0, 1, 2}}, position, tree, 0, nullptr), wanted, 1e-12);
  }
}

// ---- layouts

struct Tube {
  Drawing drawing = drawn("AABB/CCDD", rolled(4));
  SearchBed bed{drawing.mesh};
  PatchLayout layout = drawing.layout();
  LayoutEvaluator evaluator{bed.surface, evaluation_params(0.01), bed.context};
};

TEST(LayoutEvaluator, TubeInFourPartsIsViable) {
  Tube t;
  const LayoutEvaluation e = t.evaluator.layout(t.layout, 4);
  EXPECT_EQ(e.failing, 0);
  EXPECT_LE(e.max_error, 0.01);
  EXPECT_EQ(e.patch_error.size(), 4u);
  EXPECT_DOUBLE_EQ(*std::max_element(e.patch_error.begin(), e.patch_error.end()), e.max_error);
}

TEST(LayoutEvaluator, NeighboursShareTheirUnknowns) {
  Tube t;
  const LayoutEvaluation e = t.evaluator.layout(t.layout, 1);
  for (std::size_t p = 0; p < t.layout.patches.size(); ++p) {
    const PatchPolygon& polygon = e.patches[p]->polygon;
    ASSERT_EQ(static_cast<int>(e.unknowns[p].size()), polygon.size());
    for (int i = 0; i < polygon.size(); ++i) {
      const int arch = t.layout.patches[p].boundary[polygon.origin[i].use].arch;
      EXPECT_EQ(e.unknowns[p][i], e.arch_unknowns[arch][polygon.origin[i].sample]);
    }
  }
  // Arches that meet at a node share its unknown.
  std::map<int, int> at_vertex;
  for (std::size_t a = 0; a < t.layout.arches.size(); ++a)
    for (const auto& [v, u] : {std::pair{t.layout.arches[a].vertices.front(), e.arch_unknowns[a].front()},
                               {t.layout.arches[a].vertices.back(), e.arch_unknowns[a].back()}}) {
      const auto [it, fresh] = at_vertex.emplace(v, u);
      EXPECT_EQ(it->second, u);
    }
}

TEST(LayoutEvaluator, RemembersPatches) {
  Tube t;
  t.evaluator.layout(t.layout, 1);
  EXPECT_EQ(t.evaluator.counts().evaluations, 4);
  const auto hits = t.evaluator.counts().cache_hits;
  t.evaluator.layout(t.layout, 1);
  EXPECT_EQ(t.evaluator.counts().evaluations, 4);
  EXPECT_EQ(t.evaluator.counts().cache_hits, hits + 4);
  // One patch changes: its neighbours across the moved arch are new as well, the others are not.
  const int v = t.drawing.mesh.edges[t.drawing.line(2, 0, 2, 1)[2]].v0;
  ++t.drawing.versions[v];
  t.evaluator.layout(t.drawing.layout(), 1);
  EXPECT_EQ(t.evaluator.counts().evaluations, 6);
}

TEST(LayoutEvaluator, RejectedPatchesStayRejected) {
  Tube t;
  EXPECT_TRUE(t.evaluator.patch(t.layout, 1)->viable());
  t.evaluator.reject(t.layout.patches[1]);
  EXPECT_EQ(t.evaluator.patch(t.layout, 1)->verdict, PatchVerdict::kError);
  EXPECT_TRUE(t.evaluator.patch(t.layout, 0)->viable());
}

TEST(LayoutEvaluator, RegionOfAllPatchesIsTheWhole) {
  Tube t;
  const LayoutEvaluation whole = t.evaluator.layout(t.layout, 4);
  const LayoutEvaluation region = t.evaluator.solve_region(t.layout, {}, 4);
  ASSERT_EQ(region.position.size(), whole.position.size());
  for (std::size_t i = 0; i < whole.position.size(); ++i)
    EXPECT_LT((whole.position[i] - region.position[i]).norm(), 1e-12);
  EXPECT_NEAR(region.max_error, whole.max_error, 1e-12);
}

TEST(LayoutEvaluator, RegionHoldsItsOutline) {
  Tube t;
  const int a = t.drawing.patch_of(t.layout, 'A');
  // Where the neighbours' arches are is said by the places; without one they stay on the surface.
  ArchPlaces places;
  const LayoutEvaluation free = t.evaluator.layout(t.layout, 4);
  int shifted = -1;
  for (std::size_t i = 0; i < t.layout.arches.size(); ++i) {
    const Arch& arch = t.layout.arches[i];
    if (arch.left < 0 || arch.right < 0 || (arch.left != a && arch.right != a)) continue;
    if (shifted >= 0) continue;
    shifted = static_cast<int>(i);
    for (int u : free.arch_unknowns[i]) places[arch.key].push_back(free.position[u] + Vector3(0, 0, 0.01));
  }
  ASSERT_GE(shifted, 0);
  const std::uint64_t shifted_key = t.layout.arches[shifted].key;
  const PatchLayout region = extract_region(t.drawing.mesh, t.drawing.network, t.bed.surface.versions, {},
                                            t.layout.patches[a].faces);
  const LayoutEvaluation e = t.evaluator.solve_region(region, places, 4);
  int held = 0;
  for (std::size_t i = 0; i < region.arches.size(); ++i) {
    const Arch& arch = region.arches[i];
    if (arch.left != Arch::kUnknown && arch.right != Arch::kUnknown) continue;  // the rim: free
    ++held;
    const auto samples = sample_arch(t.drawing.mesh, arch, 0.05);
    for (std::size_t s = 1; s + 1 < samples.size(); ++s) {
      const Vector3 wanted =
          arch.key == shifted_key ? places[arch.key][s] : arch_point(t.drawing.mesh, arch, samples[s]);
      EXPECT_LT((e.position[e.arch_unknowns[i][s]] - wanted).norm(), 1e-5);
    }
  }
  EXPECT_GE(held, 2);
  EXPECT_EQ(e.patches.size(), 1u);
}

TEST(LayoutEvaluator, GivesTheSameForAnyNumberOfThreads) {
  std::vector<std::vector<Vector3>> positions;
  for (int threads : {1, 2, 4}) {
    Tube t;
    t.bed.context.threads = threads;
    positions.push_back(t.evaluator.layout(t.layout, 4).position);
  }
  EXPECT_EQ(positions[0], positions[1]);
  EXPECT_EQ(positions[0], positions[2]);
}

TEST(LayoutEvaluator, AnotherSamplingKeepsTheCornersThatAreKnown) {
  const Drawing ell = drawn("A./AA");
  const PatchLayout layout = ell.layout({});
  const int p = ell.patch_of(layout, 'A');
  SearchBed bed(ell.mesh);
  EvaluationParams params = evaluation_params(0.02);
  LayoutEvaluator first(bed.surface, params, bed.context);
  const auto known = first.patch(layout, p);
  ASSERT_EQ(known->corners.size(), 6u);
  params.spacing /= 3;
  params.corner_turn = 120;  // by which none of them turns
  LayoutEvaluator alone(bed.surface, params, bed.context),
      finer(bed.surface, params, bed.context, &first, true);
  EXPECT_EQ(alone.patch(layout, p)->corners.size(), 0u);
  const auto again = finer.patch(layout, p);
  EXPECT_GT(again->polygon.size(), known->polygon.size());
  ASSERT_EQ(again->corners.size(), 6u);
  for (int k = 0; k < 6; ++k)
    EXPECT_EQ(again->polygon.point[again->corners[k]], known->polygon.point[known->corners[k]]);
}

TEST(LayoutEvaluator, ForbiddenChordsAreAvoided) {
  Tube t;
  const auto free = t.evaluator.patch(t.layout, 0);
  const auto banned = free->rulings.chords[free->rulings.chords.size() / 2];
  const std::function<bool(int, int)> forbidden = [&](int a, int b) {
    return std::minmax(a, b) == std::minmax(banned.a, banned.b);
  };
  const auto other = t.evaluator.patch_with(t.layout, 0, t.evaluator.params().ruling, &forbidden);
  for (const auto& c : other->rulings.chords)
    EXPECT_NE(std::minmax(c.a, c.b), std::minmax(banned.a, banned.b));
  EXPECT_EQ(t.evaluator.patch(t.layout, 0), free) << "what is remembered is the free one";
}

}  // namespace
}  // namespace sheetform
