#include "sheetform/search/evaluator.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "sheetform/search/chord_book.h"
#include "sheetform/search/outline_samples.h"
#include "sheetform/search/patch_tilt.h"
#include "sheetform/search/plane_join.h"
#include "sheetform/strip/unfold.h"

namespace sheetform {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr int kChordSamples = 5;
constexpr double kOutlineSlide = 0.0;
// Stiffness of arches: the same bending costs the same at any sampling, and may be had the more cheaply the
// sharper the tolerance.
constexpr double kStiffness = 8e-3;
constexpr double kMostFolded = 0.05;  // of a chart's area: there may be small bumps
constexpr int kNarrowFaces = 12;
constexpr int kMostClashes = 6;        // times that rulings are looked for anew
constexpr double kTurnAlongPath = 60;  // degrees: where a path bends more, a patch has a corner

std::array<double, 3> barycentric(const Vector2& a, const Vector2& b, const Vector2& c, const Vector2& p) {
  const double whole = cross(b - a, c - a);
  if (std::abs(whole) < 1e-300) return {1, 0, 0};
  const double v = cross(p - a, c - a) / whole, w = cross(b - a, p - a) / whole;
  return {1 - v - w, v, w};
}

// Of more corners than a patch may have, the bends that turn least are none.
void drop_bends(const PatchPolygon& polygon, int max_sides, PatchEvaluation& e) {
  std::vector<std::pair<double, int>> bends;  // turn, corner
  for (std::size_t node = 0, i = 0; node < e.turns.size(); ++node, ++i) {
    while (!polygon.node[i]) ++i;
    const double turn = std::abs(e.turns[node].angle);
    if (e.turns[node].may_bend && turn > e.turns[node].limit) bends.emplace_back(turn, static_cast<int>(i));
  }
  std::sort(bends.begin(), bends.end());
  const int excess = static_cast<int>(e.corners.size()) - max_sides;
  for (int k = 0; k < std::min(excess, static_cast<int>(bends.size())); ++k)
    e.corners.erase(std::find(e.corners.begin(), e.corners.end(), bends[k].second));
}

// Nodes where the outline turns: by more than `corner_turn` degrees where two paths meet, by more than 60
// along one path. Directions are taken over `corner_reach` on either side. An outline that was known with
// other samples keeps its corners.
void find_corners(const PatchLayout& layout, const Patch& patch, const EvaluationParams& params,
                  const PatchEvaluation* known, PatchEvaluation& e) {
  const PatchPolygon& polygon = e.polygon;
  const int n = polygon.size();
  const bool keep =
      known != nullptr && n - static_cast<std::ptrdiff_t>(known->turns.size()) ==
                              std::count(polygon.node.begin(), polygon.node.end(), PatchLayout::kNone);
  const auto away = [&](int i, int step) {
    int k = i;
    do k = (k + step + n) % n;
    while (k != i && !polygon.node[k] && (polygon.uv[k] - polygon.uv[i]).norm() < 0.9 * params.corner_reach);
    return k;
  };
  for (int i = 0; i < n; ++i) {
    if (!polygon.node[i]) continue;
    if (keep) {
      e.turns.push_back(known->turns[e.turns.size()]);
    } else {
      const Vector2 in = polygon.uv[i] - polygon.uv[away(i, -1)],
                    out = polygon.uv[away(i, 1)] - polygon.uv[i];
      const double angle = std::atan2(cross(in, out), in.dot(out)) / kDegree;
      const ArchUse& use = patch.boundary[polygon.origin[i].use];
      const auto path = [&](int k) { return layout.arches[patch.boundary[polygon.origin[k].use].arch].path; };
      double limit = params.corner_turn;
      if (path(i) == path((i + n - 1) % n)) limit = std::max(limit, kTurnAlongPath);
      if (!params.t_junctions) limit = -1;  // every node is one
      const auto& vertices = layout.arches[use.arch].vertices;
      e.turns.push_back({use.forward ? vertices.front() : vertices.back(), angle, limit,
                         params.max_sides >= kMostSides && polygon.node[i] == PatchLayout::kBend});
    }
    if (std::abs(e.turns.back().angle) > e.turns.back().limit) e.corners.push_back(i);
  }
  drop_bends(polygon, params.max_sides, e);
}

MorphParams outline_morph(const EvaluationParams& params) {
  const double h2 = params.spacing * params.spacing;
  MorphParams morph = params.morph;
  morph.smooth = kStiffness * params.e_max * params.e_max / (h2 * h2);
  morph.spacing = params.spacing;
  morph.stop_below = 0.7 * params.e_max;
  return morph;
}

// Which strip triangle covers each cell of the chart's raster.
std::vector<int> strip_cells(const ChartRaster& raster, const PatchPolygon& polygon,
                             const RulingSet& rulings) {
  std::vector<int> cells(static_cast<std::size_t>(raster.columns()) * raster.rows(), -1);
  const double step = raster.cell() * 0.7;
  const auto steps = [&](const Vector2& side) {
    return std::max(1, static_cast<int>(std::ceil(side.norm() / step)));
  };
  for (std::size_t t = 0; t < rulings.triangles.size(); ++t) {
    std::array<int, 3> v = rulings.triangles[t];  // the shortest side last: most are long and thin
    const auto side = [&](int k) { return polygon.uv[v[(k + 2) % 3]] - polygon.uv[v[(k + 1) % 3]]; };
    int apex = 0;
    for (int k : {1, 2})
      if (side(k).squaredNorm() < side(apex).squaredNorm()) apex = k;
    std::rotate(v.begin(), v.begin() + apex, v.end());
    const Vector2 &a = polygon.uv[v[0]], &b = polygon.uv[v[1]], &c = polygon.uv[v[2]];
    const int n = std::max(steps(b - a), steps(c - a)), most = steps(c - b);
    for (int i = 0; i <= n; ++i) {
      const double part = static_cast<double>(i) / n;
      const int m = 1 + i * most / n;
      const Vector2 from = a + (b - a) * part, across = (c - b) * (part / m);
      for (int j = 0; j <= m; ++j) {
        const int cell = raster.cell_of(from + across * j);
        if (cell >= 0 && cells[cell] < 0) cells[cell] = static_cast<int>(t);
      }
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
    s.slide = t == 0 || t == 1 ? kOutlineSlide : 1;
    e.samples.push_back(s);
  };
  e.samples.reserve(e.rulings.chords.size() * kChordSamples + e.polygon.uv.size() +
                    e.chart->vertices.size());  // coverage follows
  for (const auto& chord : e.rulings.chords)
    for (int k = 0; k < kChordSamples; ++k) {
      const double share = (k == 0 || k == kChordSamples - 1 ? 0.5 : 1.0) / (kChordSamples - 1);
      add(chord.a, chord.b, static_cast<double>(k) / (kChordSamples - 1), std::max(chord.area, 1e-9) * share);
    }
  for (int i = 0; i < e.polygon.size(); ++i) add(i, i, 0, 0.02 * area / e.polygon.size());
}

// Whether the outline between two consecutive polygon points is a seam: what lies beyond is the neighbour's.
bool on_seam(const PatchLayout& layout, const Patch& patch, const PatchPolygon& polygon, int a, int b) {
  const int n = polygon.size();
  if (b == (a + n - 1) % n) std::swap(a, b);
  if (b != (a + 1) % n) return false;
  const Arch& arch = layout.arches[patch.boundary[polygon.origin[a].use].arch];
  return arch.left != Arch::kOutside && arch.right != Arch::kOutside;
}

// Every vertex of the patch, and every point that the working mesh misses, against the strip triangle above
// it: bulges and tips outside of all rulings are seen. Points between a path and the coarser outline that was
// sampled from it count where the outline is.
void coverage_samples(const SearchSurface& surface, const PatchLayout& layout, const Patch& patch,
                      const ChartRaster& raster, PatchEvaluation& e) {
  const auto cells = strip_cells(raster, e.polygon, e.rulings);
  const PatchChart& chart = *e.chart;
  const auto add = [&](const Vector2& u, const Vector3& target, const Vector3& normal, double weight) {
    const int t = nearest_cell(cells, raster, u);
    if (t < 0) return;
    const auto& tri = e.rulings.triangles[t];
    auto w = barycentric(e.polygon.uv[tri[0]], e.polygon.uv[tri[1]], e.polygon.uv[tri[2]], u);
    double sum = 0;
    for (double& x : w) sum += x = std::clamp(x, 0.0, 1.0);
    for (double& x : w) x /= sum;
    MorphSample s;
    s.unknown = tri;
    s.triangle = t;
    s.coefficient = w;
    s.target = target;
    for (int k = 0; k < 3; ++k) {
      if (w[k] > 0 || !on_seam(layout, patch, e.polygon, tri[(k + 1) % 3], tri[(k + 2) % 3])) continue;
      const Vector2 inside =
          w[0] * e.polygon.uv[tri[0]] + w[1] * e.polygon.uv[tri[1]] + w[2] * e.polygon.uv[tri[2]];
      const int below = raster.triangle_at(inside), there = raster.triangle_at(u);
      if (below >= 0 && there >= 0) s.target += raster.lift(below, inside) - raster.lift(there, u);
      break;
    }
    s.normal = normal;
    s.weight = weight;
    s.covers = true;
    e.samples.push_back(s);
  };
  for (std::size_t v = 0; v < chart.vertices.size(); ++v)
    add(chart.uv[v], surface.mesh.points[chart.vertices[v]], Vector3::UnitZ(), 0);
  if (surface.details == nullptr) return;
  auto detail = surface.details->begin();
  for (std::size_t i = 0; i < patch.faces.size(); ++i) {
    const int f = patch.faces[i];
    detail = std::lower_bound(detail, surface.details->end(), f,
                              [](const DetailPoint& d, int face) { return d.face < face; });
    for (auto d = detail; d != surface.details->end() && d->face == f; ++d) {
      const auto& t = chart.triangles[i];
      const Vector2 u = d->barycentric[0] * chart.uv[t[0]] + d->barycentric[1] * chart.uv[t[1]] +
                        d->barycentric[2] * chart.uv[t[2]];
      add(u, d->point, surface.guide.normal[f], 2e-3 * patch.area);
    }
  }
}

// Rulings whose chords are edges of their own, as far as the patch alone tells: where it is glued to itself
// two may be the same edge.
RulingSet distinct_rulings(const PatchPolygon& polygon, const ChartRaster& raster, const RulingParams& params,
                           const std::function<bool(int, int)>* forbidden, const ChordBook& book,
                           const std::vector<int>& unknowns) {
  RulingSet rulings = best_rulings(polygon, raster, params, forbidden);
  std::set<ChordBook::Pair> clashing;
  const std::function<bool(int, int)> avoid = [&](int a, int b) {
    return clashing.count(ChordBook::ordered(unknowns[a], unknowns[b])) > 0 ||
           (forbidden != nullptr && (*forbidden)(a, b));
  };
  for (int attempt = 0; rulings.found; ++attempt) {
    const std::set<ChordBook::Pair> bad = book.conflicts(rulings, unknowns);
    if (bad.empty()) break;
    if (attempt == kMostClashes) return rulings.found = false, rulings;
    clashing.insert(bad.begin(), bad.end());
    rulings = best_rulings(polygon, raster, params, &avoid);
  }
  return rulings;
}

std::uint64_t point_key(const PatchLayout& layout, const Patch& patch, const PatchPolygon::Origin& origin,
                        int samples) {
  const int a = patch.boundary[origin.use].arch;
  const Arch& arch = layout.arches[a];
  if (origin.sample == 0) return (1ull << 63) | static_cast<unsigned>(arch.vertices.front());
  if (origin.sample == samples - 1) return (1ull << 63) | static_cast<unsigned>(arch.vertices.back());
  return (static_cast<std::uint64_t>(a) << 32) | static_cast<unsigned>(origin.sample);
}

bool outline_on_plane(const SearchSurface& surface, const PatchLayout& layout, const Patch& patch,
                      const PatchPolygon::Origin& origin, const std::vector<std::vector<double>>& samples) {
  const int a = patch.boundary[origin.use].arch;
  const Arch& arch = layout.arches[a];
  if (origin.sample == 0) return surface.on_plane(arch.vertices.front());
  if (origin.sample + 1 == static_cast<int>(samples[a].size())) return surface.on_plane(arch.vertices.back());
  return surface.on_plane(arch);
}

// Points of the outline as unknowns of a morph, those of a seam of the patch with itself once: by polygon
// point.
std::vector<int> number_outline(const SearchSurface& surface, const PatchLayout& layout, const Patch& patch,
                                const std::vector<std::vector<double>>& samples, const PatchPolygon& polygon,
                                MorphProblem& problem) {
  const int n = polygon.size();
  std::vector<std::pair<std::uint64_t, int>> keys(n);
  for (int i = 0; i < n; ++i) {
    const PatchPolygon::Origin& origin = polygon.origin[i];
    const auto count = static_cast<int>(samples[patch.boundary[origin.use].arch].size());
    keys[i] = {point_key(layout, patch, origin, count), i};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<int> unknown(n, -1);
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const int i = keys[k].second;
    if (k == 0 || keys[k].first != keys[k - 1].first) {
      problem.rest.push_back(polygon.point[i]);
      problem.anchor.push_back(0.02);
      if (!surface.plane.vertex.empty())
        problem.on_plane.push_back(outline_on_plane(surface, layout, patch, polygon.origin[i], samples));
    }
    unknown[i] = static_cast<int>(problem.rest.size()) - 1;
  }
  return unknown;
}

// A crease gives way to the tolerance only where nothing else helps: an arch beside it is no crease.
constexpr double kOnCrease = 10;

double anchor_weight(const SearchSurface& surface, const Arch& arch) {
  if (surface.on_crease(arch)) return kOnCrease;
  const bool border = arch.right == Arch::kOutside || arch.left == Arch::kOutside;
  return border && !surface.on_plane(arch) ? 0.3 : 0.02;
}

// Consecutive points of the same arch around polygon point i, or false.
bool inside_arch(const PatchPolygon& polygon, int i) { return !polygon.node[i]; }

// Numbers the outline points of arches: nodes by their vertex, then the inner samples of each arch.
class OutlineUnknowns {
 public:
  OutlineUnknowns(const SearchSurface& surface, const PatchLayout& layout, const EvaluationParams& params,
                  MorphProblem& problem)
      : surface_(surface),
        mesh_(surface.mesh),
        layout_(layout),
        params_(params),
        problem_(problem),
        ids_(layout.arches.size()) {}

  // free: the points may move; else they stay where `held` says (or at rest).
  void add(int a, bool free, const std::vector<Vector3>* held) {
    if (!ids_[a].empty()) return;
    const Arch& arch = layout_.arches[a];
    const std::vector<double> samples = outline_samples(surface_, arch, params_);
    if (held != nullptr && held->size() != samples.size()) held = nullptr;
    const double anchor = free ? anchor_weight(surface_, arch) : kHeld;
    const int last = static_cast<int>(samples.size()) - 1;
    auto& ids = ids_[a];
    for (int s = 0; s <= last; ++s) {
      const Vector3 rest = held != nullptr ? (*held)[s] : arch_point(mesh_, arch, samples[s]);
      if (s == 0 || s == last) {
        ids.push_back(node(arch.vertices[s == 0 ? 0 : arch.vertices.size() - 1], rest, anchor));
      } else {
        ids.push_back(static_cast<int>(problem_.rest.size()));
        problem_.rest.push_back(rest);
        problem_.anchor.push_back(anchor);
        on_plane_.push_back(surface_.on_plane(arch));
      }
    }
    if (!free) return;
    for (int s = 1; s < last; ++s) problem_.stencils.push_back({ids[s - 1], ids[s], ids[s + 1]});
  }
  const std::vector<int>& of(int arch) const { return ids_[arch]; }
  std::vector<std::vector<int>> take() {
    if (!surface_.plane.vertex.empty()) problem_.on_plane = std::move(on_plane_);
    return std::move(ids_);
  }

 private:
  static constexpr double kHeld = 1e4;
  int node(int v, const Vector3& rest, double anchor) {
    const auto [it, fresh] = nodes_.emplace(v, static_cast<int>(problem_.rest.size()));
    if (fresh) {
      problem_.rest.push_back(rest);
      problem_.anchor.push_back(anchor);
      on_plane_.push_back(surface_.on_plane(v));
    } else if (anchor > problem_.anchor[it->second]) {
      problem_.rest[it->second] = rest;
      problem_.anchor[it->second] = anchor;
    }
    return it->second;
  }
  const SearchSurface& surface_;
  const SurfaceMesh& mesh_;
  const PatchLayout& layout_;
  const EvaluationParams& params_;
  MorphProblem& problem_;
  std::vector<char> on_plane_;  // per unknown
  std::vector<std::vector<int>> ids_;
  std::unordered_map<int, int> nodes_;
};

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
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return (bp - (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b)).squaredNorm();
  const double sum = va + vb + vc;
  return (ap - ab * (vb / sum) - ac * (vc / sum)).squaredNorm();
}

// From a surface point to the strips of its patch; what is not above `least` need not be exact. Triangles
// follow each other in the strip: from the point's own to both sides.
double to_strips(const MorphSample& s, const std::vector<std::array<int, 3>>& triangles,
                 const std::vector<Vector3>& position, double least) {
  const int n = static_cast<int>(triangles.size());
  double best = (s.at(position) - s.target).squaredNorm();
  for (int away = 0; away < n && best > least * least; ++away)
    for (int t : {s.triangle - away, s.triangle + away}) {
      if (t < 0 || t >= n) continue;
      best = std::min(best, point_triangle2(s.target, position[triangles[t][0]], position[triangles[t][1]],
                                            position[triangles[t][2]]));
    }
  return std::sqrt(best);
}

std::shared_ptr<const PatchEvaluation> as_rejected(const PatchEvaluation& e) {
  auto copy = std::make_shared<PatchEvaluation>(e);
  if (copy->viable()) copy->verdict = PatchVerdict::kError;
  return copy;
}

}  // namespace

const char* to_string(PatchVerdict verdict) {
  switch (verdict) {
    case PatchVerdict::kViable:
      return "viable";
    case PatchVerdict::kNotADisk:
      return "not a disk";
    case PatchVerdict::kTouches:
      return "touches itself";
    case PatchVerdict::kTooManySides:
      return "too many sides";
    case PatchVerdict::kFolded:
      return "folded chart";
    case PatchVerdict::kNoRulings:
      return "no rulings";
    case PatchVerdict::kOverlap:
      return "overlaps when flat";
    case PatchVerdict::kError:
      return "error above tolerance";
  }
  return "";
}

double patch_error(const std::vector<MorphSample>& samples, const std::vector<std::array<int, 3>>& triangles,
                   const std::vector<Vector3>& position, const ClosestPointTree& input, double limit,
                   const MorphSample** worst_sample) {
  double worst = 0;
  for (const MorphSample& s : samples) {
    const Vector3 x = s.at(position);
    double d = (x - s.target).norm();
    if (d > std::max(limit, worst)) {
      if (!s.covers) {
        // The target lies on the working mesh, the input is a little off: hence the slack.
        const ClosestPoint hit = input.closest(x, (d + 2e-3) * (d + 2e-3));
        if (hit.face >= 0) d = std::min(d, std::sqrt(hit.squared_distance));
      } else {
        d = to_strips(s, triangles, position, worst);
      }
    }
    if (d > worst) {
      worst = d;
      if (worst_sample != nullptr) *worst_sample = &s;
    }
  }
  return worst;
}

std::shared_ptr<const PatchEvaluation> LayoutEvaluator::patch(const PatchLayout& layout, int p) {
  const Patch& patch = layout.patches[p];
  if (auto found = known(patch)) return found;
  context_.checkpoint();
  auto result = compute(layout, patch, params_.ruling, nullptr);
  const std::lock_guard lock(mutex_);
  ++counts_.evaluations;
  if (cache_.size() >= params_.remembered) {  // what nobody holds can be computed again
    for (auto it = cache_.begin(); it != cache_.end();)
      it = it->second.use_count() == 1 ? cache_.erase(it) : std::next(it);
  }
  if (rejected_.count(patch.key)) result = as_rejected(*result);
  return cache_.emplace(patch.key, std::move(result)).first->second;
}

void LayoutEvaluator::reject(const Patch& patch) {
  const std::lock_guard lock(mutex_);
  rejected_.insert(patch.key);
  const auto it = cache_.find(patch.key);
  if (it != cache_.end()) it->second = as_rejected(*it->second);
}

std::vector<std::shared_ptr<const PatchEvaluation>> LayoutEvaluator::patches(const PatchLayout& layout) {
  std::vector<std::shared_ptr<const PatchEvaluation>> all(layout.patches.size());
  std::vector<int> open;
  for (int p = 0; p < static_cast<int>(all.size()); ++p)
    if (!(all[p] = known(layout.patches[p]))) open.push_back(p);
  open = largest_first(layout, std::move(open));
  parallel_for(context_, static_cast<int>(open.size()),
               [&](int i) { all[open[i]] = patch(layout, open[i]); });
  return all;
}

std::shared_ptr<const PatchEvaluation> LayoutEvaluator::known(const Patch& patch) const {
  const std::lock_guard lock(mutex_);
  const auto it = cache_.find(patch.key);
  if (it == cache_.end()) return nullptr;
  ++counts_.cache_hits;
  return it->second;
}

std::shared_ptr<const PatchChart> LayoutEvaluator::chart(const PatchLayout& layout,
                                                         const Patch& patch) const {
  for (const LayoutEvaluator* where : {this, static_cast<const LayoutEvaluator*>(charts_)})
    if (const auto seen = where == nullptr ? nullptr : where->known(patch); seen && seen->chart)
      return seen->chart;
  ChartParams chart_params;
  if (!surface_.elimination_rank.empty()) chart_params.elimination_rank = &surface_.elimination_rank;
  return std::make_shared<PatchChart>(parametrize(surface_.mesh, layout, patch, chart_params));
}

std::shared_ptr<const PatchEvaluation> LayoutEvaluator::compute(
    const PatchLayout& layout, const Patch& patch, RulingParams ruling,
    const std::function<bool(int, int)>* forbidden) const {
  auto e = std::make_shared<PatchEvaluation>();
  if (patch.defect != TopologyDefect::kNone) {
    e->verdict = patch.defect == TopologyDefect::kNotADisk ? PatchVerdict::kNotADisk : PatchVerdict::kTouches;
    return e;
  }
  const auto before = keep_corners_ ? charts_->known(patch) : nullptr;
  const auto chart = e->chart = this->chart(layout, patch);
  std::vector<std::vector<double>> samples(layout.arches.size());
  for (const ArchUse& use : patch.boundary)
    if (samples[use.arch].empty())
      samples[use.arch] = outline_samples(surface_, layout.arches[use.arch], params_);
  e->polygon = patch_polygon(surface_.mesh, layout, patch, *chart, samples);
  find_corners(layout, patch, params_, before.get(), *e);
  if (static_cast<int>(e->corners.size()) > params_.max_sides ||
      !fits_its_image(surface_, layout, patch, e->polygon, e->corners, params_))
    return e->verdict = PatchVerdict::kTooManySides, e;
  if (chart->folded > kMostFolded || !simple_outline(e->polygon.uv, 0))
    return e->verdict = PatchVerdict::kFolded, e;
  context_.checkpoint();
  const ChartRaster raster(surface_.mesh, surface_.guide, patch, *chart, 1600);
  MorphProblem problem;  // of the patch alone: every outline point is free
  const std::vector<int> unknown = number_outline(surface_, layout, patch, samples, e->polygon, problem);
  const int n = e->polygon.size();
  ChordBook alone(problem.on_plane);
  for (int i = 0; i < n; ++i) alone.take_edge(unknown[i], unknown[(i + 1) % n]);
  ruling.e_max = params_.e_max;
  ruling.min_height = 0.03 * params_.spacing;
  e->rulings = distinct_rulings(e->polygon, raster, ruling, forbidden, alone, unknown);
  if (!e->rulings.found && static_cast<int>(patch.faces.size()) <= kNarrowFaces) {
    // Narrower than a cell of the raster: the outline alone has to do.
    ruling.keep_inside = false;
    e->rulings = distinct_rulings(e->polygon, raster, ruling, forbidden, alone, unknown);
  }
  if (!e->rulings.found) return e->verdict = PatchVerdict::kNoRulings, e;
  context_.checkpoint();
  chord_samples(raster, patch.area, *e);
  coverage_samples(surface_, layout, patch, raster, *e);
  for (int i = 0; i < n; ++i)
    if (inside_arch(e->polygon, i))
      problem.stencils.push_back({unknown[(i + n - 1) % n], unknown[i], unknown[(i + 1) % n]});
  problem.samples = e->samples;
  for (MorphSample& s : problem.samples)
    for (int& u : s.unknown) u = unknown[u];
  const MorphResult result = morph(problem, outline_morph(params_));
  std::vector<Vector3> position(n);
  for (int i = 0; i < n; ++i) position[i] = result.position[unknown[i]];
  const MorphSample* worst = nullptr;
  e->error =
      patch_error(e->samples, e->rulings.triangles, position, *surface_.input, 0.8 * params_.e_max, &worst);
  if (worst != nullptr)
    for (int k = 0; k < 3; ++k) e->worst += worst->coefficient[k] * e->polygon.uv[worst->unknown[k]];
  if (params_.normal_deviation > 0 && patch.area > kLeastTiltedShare * surface_area(surface_.mesh)) {
    // A tilt counts as the share of e_max that it is of its own limit: both are cured across the rulings.
    const PatchTilt tilt = patch_tilt(surface_, patch, *chart, e->polygon, e->rulings.triangles, position);
    const double as_error = params_.e_max * tilt.angle / params_.normal_deviation;
    if (as_error > e->error) e->error = as_error, e->worst = tilt.place;
  }
  if (!simple_outline(unfold(position, e->rulings.triangles), 1e-7))
    return e->verdict = PatchVerdict::kOverlap, e;
  e->verdict = e->error > params_.e_max ? PatchVerdict::kError : PatchVerdict::kViable;
  return e;
}

LayoutEvaluation LayoutEvaluator::solve(const PatchLayout& layout,
                                        std::vector<std::shared_ptr<const PatchEvaluation>> patches,
                                        int rounds, const std::vector<MorphSample>& also) {
  return morph_patches(layout, std::move(patches), {}, rounds, also);
}

LayoutEvaluation LayoutEvaluator::solve_region(const PatchLayout& region, const ArchPlaces& places,
                                               int rounds) {
  return morph_patches(region, patches(region), places, rounds, {});
}

LayoutEvaluation LayoutEvaluator::morph_patches(const PatchLayout& layout,
                                                std::vector<std::shared_ptr<const PatchEvaluation>> patches,
                                                const ArchPlaces& places, int rounds,
                                                const std::vector<MorphSample>& also) {
  const int n = static_cast<int>(layout.patches.size());
  LayoutEvaluation out;
  out.patches = std::move(patches);
  out.patch_error.assign(n, 0);
  out.unknowns.resize(n);
  MorphProblem problem;
  OutlineUnknowns unknowns(surface_, layout, params_, problem);
  for (const Patch& patch : layout.patches)
    for (const ArchUse& use : patch.boundary) {
      const Arch& arch = layout.arches[use.arch];
      const bool free = arch.left != Arch::kUnknown && arch.right != Arch::kUnknown;
      const std::vector<Vector3>* held = nullptr;
      if (!free) {
        const auto it = places.find(arch.key);
        if (it != places.end()) held = &it->second;
      }
      unknowns.add(use.arch, free, held);
    }
  std::size_t most = also.size();
  for (const auto& e : out.patches) most += e->samples.size();
  problem.samples.reserve(most);
  for (int p = 0; p < n; ++p) {
    const PatchEvaluation& e = *out.patches[p];
    auto& ids = out.unknowns[p];
    ids.resize(e.polygon.size());
    for (int i = 0; i < e.polygon.size(); ++i)
      ids[i] =
          unknowns.of(layout.patches[p].boundary[e.polygon.origin[i].use].arch)[e.polygon.origin[i].sample];
    for (MorphSample s : e.samples) {
      if (s.weight <= 0) continue;
      for (int& u : s.unknown) u = ids[u];
      problem.samples.push_back(s);
    }
  }
  problem.samples.insert(problem.samples.end(), also.begin(), also.end());
  out.arch_unknowns = unknowns.take();
  context_.checkpoint();
  MorphParams morph_params = outline_morph(params_);
  morph_params.rounds = rounds;
  out.position = morph(problem, morph_params).position;
  out.on_plane = std::move(problem.on_plane);
  parallel_for(context_, n, [&](int p) {
    const PatchEvaluation& e = *out.patches[p];
    std::vector<Vector3> position(e.polygon.size());
    for (int k = 0; k < e.polygon.size(); ++k) position[k] = out.position[out.unknowns[p][k]];
    out.patch_error[p] =
        patch_error(e.samples, e.rulings.triangles, position, *surface_.input, 0.8 * params_.e_max, nullptr);
  });
  for (int p = 0; p < n; ++p) {
    out.max_error = std::max(out.max_error, out.patch_error[p]);
    out.failing += !out.patches[p]->has_valid_strips() || out.patch_error[p] > params_.e_max;
  }
  return out;
}

}  // namespace sheetform
