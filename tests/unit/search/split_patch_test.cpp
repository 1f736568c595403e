#include "sheetform/search/split.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "unit/search/drawn_surface.h"

namespace sheetform {
namespace {

using shapes::Canvas;
using shapes::Drawing;
using shapes::drawn;

// A network that is split patch by patch.
struct Splitter {
  SurfaceMesh mesh;
  PathNetwork network;
  LayoutRules rules;

  Splitter(SurfaceMesh m, PathNetwork n) : mesh(std::move(m)), network(std::move(n)) {}
  explicit Splitter(const Drawing& d) : Splitter(d.mesh, d.network) {}
  PatchLayout layout() const {
    return extract_layout(mesh, network, std::vector<int>(mesh.points.size(), 0), rules);
  }

  // Cuts patch p; the cut runs along free edges inside of it. Returns its edges.
  std::vector<int> split(int p, const PatchEvaluation& evaluation = {}) {
    const PatchLayout before = layout();
    const std::vector<int> edges = split_patch(mesh, before, p, evaluation);
    std::set<int> distinct(edges.begin(), edges.end());
    EXPECT_EQ(distinct.size(), edges.size());
    const int path = network.add_path(PathKind::kCut);
    for (int e : edges) {
      EXPECT_FALSE(network.used(e));
      EXPECT_EQ(before.face_patch[mesh.edges[e].f0], p);
      EXPECT_EQ(before.face_patch[mesh.edges[e].f1], p);
      network.edge_path[e] = path;
    }
    return edges;
  }

  int first_with(TopologyDefect defect) const {
    const PatchLayout now = layout();
    for (std::size_t p = 0; p < now.patches.size(); ++p)
      if (now.patches[p].defect == defect) return static_cast<int>(p);
    return -1;
  }
  // Splits whatever has a defect until nothing has; returns the number of cuts.
  int repair() {
    for (int cuts = 0; cuts < 50; ++cuts) {
      const PatchLayout now = layout();
      const auto bad = std::find_if(now.patches.begin(), now.patches.end(),
                                    [](const Patch& p) { return p.defect != TopologyDefect::kNone; });
      if (bad == now.patches.end()) return cuts;
      if (split(static_cast<int>(bad - now.patches.begin())).empty()) return -1;
    }
    return -1;
  }
};

SurfaceMesh mesh_of(const TriangleSoup& soup) { return build_surface_mesh(soup.points, soup.faces); }
Splitter bare(const TriangleSoup& soup) {
  SurfaceMesh mesh = mesh_of(soup);
  PathNetwork network = bare_network(mesh);
  return {std::move(mesh), std::move(network)};
}

TEST(SplitPatch, OpensARingAlongItsShortestWayAcross) {
  Splitter s(drawn("AAA/ABA/AAA"));
  const PatchLayout before = s.layout();
  const int ring = s.first_with(TopologyDefect::kNotADisk);
  ASSERT_GE(ring, 0);
  double length = 0;
  for (int e : s.split(ring)) length += s.mesh.edge_length(e);
  EXPECT_NEAR(length, 1, 1e-9) << "one cell";
  EXPECT_EQ(s.layout().patches.size(), 2u);
  EXPECT_EQ(s.first_with(TopologyDefect::kNotADisk), -1);
}

TEST(SplitPatch, OpensATubeAlongItsAxis) {
  Splitter s = bare(shapes::cylinder(24, 12, 1, 2));
  double length = 0;
  for (int e : s.split(0)) length += s.mesh.edge_length(e);
  EXPECT_NEAR(length, 2, 1e-9);
  const PatchLayout now = s.layout();
  ASSERT_EQ(now.patches.size(), 1u);
  EXPECT_EQ(now.patches[0].defect, TopologyDefect::kNone);
}

TEST(SplitPatch, TubeThatMayNotBeGluedToItselfBecomesTwo) {
  Splitter s = bare(shapes::cylinder(24, 12, 1, 2));
  s.rules.self_seams = false;
  EXPECT_GT(s.repair(), 0);
  const PatchLayout now = s.layout();
  EXPECT_EQ(now.patches.size(), 2u);
  EXPECT_NEAR(now.patches[0].area, now.patches[1].area, 0.25 * now.patches[0].area) << "of about equal size";
}

TEST(SplitPatch, HalvesAClosedBall) {
  Splitter s = bare(shapes::sphere(10));
  s.split(0);
  const PatchLayout now = s.layout();
  ASSERT_EQ(now.patches.size(), 2u);
  for (const Patch& p : now.patches) EXPECT_EQ(p.defect, TopologyDefect::kNone);
  EXPECT_NEAR(now.patches[0].area, now.patches[1].area, 0.15 * now.patches[0].area);
}

TEST(SplitPatch, OpensATorus) {
  Splitter s = bare(shapes::torus(30, 16));
  const int cuts = s.repair();
  EXPECT_GE(cuts, 2);
  EXPECT_LE(cuts, 6);
}

// Genus 2: two square tubes around two holes, from a drawing of the plan and its mirror image below.
TEST(SplitPatch, OpensASurfaceWithTwoHandles) {
  TriangleSoup soup;
  const Drawing plan = drawn("AAAAA/A.A.A/AAAAA");
  const int n = plan.mesh.vertex_count();
  for (int side = 0; side < 2; ++side)
    for (const Vector3& p : plan.mesh.points) soup.points.push_back(p + Vector3(0, 0, side ? 0.0 : 0.5));
  for (const auto& f : plan.mesh.faces) {
    soup.faces.push_back(f);
    soup.faces.push_back({f[0] + n, f[2] + n, f[1] + n});
  }
  for (int e = 0; e < plan.mesh.edge_count(); ++e) {
    const auto& edge = plan.mesh.edges[e];
    if (!edge.border()) continue;
    const auto& f = plan.mesh.faces[edge.f0];
    int a = edge.v0, b = edge.v1;
    for (int k = 0; k < 3; ++k)
      if (f[k] == edge.v1 && f[(k + 1) % 3] == edge.v0) std::swap(a, b);
    soup.faces.push_back({b, a, a + n});
    soup.faces.push_back({b, a + n, b + n});
  }
  Splitter s = bare(soup);
  ASSERT_EQ(s.mesh.vertex_count() - s.mesh.edge_count() + s.mesh.face_count(), -2);
  const int cuts = s.repair();
  EXPECT_GE(cuts, 4);
  EXPECT_LE(cuts, 20);
}

TEST(SplitPatch, SeparatesTheTwoPlacesWhereAPatchTouchesItself) {
  Splitter s(drawn("AAA/ABA/AAB"));
  const int p = s.first_with(TopologyDefect::kTouchesItself);
  ASSERT_GE(p, 0);
  EXPECT_FALSE(s.split(p).empty());
  EXPECT_EQ(s.first_with(TopologyDefect::kTouchesItself), -1);
  EXPECT_EQ(s.layout().patches.size(), 4u);
}

TEST(SplitPatch, LeadsALooseEndToTheNetwork) {
  Splitter s(drawn("AAA|AAA/AAAAAA"));
  s.rules.darts = false;
  const int p = s.first_with(TopologyDefect::kDangling);
  ASSERT_GE(p, 0);
  EXPECT_FALSE(s.split(p).empty());
  EXPECT_EQ(s.first_with(TopologyDefect::kDangling), -1);
}

// ---- by the evaluation

struct Evaluated {
  SearchBed bed;
  LayoutEvaluator evaluator;
  Evaluated(const SurfaceMesh& mesh, const EvaluationParams& params)
      : bed(mesh), evaluator(bed.surface, params, bed.context) {}
};

TEST(SplitPatch, HalvesAPatchWhoseChartSaysNothing) {
  Splitter s(drawn("AAAAAA"));
  auto chart = std::make_shared<PatchChart>(parametrize(s.mesh, s.layout(), s.layout().patches[0], {}));
  for (std::size_t i = 0; i < chart->uv.size(); ++i)
    chart->uv[i] = {std::sin(37.0 * static_cast<double>(i)), std::sin(91.0 * static_cast<double>(i))};
  PatchEvaluation evaluation;
  evaluation.verdict = PatchVerdict::kFolded;
  evaluation.chart = chart;
  s.split(0, evaluation);
  const PatchLayout now = s.layout();
  ASSERT_EQ(now.patches.size(), 2u);
  for (const Patch& p : now.patches) EXPECT_GT(p.area, 0.25 * surface_area(s.mesh));
}

TEST(SplitPatch, SharesCornersUntilNoPatchHasTooManySides) {
  for (const char* text : {".A./AAA/.A.", "A.A.A.A/AAAAAAA", "AAA..../A.AAA../A...AAA"}) {
    Splitter s(drawn(text));
    EvaluationParams params = evaluation_params(0.02);
    params.max_sides = 5;  // with six bends of the border need not count
    Evaluated e(s.mesh, params);
    int cuts = 0, many = 0;
    do {
      const PatchLayout now = s.layout();
      many = -1;
      for (int p = 0; p < static_cast<int>(now.patches.size()) && many < 0; ++p)
        if (e.evaluator.patch(now, p)->verdict == PatchVerdict::kTooManySides) many = p;
      if (many < 0) break;
      std::size_t most = 5;  // before
      for (int p = 0; p < static_cast<int>(now.patches.size()); ++p)
        most = std::max(most, e.evaluator.patch(now, p)->corners.size());
      ASSERT_FALSE(s.split(many, *e.evaluator.patch(now, many)).empty());
      const PatchLayout after = s.layout();
      ASSERT_EQ(after.patches.size(), now.patches.size() + 1);
      for (int p = 0; p < static_cast<int>(after.patches.size()); ++p)
        EXPECT_LE(e.evaluator.patch(after, p)->corners.size(), most) << text;
      ASSERT_LT(++cuts, 12) << text;
    } while (many >= 0);
  }
}

// A cut from the middle of a side to that of another leaves two quads of a quad: with three sides allowed
// that went on down to single faces.
TEST(SplitPatch, CutsAQuadIntoTwoTriangles) {
  for (const char* text : {"AAA/AAA/AAA", "AAAAA/AAAAA"}) {
    Splitter s(drawn(text));
    EvaluationParams params = evaluation_params(0.02);
    params.max_sides = 3;
    Evaluated e(s.mesh, params);
    const PatchLayout before = s.layout();
    const auto quad = e.evaluator.patch(before, 0);
    ASSERT_EQ(quad->verdict, PatchVerdict::kTooManySides);
    ASSERT_EQ(quad->corners.size(), 4u);
    ASSERT_FALSE(s.split(0, *quad).empty());
    const PatchLayout after = s.layout();
    ASSERT_EQ(after.patches.size(), 2u);
    for (int p = 0; p < 2; ++p) EXPECT_EQ(e.evaluator.patch(after, p)->corners.size(), 3u) << text;
  }
}

// The line that shares the corners of a winding patch leaves it: what comes off may not be a face at its end.
TEST(SplitPatch, HalvesWindingPatches) {
  for (const char* text :
       {"AAAAAAA/......A/AAAAAAA/A....../AAAAAAA/......A/AAAAAAA", "A.A.A.A.A/A.A.A.A.A/AAAAAAAAA/A.A.A.A.A",
        "AAAAAAAAA/A......../A.AAAAAAA/A.A.....A/A.A.AAA.A/A.A...A.A/A.AAAAA.A/A.......A/AAAAAAAAA"}) {
    Splitter s(drawn(text));
    EvaluationParams params = evaluation_params(0.02);
    params.max_sides = 3;
    Evaluated e(s.mesh, params);
    const auto winding = e.evaluator.patch(s.layout(), 0);
    ASSERT_GT(winding->corners.size(), 10u) << text;
    ASSERT_FALSE(s.split(0, *winding).empty());
    const PatchLayout after = s.layout();
    ASSERT_EQ(after.patches.size(), 2u);
    for (const Patch& p : after.patches) EXPECT_GT(p.area, 0.15 * surface_area(s.mesh)) << text;
  }
}

Canvas dome_canvas(double k) {
  Canvas dome;
  dome.steps = 20;
  dome.place = [=](double x, double y) {
    return Vector3(x, y, -k / 2 * ((x - 1) * (x - 1) + (y - 0.5) * (y - 0.5)));
  };
  return dome;
}

TEST(SplitPatch, CutsRulingsWhereTheErrorIsLarge) {
  Splitter s(drawn("AA", dome_canvas(0.5)));
  Evaluated e(s.mesh, evaluation_params(0.005));
  const PatchLayout before = s.layout();
  const auto whole = e.evaluator.patch(before, 0);
  ASSERT_EQ(whole->verdict, PatchVerdict::kError);
  ASSERT_FALSE(s.split(0, *whole).empty());
  const PatchLayout now = s.layout();
  ASSERT_EQ(now.patches.size(), 2u);
  for (int p = 0; p < 2; ++p) EXPECT_LT(e.evaluator.patch(now, p)->error, 0.9 * whole->error);
}

TEST(SplitPatch, ErrorFallsWithEveryGenerationOfCuts) {
  Splitter s(drawn("AA", dome_canvas(0.5)));
  Evaluated e(s.mesh, evaluation_params(0.002));
  double first = 0, worst = 0;
  for (int generation = 0; generation < 4; ++generation) {
    const PatchLayout now = s.layout();
    worst = 0;
    std::vector<int> failing;
    for (int p = 0; p < static_cast<int>(now.patches.size()); ++p) {
      const auto known = e.evaluator.patch(now, p);
      ASSERT_TRUE(known->viable() || known->verdict == PatchVerdict::kError) << to_string(known->verdict);
      worst = std::max(worst, known->error);
    }
    if (generation == 0) first = worst;
    std::vector<std::vector<int>> cuts;
    for (int p = 0; p < static_cast<int>(now.patches.size()); ++p)
      if (const auto known = e.evaluator.patch(now, p); !known->viable())
        cuts.push_back(split_patch(s.mesh, now, p, *known));
    for (const auto& edges : cuts) {
      const int path = s.network.add_path(PathKind::kCut);
      for (int edge : edges) s.network.edge_path[edge] = path;
    }
  }
  EXPECT_LT(worst, 0.3 * first);
}

// A flat U whose error is worst halfway between its arms, near their ends: the rulings are said to run along
// them, the cut across them leaves the sheet between the arms and is cheapest at one end of it.
TEST(SplitPatch, LeavesEnoughOnBothSidesWhereItIsAskedTo) {
  const Splitter u(drawn("A.A/A.A/AAA"));
  const PatchLayout layout = u.layout();
  ASSERT_EQ(layout.patches.size(), 1u);
  PatchEvaluation evaluation;
  evaluation.verdict = PatchVerdict::kError;
  auto chart = std::make_shared<PatchChart>(parametrize(u.mesh, layout, layout.patches[0], {}));
  // A flat sheet is its own chart, here from (0, 0) to (3, 3), and the arms end at the top.
  for (std::size_t i = 0; i < chart->uv.size(); ++i)
    chart->uv[i] = u.mesh.points[chart->vertices[i]].head<2>();
  evaluation.chart = chart;
  for (int i = 0; i <= 20; ++i) {
    evaluation.rulings.chords.push_back({2 * i, 2 * i + 1, 0});
    evaluation.polygon.uv.emplace_back(0.15 * i, 2.9);
    evaluation.polygon.uv.emplace_back(0.15 * i, 2.7);
  }
  evaluation.worst = {1.5, 2.8};
  const auto smaller_side = [&](const std::vector<int>& cut) {
    Splitter parted(u.mesh, u.network);
    const int path = parted.network.add_path(PathKind::kCut);
    for (int e : cut) parted.network.edge_path[e] = path;
    const PatchLayout now = parted.layout();
    EXPECT_EQ(now.patches.size(), 2u);
    return std::min(now.patches[0].area, now.patches[1].area) / layout.patches[0].area;
  };
  EXPECT_LT(smaller_side(split_patch(u.mesh, layout, 0, evaluation)), 0.06);
  EXPECT_GT(smaller_side(split_patch(u.mesh, layout, 0, evaluation, nullptr, 0.15)), 0.15);
}

// ---- the ladder ends

class EveryPatch : public ::testing::TestWithParam<const char*> {};
TEST_P(EveryPatch, CanBeSplitDownToSingleTriangles) {
  Canvas canvas;
  canvas.steps = 2;
  Splitter s(drawn(GetParam(), canvas));
  std::size_t patches = 0;
  for (int round = 0; round < 400; ++round) {
    const PatchLayout now = s.layout();
    int large = -1;
    for (int p = 0; p < static_cast<int>(now.patches.size()) && large < 0; ++p)
      if (now.patches[p].faces.size() > 1) large = p;
    if (large < 0) break;
    const TopologyDefect defect = now.patches[large].defect;
    ASSERT_FALSE(s.split(large).empty()) << "round " << round << ", " << now.patches[large].faces.size()
                                         << " faces, defect " << static_cast<int>(defect);
    // A disk falls in two; what is no disk at least gets nearer to one.
    if (defect == TopologyDefect::kNone) {
      EXPECT_GT(s.layout().patches.size(), now.patches.size());
    }
    patches = s.layout().patches.size();
  }
  EXPECT_EQ(patches, s.mesh.faces.size());
}
INSTANTIATE_TEST_SUITE_P(Drawings, EveryPatch,
                         ::testing::Values("A", "AAB/AAC", "AAA/ABA/AAA", "AAA/ABA/AAB", "AA|AA/AAAA",
                                           ".A./AAA/.A.", "AAA/A.A/AAA"));

TEST(SplitPatch, GoesAroundWhereNoCutIsWanted) {
  // The cut of a long sheet runs across its middle; there no cut is wanted over half of the width.
  const Splitter sheet =
      bare(shapes::grid({40, 20}, [](double u, double v) { return Vector3(2 * u, v, 0); }));
  std::vector<char> keep_out(sheet.mesh.edges.size(), 0);
  const auto inside = [&](int v) {
    return std::abs(sheet.mesh.points[v].x() - 1) < 0.12 && std::abs(sheet.mesh.points[v].y() - 0.5) < 0.25;
  };
  for (int e = 0; e < sheet.mesh.edge_count(); ++e)
    keep_out[e] = inside(sheet.mesh.edges[e].v0) || inside(sheet.mesh.edges[e].v1);
  const PatchLayout layout = sheet.layout();
  const auto hits = [&](const std::vector<int>& edges) {
    return std::count_if(edges.begin(), edges.end(), [&](int e) { return keep_out[e] != 0; });
  };
  const std::vector<int> straight = split_patch(sheet.mesh, layout, 0, {});
  EXPECT_GT(hits(straight), 5);
  const std::vector<int> around = split_patch(sheet.mesh, layout, 0, {}, &keep_out);
  EXPECT_FALSE(around.empty());
  EXPECT_EQ(hits(around), 0);
}

}  // namespace
}  // namespace sheetform
