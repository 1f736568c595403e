// Darts: seams of a patch with itself that end inside of it, what the search leaves of arches that may not
// go.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sheetform/search/chord_book.h"
#include "sheetform/search/plane_join.h"
#include "unit/search/drawn_surface.h"

namespace sheetform {
namespace {

using shapes::Canvas;
using shapes::Drawing;
using shapes::drawn;

// A square sheet raised to a cone with a rounded tip.
Vector3 on_hill(double x, double y, double height) {
  const double r = std::hypot(x, y), square = std::max(std::abs(x), std::abs(y)), k = r > 0 ? square / r : 0;
  x *= k, y *= k;
  return {x, y, height * (1 - std::sqrt(x * x + y * y + 0.01))};
}
TriangleSoup hill(double height) {
  return shapes::grid({20, 20}, [=](double u, double v) { return on_hill(2 * u - 1, 2 * v - 1, height); });
}
Canvas raised(double height) {
  Canvas canvas;
  canvas.steps = 8;
  canvas.place = [=](double x, double y) { return Vector3(0.35 * on_hill(x - 1, y - 1, height)); };
  return canvas;
}

std::vector<int> tips(const SurfaceMesh& mesh, const PathNetwork& network) {
  std::vector<int> found;
  for (int v = 0; v < mesh.vertex_count(); ++v)
    if (network_degree(mesh, network, v) == 1) found.push_back(v);
  return found;
}

void reduce(LayoutSearch& search) {
  search.insert();
  search.remove_paths();
  search.remove_arches();
}

// With room for the three corners of a dart besides those of the sheet.
EvaluationParams many_sides(double e_max) {
  EvaluationParams params = evaluation_params(e_max);
  params.max_sides = 20;
  return params;
}

// ---- what the search leaves

struct Case {
  const char* name;
  TriangleSoup soup;
  double e_max;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class LeaveDarts : public ::testing::TestWithParam<Case> {};
TEST_P(LeaveDarts, TakesFewerPatchesThanWholeArchesAlone) {
  const Case& c = GetParam();
  Searched s(c.soup, c.e_max);
  LayoutSearch& search = *s.search;
  const SurfaceMesh& mesh = s.bed.surface.mesh;
  reduce(search);
  EXPECT_TRUE(tips(mesh, search.network().network()).empty());
  const std::size_t before = search.layout().patches.size();
  search.leave_darts();
  expect_viable(search, c.e_max);
  EXPECT_LT(search.layout().patches.size(), before);
  const std::vector<int> ends = tips(mesh, search.network().network());
  ASSERT_FALSE(ends.empty());
  for (int v : ends) {
    EXPECT_FALSE(mesh.border_vertex[v]);
    const PatchLayout& layout = search.layout();
    const auto arch = std::find_if(layout.arches.begin(), layout.arches.end(), [&](const Arch& a) {
      return a.vertices.front() == v || a.vertices.back() == v;
    });
    ASSERT_NE(arch, layout.arches.end());
    EXPECT_EQ(arch->left, arch->right) << "a patch glued to itself";
    EXPECT_FALSE(arch->closed());
  }
}
INSTANTIATE_TEST_SUITE_P(Shapes, LeaveDarts,
                         ::testing::Values(Case{"hill", hill(0.5), 0.03}, Case{"steep_hill", hill(0.8), 0.03},
                                           Case{"sphere", shapes::sphere(12), 0.04}));

TEST(Darts, AreTheSameForAnyNumberOfThreads) {
  expect_same_for_any_number_of_threads(0.04, [](Searched& s) {
    reduce(*s.search);
    s.search->leave_darts();
  });
}

TEST(Darts, AreNotLeftWhereSeamsOfAPatchWithItselfOrTJunctionsAreForbidden) {
  for (const bool self_seams : {true, false}) {
    EvaluationParams params;
    params.self_seams = self_seams, params.t_junctions = !self_seams;
    Searched s(hill(0.5), 0.03, params);
    reduce(*s.search);
    s.search->leave_darts();
    expect_viable(*s.search, 0.03);
    EXPECT_TRUE(tips(s.bed.surface.mesh, s.search->network().network()).empty());
    EXPECT_GT(s.search->layout().patches.size(), 1u);
  }
}

TEST(Darts, GoWhenTheyAreNotNeededAnyMore) {
  Searched s(hill(0.5), 0.03);
  reduce(*s.search);
  s.search->leave_darts();
  ASSERT_FALSE(tips(s.bed.surface.mesh, s.search->network().network()).empty());
  SearchParams generous;
  generous.evaluation.e_max = 0.3;
  LayoutSearch search(*s.search, s.search->network().network(), nullptr, generous);
  search.remove_arches();
  expect_viable(search, 0.3);
  EXPECT_EQ(inner_edges(s.bed.surface.mesh, search.network().network()), 0);
}

// ---- what hangs at what goes

// Every line inside of the surface leads to its border.
void expect_no_island(const SurfaceMesh& mesh, const PathNetwork& network) {
  std::vector<char> reached(mesh.points.size(), 0);
  std::vector<int> todo;
  for (int v = 0; v < mesh.vertex_count(); ++v)
    if (mesh.border_vertex[v]) reached[v] = 1, todo.push_back(v);
  while (!todo.empty()) {
    const int v = todo.back();
    todo.pop_back();
    for (const int* e = mesh.ring_begin_of(v); e != mesh.ring_end_of(v); ++e)
      if (const int w = mesh.edges[*e].other(v); network.used(*e) && !reached[w])
        reached[w] = 1, todo.push_back(w);
  }
  for (int e = 0; e < mesh.edge_count(); ++e)
    EXPECT_TRUE(!network.used(e) || reached[mesh.edges[e].v0]) << "edge " << e;
}

TEST(Darts, GoWithTheArchAtWhichTheyHang) {
  // The slit in A hangs at the line between A and B; nothing of it is needed on a gentle hill.
  const Drawing d = drawn("AAAA/AA|AA/BBBB", bent(0.2));
  Begun s(d, 0.05);
  ASSERT_EQ(tips(d.mesh, d.network), std::vector<int>{d.vertex_at(2, 1)});
  s.search->remove_arches();
  EXPECT_EQ(s.search->layout().patches.size(), 1u);
  EXPECT_EQ(inner_edges(d.mesh, s.network()), 0);
  expect_viable(*s.search, 0.05);
}

TEST(Darts, NeverBecomeIslandsWithoutTheirPath) {
  const Drawing d = drawn("AAAA/AA|AA/BBBB", bent(0.2));
  Begun s(d, 0.05);
  s.search->remove_paths();
  expect_no_island(d.mesh, s.network());
  s.search->leave_darts();
  expect_no_island(d.mesh, s.network());
  expect_viable(*s.search, 0.05);
}

TEST(Darts, WhatIsHeldKeepsTheArchAtWhichItHangs) {
  // The same with a slit that is a crease: it stays, and with it a way to the border.
  Drawing d = drawn("AAAA/AA|AA/BBBB", bent(0.2));
  const std::vector<int> slit = d.line(2, 1, 2, 2);
  d.network.kinds[d.network.edge_path[slit.front()]] = PathKind::kCrease;
  Begun s(d, 0.05);
  s.search->remove_paths();
  s.search->remove_arches();
  s.search->leave_darts();
  for (int e : slit) EXPECT_TRUE(s.network().used(e));
  expect_no_island(d.mesh, s.network());
}

TEST(Darts, AreLeftOfWhatHungAtAnArchThatGoes) {
  // A collar around the flat top of a cone, with a slit from the border to the cap: the cap needs no part of
  // its own, the collar needs its slit.
  Canvas canvas;
  canvas.place = [](double x, double y) {
    Vector3 p = on_hill(x / 5 - 1, y / 5 - 1, 0);
    p.z() = -0.8 * std::max(0.0, p.norm() - 0.2);
    return Vector3(0.35 * p);
  };
  canvas.steps = 2;
  canvas.one_path = true;
  const Drawing d = drawn(
      "AAAAA|AAAAA/AAAAA|AAAAA/AAAAA|AAAAA/AAAAA|AAAAA/AAAABBAAAA/AAAABBAAAA/"
      "AAAAAAAAAA/AAAAAAAAAA/AAAAAAAAAA/AAAAAAAAAA",
      canvas);
  Begun s(d, many_sides(0.04));
  s.search->remove_arches();
  ASSERT_EQ(s.search->layout().patches.size(), 2u) << "without the slit";
  s.search->leave_darts();
  expect_viable(*s.search, 0.04, 20);
  EXPECT_EQ(s.search->layout().patches.size(), 1u);
  EXPECT_EQ(tips(d.mesh, s.network()), std::vector<int>{d.vertex_at(5, 4)});
}

// ---- the verdict on one patch

PatchVerdict verdict_of(const Drawing& d, const LayoutRules& rules) {
  SearchBed bed(d.mesh);
  LayoutEvaluator evaluator(bed.surface, many_sides(0.02), bed.context);
  const PatchLayout layout = d.layout(rules);
  return evaluator.patch(layout, 0)->verdict;
}

TEST(Darts, MakeASheetOfACone) {
  EXPECT_EQ(verdict_of(drawn("AA/AA", raised(0.8)), {}), PatchVerdict::kError) << "without one";
  const Drawing d = drawn("A|A/AA", raised(0.8));
  EXPECT_EQ(verdict_of(d, {}), PatchVerdict::kViable);
  EXPECT_EQ(verdict_of(d, {true, false}), PatchVerdict::kTouches);
}

TEST(Darts, HaveToOpenInThePlane) {
  EXPECT_NE(verdict_of(drawn("A|A/AA"), {}), PatchVerdict::kViable)
      << "its two sides would lie on each other";
}

// A flat sleeve, bent along: its rulings run across, from its seam to the slit on the other side, on its
// front and on its back. There they could be the same edges.
TEST(Darts, LeaveChordsThatAreEdgesOfTheirOwn) {
  Canvas canvas = rolled(6);
  canvas.place = [](double x, double y) {
    const double around = 2 * shapes::kPi * x / 6, along = 0.5 * y, radius = 0.2 + 0.01 * std::sin(around);
    return Vector3(radius * std::cos(along), radius * std::sin(along), 0.06 * std::cos(around));
  };
  const Drawing d = drawn("AAA|AAA|/AAA|AAA|/AAA|AAA|/AAAAAA|", canvas);
  SearchBed bed(d.mesh);
  LayoutEvaluator evaluator(bed.surface, many_sides(0.02), bed.context);
  const PatchLayout layout = d.layout();
  const LayoutEvaluation e = evaluator.layout(layout, 0);
  ASSERT_EQ(e.patches.size(), 1u);
  EXPECT_TRUE(e.patches[0]->has_valid_strips()) << to_string(e.patches[0]->verdict);
  ChordBook book(e.on_plane);
  for (const std::vector<int>& arch : e.arch_unknowns) book.take_line(arch);
  EXPECT_TRUE(book.conflicts(e.patches[0]->rulings, e.unknowns[0]).empty());
  EXPECT_FALSE(e.patches[0]->rulings.chords.empty());
}

// ---- beside the plane of symmetry

// Half of a shape whose left edge is one straight segment on the plane x = 0, across which its patch goes on.
PatchVerdict verdict_beside_plane(const std::string& text, bool straight) {
  Canvas canvas;
  canvas.steps = 8;
  canvas.place = [](double x, double y) {
    return Vector3(0.3 * x, 0.3 * y, 0.25 * (1.5 - std::hypot(x - 1, y - 1)));
  };
  SearchBed bed(drawn(text, canvas).mesh);
  const SurfaceMesh& mesh = bed.surface.mesh;
  const auto on_plane = [&](int v) { return mesh.points[v].x() == 0; };
  bed.surface.plane.edge.assign(mesh.edges.size(), 0);
  for (int v = 0; v < mesh.vertex_count(); ++v) bed.surface.plane.vertex.push_back(on_plane(v));
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    bed.surface.plane.edge[e] = on_plane(mesh.edges[e].v0) && on_plane(mesh.edges[e].v1);
  if (straight) bed.surface.straight = bed.surface.plane.edge;
  LayoutEvaluator evaluator(bed.surface, many_sides(0.2), bed.context);
  const PatchLayout layout = drawn(text, canvas).layout();
  EXPECT_EQ(layout.patches.at(0).defect, TopologyDefect::kNone);
  return evaluator.patch(layout, 0)->verdict;
}

TEST(Darts, OfAPatchThatGoesOnInItsImageAreRefused) {
  // One that hangs on the plane would be a slit inside of the joined patch.
  EXPECT_EQ(verdict_beside_plane("AA/AA", true), PatchVerdict::kViable) << "without a dart";
  for (const char* text : {"AA/- /AA", "A|A/AA"}) {
    EXPECT_EQ(verdict_beside_plane(text, false), PatchVerdict::kViable) << text;
    EXPECT_EQ(verdict_beside_plane(text, true), PatchVerdict::kTooManySides) << text;
  }
}

}  // namespace
}  // namespace sheetform
