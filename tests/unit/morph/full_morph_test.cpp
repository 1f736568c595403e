#include "sheetform/morph/full_morph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "sheetform/base/error.h"
#include "unit/morph/ruled_scene.h"

namespace sheetform {
namespace {

using Positions = std::vector<Vector3>;

// The same rulings in charts that are isometric to the last digit: the search stops earlier.
FullMorphProblem with_exact_charts(const RuledScene& s) {
  std::vector<PatchChart> charts;
  for (const Patch& patch : s.layout.patches)
    charts.push_back(parametrize(s.surface.mesh, s.layout, patch, {400, 1e-14}));
  auto ruled = s.ruled_patches();
  for (std::size_t p = 0; p < ruled.size(); ++p) ruled[p].chart = &charts[p];
  return full_morph_problem(s.surface.mesh, s.layout, ruled, s.arch_samples, &s.curvature, RunContext{});
}

// Numbers in [-1, 1] from a linear congruence: the same on every machine.
class Noise {
 public:
  double next() {
    state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<double>(state_ >> 11) / 4503599627370496.0 - 1;
  }
  Vector3 vector() {
    const double x = next(), y = next();
    return {x, y, next()};
  }

 private:
  std::uint64_t state_ = 42;
};

Positions shaken(const RuledMesh& mesh, double size) {
  Noise noise;
  Positions x = mesh.rest;
  for (Vector3& p : x) p += size * noise.vector();
  return x;
}

// Eq. (1) to (5) once more, straight from the definitions, without sharing code with the library.
class Naive {
 public:
  Naive(const FullMorphProblem& problem, const Positions& x) : m_(problem.mesh), x_(x) {}

  double approx() const {
    double sum = 0;
    for (int v = 0; v < m_.size(); ++v)
      if (m_.on_ruling[v]) sum += (x_[v] - m_.rest[v]).squaredNorm();
    return sum;
  }
  double anchor() const {
    double sum = 0;
    for (int v = 0; v < m_.size(); ++v) sum += (x_[v] - m_.rest[v]).squaredNorm();
    return sum;
  }
  double straight_triplets() const {
    double sum = 0;
    for (const auto& r : m_.rulings)
      for (std::size_t j = 1; j + 1 < r.vertices.size(); ++j) {
        const int a = r.vertices[j - 1], b = r.vertices[j], c = r.vertices[j + 1];
        const double alpha = along(r, c, b) / along(r, c, a);
        sum += (alpha * x_[a] + (1 - alpha) * x_[c] - x_[b]).squaredNorm();
      }
    return sum;
  }
  double straight_chords() const {
    double sum = 0;
    for (const auto& r : m_.rulings)
      for (int v : r.vertices) {
        const int a = r.vertices.front(), b = r.vertices.back();
        if (v == a || v == b) continue;
        const double s = along(r, v, a) / along(r, b, a);
        sum += ((1 - s) * x_[a] + s * x_[b] - x_[v]).squaredNorm();
      }
    return sum;
  }
  double seams() const {
    double sum = 0;
    std::set<std::pair<int, int>> done;
    for (const auto& a : m_.sides)
      for (const auto& b : m_.sides)
        for (std::size_t k = 0; &a < &b && a.arch == b.arch && k < a.vertices.size(); ++k)
          if (done.insert(std::minmax(a.vertices[k], b.vertices[k])).second)
            sum += (x_[a.vertices[k]] - x_[b.vertices[k]]).squaredNorm();
    return sum;
  }
  double smooth() const {
    double sum = 0;
    for (const auto& side : m_.sides)
      for (std::size_t k = 1; k + 1 < side.vertices.size(); ++k)
        sum += bend(side.vertices[k - 1], side.vertices[k], side.vertices[k + 1]).squaredNorm();
    return sum;
  }
  // Over vertices that are neither on a ruling nor, unless asked for, on the outline.
  double laplace(bool outline) const {
    std::vector<std::map<int, double>> weight(m_.size());
    for (const auto& t : m_.triangles)
      for (int k = 0; k < 3; ++k) {
        const int c = t[k], a = t[(k + 1) % 3], b = t[(k + 2) % 3];
        const Vector2 u = m_.uv[a] - m_.uv[c], v = m_.uv[b] - m_.uv[c];
        const double cot = 1 / std::tan(std::atan2(cross(u, v), u.dot(v)));
        weight[a][b] += cot;
        weight[b][a] += cot;
      }
    double sum = 0;
    for (int v = 0; v < m_.size(); ++v) {
      if (m_.on_ruling[v] || (m_.on_border[v] && !outline)) continue;
      Vector3 mean = Vector3::Zero();
      double total = 0;
      for (const auto& [n, w] : weight[v]) mean += w * x_[n], total += w;
      sum += (x_[v] - mean / total).squaredNorm();
    }
    return sum;
  }
  double flat() const {
    double sum = 0;
    for (std::size_t r = 1; r + 1 < m_.rulings.size(); ++r) {
      const auto &before = m_.rulings[r - 1], &here = m_.rulings[r], &after = m_.rulings[r + 1];
      if (before.patch != here.patch || after.patch != here.patch) continue;
      for (int v : here.vertices) {
        const Vector2 d = m_.uv[here.vertices.back()] - m_.uv[here.vertices.front()];
        Vector2 ui, uk;
        Vector3 xi, xk;
        if (!foot(before, m_.uv[v], d, ui, xi) || !foot(after, m_.uv[v], d, uk, xk)) continue;
        const double di = cross(d.normalized(), ui - m_.uv[v]), dk = cross(d.normalized(), uk - m_.uv[v]);
        if (di * dk >= 0 || std::min(std::abs(di), std::abs(dk)) < 1e-3 * (std::abs(di) + std::abs(dk)))
          continue;
        const double alpha = std::abs(dk) / (std::abs(di) + std::abs(dk));
        sum += m_.isotropy[v] * (alpha * xi + (1 - alpha) * xk - x_[v]).squaredNorm();
      }
    }
    return sum;
  }
  /// Eq. (5) with planarity off.
  double total(const FullMorphWeights& w) const {
    return w.approx * approx() + w.laplace * laplace(false) + w.straight * straight_triplets() +
           w.seams * seams() + w.smooth * smooth() + w.flat * flat() + w.anchor * anchor();
  }

 private:
  double along(const RuledMesh::Ruling& r, int a, int b) const {
    return (m_.uv[a] - m_.uv[b]).dot(m_.uv[r.vertices.back()] - m_.uv[r.vertices.front()]);
  }
  Vector3 bend(int i, int j, int k) const {
    const double a = (m_.rest[j] - m_.rest[i]).norm(), b = (m_.rest[k] - m_.rest[j]).norm();
    return (b * x_[i] + a * x_[k]) / (a + b) - x_[j];
  }
  // Where the perpendicular through u meets a ruling.
  bool foot(const RuledMesh::Ruling& r, const Vector2& u, const Vector2& d, Vector2& uv, Vector3& x) const {
    const Vector2 from = m_.uv[r.vertices.front()], to = m_.uv[r.vertices.back()];
    if (std::abs((to - from).dot(d)) < 0.1 * (to - from).norm() * d.norm()) return false;
    const double s = (u - from).dot(d) / (to - from).dot(d);
    for (std::size_t k = 0; k + 1 < r.at.size(); ++k) {
      if (s < r.at[k] || s > r.at[k + 1]) continue;
      const double t = (s - r.at[k]) / (r.at[k + 1] - r.at[k]);
      const int a = r.vertices[k], b = r.vertices[k + 1];
      uv = (1 - t) * m_.uv[a] + t * m_.uv[b];
      x = (1 - t) * x_[a] + t * x_[b];
      return true;
    }
    return false;
  }
  const RuledMesh& m_;
  const Positions& x_;
};

void expect_close(double a, double b, double relative = 1e-9) {
  EXPECT_NEAR(a, b, relative * std::max(a, b));
}

// A quarter of a tube with rulings along its axis, `count` of them between the two straight sides.
FullMorphProblem tube_problem(const SurfaceMesh& mesh, int count, const std::vector<int>& versions) {
  const PatchLayout layout = extract_layout(mesh, bare_network(mesh), versions, {});
  const Patch& patch = layout.patches[0];
  const PatchChart chart = parametrize(mesh, layout, patch, {50, 1e-9});
  RuledPatch ruled{&chart, {}};
  std::vector<std::vector<double>> samples;
  std::vector<int> round;  // uses of the two arches along which z stays
  for (const Arch& a : layout.arches) samples.push_back(sample_arch(mesh, a, a.length / (count + 1)));
  for (int u = 0; u < 4; ++u) {
    const Arch& a = layout.arches[patch.boundary[u].arch];
    if (mesh.points[a.vertices.front()].z() == mesh.points[a.vertices.back()].z()) round.push_back(u);
  }
  const ArchUse low = patch.boundary[round[0]], high = patch.boundary[round[1]];
  const auto angle = [&](int arch, double at) {
    const Vector3 p = arch_point(mesh, layout.arches[arch], at);
    return std::atan2(p.y(), p.x());
  };
  for (int s = 1; s <= count; ++s)
    for (double at : samples[high.arch])
      if (std::abs(angle(high.arch, at) - angle(low.arch, samples[low.arch][s])) < 1e-9)
        ruled.lines.push_back({{round[0], samples[low.arch][s]}, {round[1], at}});
  RunContext context;
  return full_morph_problem(mesh, layout, {ruled}, samples, nullptr, context);
}

TEST(FullMorphEnergy, EachTermIsWhatItsDefinitionSays) {
  for (const RuledScene* s : {&torus_sections(), &saddle_parts()}) {
    const Positions x = shaken(s->problem.mesh, 0.01);
    const Naive naive(s->problem, x);
    FullMorphWeights w;
    w.planarity = OutlinePlanarity::kOff;
    const FullMorphEnergy off = full_morph_energy(s->problem, w, x);
    expect_close(off.approx, naive.approx());
    expect_close(off.anchor, naive.anchor());
    expect_close(off.straight, naive.straight_triplets());
    expect_close(off.seams, naive.seams());
    expect_close(off.smooth, naive.smooth());
    expect_close(off.laplace, naive.laplace(false), 1e-7);
    expect_close(off.flat, naive.flat());
    expect_close(off.total, naive.total(w), 1e-7);
    w.planarity = OutlinePlanarity::kOneSided;
    expect_close(full_morph_energy(s->problem, w, x).laplace, naive.laplace(true), 1e-7);
    w.straightness = Straightness::kChords;
    expect_close(full_morph_energy(s->problem, w, x).straight, naive.straight_chords());
  }
}

TEST(FullMorphEnergy, BendsOfTheSurfaceAreFreeWhenTheyAreTheTarget) {
  const auto& problem = torus_sections().problem;
  FullMorphWeights w;
  w.smooth_target = w.flat_target = BendTarget::kRest;
  const FullMorphEnergy rest = full_morph_energy(problem, w, problem.mesh.rest);
  EXPECT_LT(rest.smooth + rest.flat, 1e-28);
  const FullMorphEnergy straight = full_morph_energy(problem, {}, problem.mesh.rest);
  EXPECT_GT(straight.smooth, 1e-7);
  EXPECT_GT(straight.flat, 1e-7);
  // Between two positions both kinds differ by the surface's own bend: the quadratic parts agree.
  const Positions x = shaken(problem.mesh, 0.01);
  Positions step = x;
  for (std::size_t v = 0; v < x.size(); ++v) step[v] -= problem.mesh.rest[v];
  expect_close(full_morph_energy(problem, w, x).flat, full_morph_energy(problem, {}, step).flat);
  expect_close(full_morph_energy(problem, w, x).smooth, full_morph_energy(problem, {}, step).smooth);
}

// Any affine image of the charts costs nothing but its way: eq. 2, 3 and E_flat ask for planes and lines
// alone.
TEST(FullMorphEnergy, AffineImagesOfTheChartsAreFree) {
  const auto& problem = torus_sections().problem;
  Positions x;
  for (const Vector2& u : problem.mesh.uv)
    x.emplace_back(2 * u.x() + u.y() + 1, u.x() - u.y(), 3 * u.y() - 2);
  for (Straightness kind : {Straightness::kTriplets, Straightness::kChords}) {
    FullMorphWeights w;
    w.straightness = kind;
    const FullMorphEnergy e = full_morph_energy(problem, w, x);
    // Crossings that were moved lie up to a thousandth of an edge beside their ruling.
    EXPECT_LT(e.straight, 1e-6);
    EXPECT_LT(e.flat, 1e-6);
    EXPECT_LT(e.laplace, 1e-20);
    w.planarity = OutlinePlanarity::kOneSided;
    EXPECT_GT(full_morph_energy(problem, w, x).laplace, 1e-4);
  }
}

TEST(FullMorph, TheGradientVanishesAtTheSolution) {
  for (const RuledScene* s : {&torus_sections(), &saddle_parts()}) {
    FullMorphWeights w;
    w.planarity = OutlinePlanarity::kOff;
    RunContext context;
    const FullMorphResult result = full_morph(s->problem, w, context);
    const double least = Naive(s->problem, result.position).total(w);
    expect_close(least, result.energy.total, 1e-6);
    Noise noise;
    for (int round = 0; round < 6; ++round) {
      Positions forth = result.position, back = result.position;
      for (std::size_t v = 0; v < forth.size(); ++v) {
        const Vector3 d = 1e-4 * noise.vector();
        forth[v] += d, back[v] -= d;
      }
      const double up = Naive(s->problem, forth).total(w), down = Naive(s->problem, back).total(w);
      EXPECT_GT(up, least);
      EXPECT_GT(down, least);
      // A quadratic: up - down is twice the directional derivative, up + down - 2 least the curvature.
      EXPECT_LT(std::abs(up - down), 1e-6 * (up + down - 2 * least));
    }
  }
}

TEST(FullMorph, APlaneStaysWhereItIs) {
  const RunContext context;
  const FullMorphProblem problem = with_exact_charts(flat_parts());
  EXPECT_LT(largest(full_morph(problem, {}, context).displacement), 1e-6);
  EXPECT_LT(largest(full_morph(problem, resolution_independent_weights(), context).displacement), 1e-6);
  // With eq. 3 as printed the outline is pulled in, though nothing has to move (method.md 0.3).
  FullMorphWeights w;
  w.planarity = OutlinePlanarity::kOneSided;
  EXPECT_GT(largest(full_morph(problem, w, context).displacement), 1e-3);
}

// The paper's weights ask E_flat and E_smooth for no bend at all: what the ends of the tube give in to that
// is of the order of the sagitta between two rulings, and a quarter of it with twice the rulings.
TEST(FullMorph, ATubeWithRulingsAlongItsAxisStaysWhereItIs) {
  TriangleSoup soup = shapes::cylinder_patch(30, 20);
  const double diagonal = bounding_box_diagonal(soup.points);
  for (Vector3& p : soup.points) p /= diagonal;
  const SurfaceMesh mesh = build_surface_mesh(soup.points, soup.faces);
  const std::vector<int> versions(mesh.points.size(), 0);
  const RunContext context;
  double before = 4e-3;
  for (int count : {14, 29}) {
    const FullMorphProblem problem = tube_problem(mesh, count, versions);
    ASSERT_EQ(problem.mesh.rulings.size(), static_cast<std::size_t>(count));
    ASSERT_EQ(problem.dropped, 0);
    const FullMorphResult paper = full_morph(problem, {}, context);
    EXPECT_LT(paper.ruling_displacement[0], before / 2);
    EXPECT_LT(paper.bow, 3e-5);
    before = paper.ruling_displacement[0];
    EXPECT_LT(full_morph(problem, resolution_independent_weights(), context).ruling_displacement[0], 1e-5);
  }
}

TEST(FullMorph, SeamsCloseAsTheirWeightGrows) {
  const RunContext context;
  double before = 1;
  for (double weight : {1.0, 1e2, 1e4, 1e6}) {
    FullMorphWeights w;
    w.seams = weight;
    const double gap = full_morph(torus_sections().problem, w, context).gap;
    EXPECT_LT(gap, weight > 1e2 ? before / 10 : weight > 1 ? before / 5 : 0.04);
    before = gap;
  }
  EXPECT_LT(before, 1e-6);
}

// Triplets bow with about the third to fourth power of the number of vertices, chords do not (method.md 9.2).
// Outlines are sampled where the mesh has vertices, so that both meshes get rulings of the same kind.
TEST(FullMorph, RulingsAreStraightToTheDocumentedBow) {
  const RunContext context;
  std::vector<double> triplets, chords;
  for (int n : {1, 2}) {
    GridCuts cuts{{32 * n, 16 * n, true, true}, {}, {}};
    for (int i = 0; i < 8; ++i) cuts.columns.push_back(4 * n * i);
    for (int j = 0; j < 4; ++j) cuts.rows.push_back(4 * n * j);
    const RuledScene s(shapes::torus(32 * n, 16 * n), cuts, 0.025);
    triplets.push_back(full_morph(s.problem, {}, context).bow);
    chords.push_back(full_morph(s.problem, resolution_independent_weights(), context).bow);
    FullMorphWeights stiff;
    stiff.straight = 1e7;
    EXPECT_LT(full_morph(s.problem, stiff, context).bow, 0.7 * triplets.back());
  }
  EXPECT_LT(triplets[0], 3e-3);
  EXPECT_GT(triplets[1], 3.5 * triplets[0]);
  EXPECT_LT(chords[0], 3e-5);
  EXPECT_LT(chords[1], 3e-5);
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const auto n = static_cast<double>(a.size());
  double ma = 0, mb = 0, ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < a.size(); ++i) ma += a[i] / n, mb += b[i] / n;
  for (std::size_t i = 0; i < a.size(); ++i)
    ab += (a[i] - ma) * (b[i] - mb), aa += (a[i] - ma) * (a[i] - ma), bb += (b[i] - mb) * (b[i] - mb);
  return ab / std::sqrt(aa * bb);
}

// Largest distance of one patch's strips over these outlines from the surface, per patch.
std::vector<double> distances(const RuledScene& s,
                              const std::function<Vector3(std::size_t, int)>& outline_point) {
  std::vector<double> worst;
  for (std::size_t p = 0; p < s.patches.size(); ++p) {
    const PatchEvaluation& e = *s.patches[p];
    Positions x;
    for (int i = 0; i < e.polygon.size(); ++i) x.push_back(outline_point(p, i));
    worst.push_back(patch_error(e.samples, e.rulings.triangles, x, s.tree, 0, nullptr));
  }
  return worst;
}

// Measured: 0.69 to 1.68. The reduced morph weighs its samples by area and keeps seams and rulings exact; the
// paper's sums count every vertex once and give in a little everywhere.
TEST(FullMorph, AgreesWithTheReducedMorph) {
  const RunContext context;
  for (const RuledScene* s : {&torus_sections(), &saddle_parts()})
    for (const FullMorphWeights& w : {FullMorphWeights{}, resolution_independent_weights()}) {
      const FullMorphResult full = full_morph(s->problem, w, context);
      const std::vector<double> reduced = s->reduced_displacement();
      for (std::size_t p = 0; p < reduced.size(); ++p) {
        EXPECT_GT(reduced[p], 0.55 * full.ruling_displacement[p]);
        EXPECT_LT(reduced[p], 2.0 * full.ruling_displacement[p]);
      }
      if (s == &torus_sections()) {
        EXPECT_GT(correlation(full.ruling_displacement, reduced), 0.8);
      }
    }
}

TEST(FullMorph, ItsArchesCanReplaceThoseOfTheReducedMorph) {
  const RuledScene& s = torus_sections();
  const FullMorphResult full = full_morph(s.problem, {}, RunContext{});
  const auto by_full = distances(s, [&](std::size_t p, int i) {
    const auto& origin = s.patches[p]->polygon.origin[i];
    return full.arch_points[s.layout.patches[p].boundary[origin.use].arch][origin.sample];
  });
  const auto by_reduced =
      distances(s, [&](std::size_t p, int i) { return s.reduced.position[s.reduced.unknowns[p][i]]; });
  const auto at_rest = distances(s, [&](std::size_t p, int i) { return s.patches[p]->polygon.point[i]; });
  EXPECT_LT(largest(by_full), 1.5 * largest(by_reduced));
  EXPECT_LT(largest(by_full), 0.8 * largest(at_rest));
  EXPECT_GT(correlation(by_full, by_reduced), 0.8);
}

TEST(FullMorph, ANodeIsOnePointOfAllItsArches) {
  const RuledScene& s = torus_sections();
  const FullMorphResult full = full_morph(s.problem, {}, RunContext{});
  std::map<int, Vector3> node;
  for (std::size_t a = 0; a < s.layout.arches.size(); ++a) {
    ASSERT_EQ(full.arch_points[a].size(), s.arch_samples[a].size());
    const Arch& arch = s.layout.arches[a];
    for (const auto& [v, x] : {std::pair{arch.vertices.front(), full.arch_points[a].front()},
                               std::pair{arch.vertices.back(), full.arch_points[a].back()}})
      EXPECT_EQ(node.emplace(v, x).first->second, x);
  }
}

TEST(FullMorph, PatchesLeftOutDoNotMoveTheOthersAndHeldArchesStay) {
  const RuledScene& s = torus_sections();
  const RunContext context;
  auto ruled = s.ruled_patches();
  for (std::size_t p = 1; p < ruled.size(); ++p) ruled[p].chart = nullptr;
  FullMorphProblem problem =
      full_morph_problem(s.surface.mesh, s.layout, ruled, s.arch_samples, &s.curvature, context);
  EXPECT_TRUE(problem.seams.empty());
  const FullMorphResult free = full_morph(problem, {}, context);
  EXPECT_EQ(free.patch_displacement[1], 0);
  EXPECT_GT(free.patch_displacement[0], 1e-3);
  const Vector3 shift(0, 0, 0.02);
  std::vector<int> own;
  for (const ArchUse& use : s.layout.patches[0].boundary) own.push_back(use.arch);
  for (int a : own) {
    problem.held[a] = problem.arch_rest[a];
    for (Vector3& x : problem.held[a]) x += shift;
  }
  FullMorphWeights firm;
  firm.seams = 1e6;
  const FullMorphResult held = full_morph(problem, firm, context);
  for (std::size_t a = 0; a < problem.held.size(); ++a)
    EXPECT_EQ(held.arch_points[a].empty(),
              std::find(own.begin(), own.end(), static_cast<int>(a)) == own.end());
  for (const auto& side : problem.mesh.sides)
    for (std::size_t k = 0; k < problem.arch_stop[side.arch].size(); ++k) {
      const int v = side.vertices[problem.arch_stop[side.arch][k]];
      EXPECT_LT((held.position[v] - problem.mesh.rest[v] - shift).norm(), 1e-3);
    }
  problem.held[own[0]].pop_back();
  EXPECT_THROW(full_morph(problem, {}, context), Error);
}

TEST(FullMorph, APatchWithoutRulingsIsHeldByItsOutline) {
  const RuledScene& s = flat_parts();
  auto ruled = s.ruled_patches();
  for (RuledPatch& r : ruled) r.lines.clear();
  const RunContext context;
  const auto problem = full_morph_problem(s.surface.mesh, s.layout, ruled, s.arch_samples, nullptr, context);
  const FullMorphResult result = full_morph(problem, {}, context);
  for (int v = 0; v < problem.mesh.size(); ++v)
    if (problem.mesh.on_border[v]) {
      EXPECT_LT(result.displacement[v], 1e-9);
    }
  EXPECT_EQ(result.energy.straight, 0);
}

TEST(FullMorph, IsTheSameAtAnyScaleAndPlace) {
  const auto& problem = saddle_parts().problem;
  FullMorphProblem moved = problem;
  const Eigen::Quaterniond turn = Eigen::Quaterniond(0.8, 0.2, -0.4, 0.4).normalized();
  for (Vector3& x : moved.mesh.rest) x = 1000 * (turn * x) + Vector3(5, -7, 11);
  for (auto& arch : moved.arch_rest)
    for (Vector3& x : arch) x = 1000 * (turn * x) + Vector3(5, -7, 11);
  const RunContext context;
  const FullMorphResult a = full_morph(problem, {}, context), b = full_morph(moved, {}, context);
  for (int v = 0; v < problem.mesh.size(); ++v)
    EXPECT_LT((1000 * (turn * a.position[v]) + Vector3(5, -7, 11) - b.position[v]).norm(), 1e-5);
}

TEST(FullMorph, BadWeightsAreRefused) {
  const RunContext context;
  for (double bad : {-1.0, std::nan(""), HUGE_VAL}) {
    FullMorphWeights w;
    w.flat = bad;
    EXPECT_THROW(full_morph(flat_parts().problem, w, context), Error);
  }
  FullMorphWeights loose;
  loose.approx = loose.anchor = 0;
  EXPECT_THROW(full_morph(flat_parts().problem, loose, context), Error);
  EXPECT_THROW(full_morph_energy(flat_parts().problem, {}, {}), Error);
}

TEST(FullMorph, StopsWhenAsked) {
  const std::atomic<bool> stop{true};
  RunContext context;
  context.cancelled = &stop;
  EXPECT_THROW(full_morph(flat_parts().problem, {}, context), Error);
  const RuledScene& s = flat_parts();
  EXPECT_THROW(
      full_morph_problem(s.surface.mesh, s.layout, s.ruled_patches(), s.arch_samples, nullptr, context),
      Error);
}

}  // namespace
}  // namespace sheetform
