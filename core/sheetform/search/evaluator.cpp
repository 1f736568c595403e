#include "sheetform/search/evaluator.h"

#include <algorithm>
#include <cmath>

#include "sheetform/strip/unfold.h"

namespace sheetform {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr int kChordSamples = 5;

double cross(const Vector2& a, const Vector2& b) { return a.x() * b.y() - a.y() * b.x(); }

std::array<double, 3> barycentric(const Vector2& a, const Vector2& b, const Vector2& c, const Vector2& p) {
  const double whole = cross(b - a, c - a);
  if (std::abs(whole) < 1e-300) return {1, 0, 0};
  const double v = cross(p - a, c - a) / whole, w = cross(b - a, p - a) / whole;
  return {1 - v - w, v, w};
}

// Nodes where the outline turns: by more than `turn` degrees where two paths meet, by more than 50 along one path.
std::vector<int> find_corners(const PatchLayout& layout, const Patch& patch, const PatchPolygon& polygon, double turn, bool every_node) {
  std::vector<int> corners;
  const int n = polygon.size();
  for (int i = 0; i < n; ++i) {
    if (!polygon.node[i]) continue;
    const int before = (i + n - 1) % n;
    const Vector2 in = polygon.uv[i] - polygon.uv[before], out = polygon.uv[(i + 1) % n] - polygon.uv[i];
    const double angle = std::abs(std::atan2(cross(in, out), in.dot(out)));
    const auto path = [&](int k) { return layout.arches[patch.boundary[polygon.origin[k].use].arch].path; };
    const double limit = path(i) != path(before) ? turn : std::max(turn, 50.0);
    if (every_node || angle > limit * kDegree) corners.push_back(i);
  }
  return corners;
}

// Which strip triangle covers each cell of the chart's raster.
std::vector<int> strip_cells(const ChartRaster& raster, const PatchPolygon& polygon, const RulingSet& rulings) {
  std::vector<int> cells(static_cast<std::size_t>(raster.columns()) * raster.rows(), -1);
  const double step = raster.cell() * 0.7;
  for (std::size_t t = 0; t < rulings.triangles.size(); ++t) {
    const auto& v = rulings.triangles[t];
    const Vector2 &a = polygon.uv[v[0]], &b = polygon.uv[v[1]], &c = polygon.uv[v[2]];
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const int n = std::max(1, static_cast<int>(std::ceil(longest / step)));
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        const int cell = raster.cell_of(a + (b - a) * i / n + (c - a) * j / n);
        if (cell >= 0 && cells[cell] < 0) cells[cell] = static_cast<int>(t);
      }
  }
  return cells;
}

int nearest_cell(const std::vector<int>& cells, const ChartRaster& raster, const Vector2& u) {
  const int at = raster.cell_of(u);
  if (at < 0) return -1;
  if (cells[at] >= 0) return cells[at];
  const int columns = raster.columns(), x0 = at % columns, y0 = at / columns;
  for (int r = 1; r <= 4; ++r)
    for (int y = std::max(0, y0 - r); y <= std::min(raster.rows() - 1, y0 + r); ++y)
      for (int x = std::max(0, x0 - r); x <= std::min(columns - 1, x0 + r); ++x) {
        if (std::max(std::abs(x - x0), std::abs(y - y0)) != r) continue;
        const int t = cells[static_cast<std::size_t>(y) * columns + x];
        if (t >= 0) return t;
      }
  return -1;
}

// Both ends of every chord count too: outline points that were free of data would overshoot.
void chord_samples(const ChartRaster& raster, double area, PatchEvaluation& e) {
  auto add = [&](int a, int b, double t, double weight) {
    const Vector2 u = (1 - t) * e.polygon.uv[a] + t * e.polygon.uv[b];
    const int triangle = raster.triangle_at(u);
    if (triangle < 0) return;
    MorphSample s;
    s.unknown = {a, b, a};
    s.coefficient = {1 - t, t, 0};
    s.target = t == 0 ? e.polygon.point[a] : t == 1 ? e.polygon.point[b] : raster.lift(triangle, u);
    s.normal = raster.normal(triangle);
    s.weight = weight;
    e.samples.push_back(s);
  };
  for (const auto& chord : e.rulings.chords)
    for (int k = 0; k < kChordSamples; ++k) {
      const double share = (k == 0 || k == kChordSamples - 1 ? 0.5 : 1.0) / (kChordSamples - 1);
      add(chord.a, chord.b, static_cast<double>(k) / (kChordSamples - 1), std::max(chord.area, 1e-9) * share);
    }
  for (int i = 0; i < e.polygon.size(); ++i) add(i, i, 0, 0.02 * area / e.polygon.size());
}

// Every vertex of the patch against the strip triangle above it: bulges and tips outside of all rulings are seen.
void coverage_samples(const SearchSurface& surface, const ChartRaster& raster, PatchEvaluation& e) {
  const auto cells = strip_cells(raster, e.polygon, e.rulings);
  const PatchChart& chart = *e.chart;
  for (std::size_t v = 0; v < chart.vertices.size(); ++v) {
    const int t = nearest_cell(cells, raster, chart.uv[v]);
    if (t < 0) continue;
    const auto& tri = e.rulings.triangles[t];
    auto w = barycentric(e.polygon.uv[tri[0]], e.polygon.uv[tri[1]], e.polygon.uv[tri[2]], chart.uv[v]);
    double sum = 0;
    for (double& x : w) sum += x = std::clamp(x, 0.0, 1.0);
    for (double& x : w) x /= sum;
    MorphSample s;
    s.unknown = tri;
    s.coefficient = w;
    s.target = surface.mesh.points[chart.vertices[v]];
    s.patch = t;  // reused below as the index of the triangle
    e.samples.push_back(s);
  }
}

std::uint64_t point_key(const PatchLayout& layout, const Patch& patch, const PatchPolygon::Origin& origin, int samples) {
  const int a = patch.boundary[origin.use].arch;
  const Arch& arch = layout.arches[a];
  if (origin.sample == 0) return (1ull << 63) | static_cast<unsigned>(arch.vertices.front());
  if (origin.sample == samples - 1) return (1ull << 63) | static_cast<unsigned>(arch.vertices.back());
  return (static_cast<std::uint64_t>(a) << 32) | static_cast<unsigned>(origin.sample);
}

double anchor_weight(const Arch& arch) { return arch.right == Arch::kOutside || arch.left == Arch::kOutside ? 0.3 : 0.02; }

// Consecutive points of the same arch around polygon point i, or false.
bool inside_arch(const PatchPolygon& polygon, int i) { return !polygon.node[i]; }

double point_triangle2(const Vector3& p, const Vector3& a, const Vector3& b, const Vector3& c) {
  // Ericson, Real-Time Collision Detection, 5.1.5.
  const Vector3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return ap.squaredNorm();
  const Vector3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return bp.squaredNorm();
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return (ap - d1 / (d1 - d3) * ab).squaredNorm();
  const Vector3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return cp.squaredNorm();
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return (ap - d2 / (d2 - d6) * ac).squaredNorm();
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return (bp - (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b)).squaredNorm();
  const double sum = va + vb + vc;
  return (ap - ab * (vb / sum) - ac * (vc / sum)).squaredNorm();
}

// From a surface point to the strips of its patch.
double to_strips(const MorphSample& s, const std::vector<std::array<int, 3>>& triangles, const std::vector<Vector3>& position) {
  const int n = static_cast<int>(triangles.size());
  double best = (s.at(position) - s.target).squaredNorm();
  for (int t = 0; t < n; ++t)
    best = std::min(best, point_triangle2(s.target, position[triangles[t][0]], position[triangles[t][1]], position[triangles[t][2]]));
  return std::sqrt(best);
}

}  // namespace

const char* to_string(PatchVerdict verdict) {
  switch (verdict) {
    case PatchVerdict::kViable: return "viable";
    case PatchVerdict::kNotADisk: return "not a disk";
    case PatchVerdict::kTouches: return "touches itself";
    case PatchVerdict::kTooManySides: return "too many sides";
    case PatchVerdict::kFolded: return "folded chart";
    case PatchVerdict::kNoRulings: return "no rulings";
    case PatchVerdict::kOverlap: return "overlaps when flat";
    case PatchVerdict::kError: return "error above tolerance";
  }
  return "";
}

double patch_error(const std::vector<MorphSample>& samples, const std::vector<std::array<int, 3>>& triangles,
                   const std::vector<Vector3>& position, const ClosestPointTree& input, double limit, Vector3* place) {
  double worst = 0;
  for (const MorphSample& s : samples) {
    const Vector3 x = s.at(position);
    double d = (x - s.target).norm();
    if (d > limit) {
      if (s.weight > 0) {
        // The target lies on the working mesh, the input is a little off: hence the slack.
        const ClosestPoint hit = input.closest(x, (d + 2e-3) * (d + 2e-3));
        if (hit.face >= 0) d = std::min(d, std::sqrt(hit.squared_distance));
      } else {
        d = to_strips(s, triangles, position);
      }
    }
    if (d > worst) {
      worst = d;
      if (place != nullptr) *place = s.target;
    }
  }
  return worst;
}

std::shared_ptr<const PatchEvaluation> LayoutEvaluator::patch(const PatchLayout& layout, int p) {
  const Patch& patch = layout.patches[p];
  {
    const std::lock_guard lock(mutex_);
    const auto it = cache_.find(patch.key);
    if (it != cache_.end()) return ++hits_, it->second;
  }
  context_.checkpoint();
  auto result = compute(layout, patch, nullptr);
  const std::lock_guard lock(mutex_);
  ++evaluations_;
  return cache_.emplace(patch.key, std::move(result)).first->second;
}

std::vector<std::shared_ptr<const PatchEvaluation>> LayoutEvaluator::patches(const PatchLayout& layout) {
  std::vector<std::shared_ptr<const PatchEvaluation>> all(layout.patches.size());
  parallel_for(context_, static_cast<int>(all.size()), [&](int p) { all[p] = patch(layout, p); });
  return all;
}

std::shared_ptr<const PatchEvaluation> LayoutEvaluator::compute(const PatchLayout& layout, const Patch& patch,
                                                                const std::function<bool(int, int)>* forbidden) const {
  auto e = std::make_shared<PatchEvaluation>();
  if (patch.defect != TopologyDefect::kNone) {
    e->verdict = patch.defect == TopologyDefect::kNotADisk ? PatchVerdict::kNotADisk : PatchVerdict::kTouches;
    return e;
  }
  auto chart = std::make_shared<PatchChart>(parametrize(surface_.mesh, layout, patch, {}));
  e->chart = chart;
  std::vector<std::vector<double>> samples(layout.arches.size());
  for (const ArchUse& use : patch.boundary)
    if (samples[use.arch].empty()) samples[use.arch] = sample_arch(surface_.mesh, layout.arches[use.arch], params_.spacing);
  e->polygon = patch_polygon(surface_.mesh, layout, patch, *chart, samples);
  e->corners = find_corners(layout, patch, e->polygon, params_.corner_turn, !params_.t_junctions);
  if (static_cast<int>(e->corners.size()) > params_.max_sides) return e->verdict = PatchVerdict::kTooManySides, e;
  if (chart->folded > 0.02 || !simple_outline(e->polygon.uv, 0)) return e->verdict = PatchVerdict::kFolded, e;
  const ChartRaster raster(surface_.mesh, surface_.guide, patch, *chart, 3000);
  RulingParams ruling = params_.ruling;
  ruling.e_max = params_.e_max;
  e->rulings = best_rulings(e->polygon, raster, ruling, forbidden);
  if (!e->rulings.found) return e->verdict = PatchVerdict::kNoRulings, e;
  chord_samples(raster, patch.area, *e);
  coverage_samples(surface_, raster, *e);

  // The patch alone: every outline point is free.
  MorphProblem problem;
  const int n = e->polygon.size();
  std::vector<std::pair<std::uint64_t, int>> keys(n);
  for (int i = 0; i < n; ++i)
    keys[i] = {point_key(layout, patch, e->polygon.origin[i], static_cast<int>(samples[patch.boundary[e->polygon.origin[i].use].arch].size())), i};
  std::sort(keys.begin(), keys.end());
  std::vector<int> unknown(n, -1);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (i == 0 || keys[i].first != keys[i - 1].first) {
      problem.rest.push_back(e->polygon.point[keys[i].second]);
      problem.anchor.push_back(0.02);
    }
    unknown[keys[i].second] = static_cast<int>(problem.rest.size()) - 1;
  }
  for (int i = 0; i < n; ++i)
    if (inside_arch(e->polygon, i)) problem.stencils.push_back({unknown[(i + n - 1) % n], unknown[i], unknown[(i + 1) % n]});
  problem.samples = e->samples;
  for (MorphSample& s : problem.samples)
    for (int& u : s.unknown) u = unknown[u];
  MorphParams morph_params = params_.morph;
  morph_params.stop_below = 0.7 * params_.e_max;
  const MorphResult result = morph(problem, morph_params);
  std::vector<Vector3> position(n);
  for (int i = 0; i < n; ++i) position[i] = result.position[unknown[i]];
  e->error = patch_error(e->samples, e->rulings.triangles, position, *surface_.input, 0.8 * params_.e_max, nullptr);
  if (!simple_outline(unfold(position, e->rulings.triangles), 1e-7)) return e->verdict = PatchVerdict::kOverlap, e;
  e->verdict = e->error > params_.e_max ? PatchVerdict::kError : PatchVerdict::kViable;
  return e;
}

std::shared_ptr<const PatchEvaluation> LayoutEvaluator::patch_avoiding(const PatchLayout& layout, int p,
                                                                       const std::function<bool(int, int)>& forbidden) const {
  return compute(layout, layout.patches[p], &forbidden);
}

LayoutEvaluation LayoutEvaluator::solve(const PatchLayout& layout, std::vector<std::shared_ptr<const PatchEvaluation>> patches,
                                        int rounds) {
  LayoutEvaluation out;
  out.patches = std::move(patches);
  const int count = static_cast<int>(layout.patches.size());
  out.patch_error.assign(count, 0);
  out.patch_worst.assign(count, Vector3::Zero());
  out.unknowns.resize(count);
  // Unknowns: nodes by vertex, then the inner samples of each arch.
  MorphProblem problem;
  std::vector<int> node_unknown(surface_.mesh.points.size(), -1);
  auto node = [&](int v, double anchor) {
    if (node_unknown[v] < 0) {
      node_unknown[v] = static_cast<int>(problem.rest.size());
      problem.rest.push_back(surface_.mesh.points[v]);
      problem.anchor.push_back(anchor);
    }
    double& a = problem.anchor[node_unknown[v]];
    a = std::max(a, anchor);
    return node_unknown[v];
  };
  auto& arch_unknowns = out.arch_unknowns;
  arch_unknowns.resize(layout.arches.size());
  for (std::size_t a = 0; a < layout.arches.size(); ++a) {
    const Arch& arch = layout.arches[a];
    const auto samples = sample_arch(surface_.mesh, arch, params_.spacing);
    auto& ids = arch_unknowns[a];
    const double anchor = anchor_weight(arch);
    ids.push_back(node(arch.vertices.front(), anchor));
    for (std::size_t s = 1; s + 1 < samples.size(); ++s) {
      ids.push_back(static_cast<int>(problem.rest.size()));
      problem.rest.push_back(arch_point(surface_.mesh, arch, samples[s]));
      problem.anchor.push_back(anchor);
    }
    ids.push_back(node(arch.vertices.back(), anchor));
    for (std::size_t s = 1; s + 1 < ids.size(); ++s) problem.stencils.push_back({ids[s - 1], ids[s], ids[s + 1]});
  }
  for (int p = 0; p < count; ++p) {
    const PatchEvaluation& e = *out.patches[p];
    auto& ids = out.unknowns[p];
    ids.resize(e.polygon.size());
    for (int i = 0; i < e.polygon.size(); ++i)
      ids[i] = arch_unknowns[layout.patches[p].boundary[e.polygon.origin[i].use].arch][e.polygon.origin[i].sample];
    for (MorphSample s : e.samples) {
      if (s.weight <= 0) continue;
      for (int& u : s.unknown) u = ids[u];
      s.patch = p;
      problem.samples.push_back(s);
    }
  }
  MorphParams morph_params = params_.morph;
  morph_params.rounds = rounds;
  morph_params.stop_below = 0.7 * params_.e_max;
  out.position = morph(problem, morph_params).position;
  parallel_for(context_, count, [&](int p) {
    const PatchEvaluation& e = *out.patches[p];
    std::vector<Vector3> position(e.polygon.size());
    for (int i = 0; i < e.polygon.size(); ++i) position[i] = out.position[out.unknowns[p][i]];
    out.patch_error[p] = patch_error(e.samples, e.rulings.triangles, position, *surface_.input, 0.8 * params_.e_max, &out.patch_worst[p]);
  });
  for (int p = 0; p < count; ++p) {
    out.max_error = std::max(out.max_error, out.patch_error[p]);
    const PatchVerdict v = out.patches[p]->verdict;
    out.failing += (v != PatchVerdict::kViable && v != PatchVerdict::kError) || out.patch_error[p] > params_.e_max;
  }
  return out;
}

}  // namespace sheetform
