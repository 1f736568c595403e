#include "sheetform/search/layout_search.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "sheetform/search/split.h"
#include "sheetform/tracing/path_smoothing.h"

namespace sheetform {
namespace {

std::uint64_t combine(std::uint64_t a, std::uint64_t b) { return (a ^ (b + 0x9e3779b97f4a7c15ull + (a << 6) + (a >> 2))) * 0xff51afd7ed558ccdull; }

}  // namespace

LayoutSearch::LayoutSearch(SearchSurface& surface, PathNetwork start, const TracingGraph& graph, std::vector<Path> candidates,
                           const SearchParams& params, RunContext& context)
    : surface_(surface),
      network_(surface.mesh, std::move(start)),
      graph_(graph),
      candidates_(std::move(candidates)),
      params_(params),
      context_(context),
      distance_(graph, 1.0),
      evaluator_(surface_, params_.evaluation, context),
      rules_{params.evaluation.self_seams},
      edge_length_(mean_edge_length(surface.mesh)) {}

const PatchLayout& LayoutSearch::layout() {
  if (!layout_valid_) layout_ = extract_layout(surface_.mesh, network_.network(), surface_.versions, rules_);
  layout_valid_ = true;
  return layout_;
}

const LayoutEvaluation& LayoutSearch::evaluation() {
  if (!evaluation_valid_) evaluation_ = evaluator_.layout(layout(), params_.lawson_rounds);
  evaluation_valid_ = true;
  return evaluation_;
}

// Corners by the paths that meet, without a chart.
int LayoutSearch::combinatorial_corners(const Patch& patch) const {
  int corners = 0;
  const std::size_t n = patch.boundary.size();
  for (std::size_t i = 0; i < n; ++i) {
    const int a = layout_.arches[patch.boundary[i].arch].path, b = layout_.arches[patch.boundary[(i + 1) % n].arch].path;
    corners += a != b;
  }
  return corners;
}

std::vector<int> LayoutSearch::topologically_bad() {
  std::vector<int> bad;
  for (int p = 0; p < static_cast<int>(layout().patches.size()); ++p) {
    const Patch& patch = layout_.patches[p];
    if (patch.defect != TopologyDefect::kNone || combinatorial_corners(patch) > params_.evaluation.max_sides) bad.push_back(p);
  }
  return bad;
}

// How much the path is worth to the patch: its distance to parallel paths inside of it, weighted by how squarely it
// crosses the direction of least curvature (method.md 13.4). 0 when it does not run through the patch.
double LayoutSearch::priority(const Path& path, int patch) const {
  double sum = 0;
  int count = 0;
  const std::size_t n = path.vertices.size();
  for (std::size_t i = 0; i + 1 < n + (path.loop ? 1 : 0); ++i) {
    const int v = path.vertices[i], w = path.vertices[(i + 1) % n];
    const int e = surface_.mesh.find_edge(v, w);
    const auto& edge = surface_.mesh.edges[e];
    if (edge.border() || layout_.face_patch[edge.f0] != patch || layout_.face_patch[edge.f1] != patch) continue;
    const Vector3 direction = (surface_.mesh.points[w] - surface_.mesh.points[v]).normalized();
    const double along = surface_.guide.ruling_direction[edge.f0].dot(direction);
    const double crossing = 1 - surface_.guide.strength[edge.f0] * along * along;
    sum += std::min(distance_.at(TracingGraph::node(v, path.dirs[i])), 1.0) * (0.4 + 0.6 * crossing);
    ++count;
  }
  return count == 0 ? 0 : sum / count;
}

void LayoutSearch::commit(std::size_t candidate) {
  network_.insert(candidates_[candidate], PathKind::kTraced);
  distance_.add(candidates_[candidate]);
  candidates_.erase(candidates_.begin() + static_cast<std::ptrdiff_t>(candidate));
  changed();
}

// Inserts the best fitting candidate for each bad patch that has not been cut in this round; false if none was found.
bool LayoutSearch::insert_best(const std::vector<int>& bad) {
  // Candidates that touch what is there are dropped for good; those too near to a parallel one as well.
  std::vector<Path> kept;
  for (Path& c : candidates_)
    if (network_.fits(c) && distance_.mean(c) > params_.min_spacing_edges * edge_length_) kept.push_back(std::move(c));
  candidates_ = std::move(kept);
  layout();
  struct Choice {
    double value;
    std::size_t candidate;
  };
  std::vector<Choice> choices;
  for (int p : bad) {
    Choice best{0, 0};
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      const double value = priority(candidates_[c], p);
      if (value > best.value) best = {value, c};
    }
    if (best.value > 0) choices.push_back(best);
  }
  if (choices.empty()) return false;
  std::sort(choices.begin(), choices.end(), [](const Choice& a, const Choice& b) {
    return a.value != b.value ? a.value > b.value : a.candidate < b.candidate;
  });
  std::vector<Path> round;
  std::set<std::size_t> seen;
  for (const Choice& c : choices)
    if (seen.insert(c.candidate).second) round.push_back(candidates_[c.candidate]);
  for (const Path& path : round) {
    if (!network_.fits(path) || distance_.mean(path) <= params_.min_spacing_edges * edge_length_) continue;
    network_.insert(path, PathKind::kTraced);
    distance_.add(path);
  }
  changed();
  return true;
}

int LayoutSearch::split(const std::vector<int>& patches, PatchVerdict reason) {
  int done = 0;
  const PatchLayout before = layout();
  for (int p : patches) {
    const auto known = evaluator_.patch(before, p);
    PatchEvaluation asked = *known;
    if (known->viable() || known->verdict == PatchVerdict::kError) asked.verdict = reason;
    const std::vector<int> edges = split_patch(surface_.mesh, before, p, asked);
    if (edges.empty()) continue;
    network_.insert_edges(edges, PathKind::kCut);
    ++done;
  }
  if (done > 0) changed();
  return done;
}

void LayoutSearch::insert() {
  for (int round = 0; round < 200; ++round) {
    context_.report(Stage::kInsert, 0.3 * round / (round + 10.0));
    const std::vector<int> bad = topologically_bad();
    if (bad.empty()) break;
    if (!insert_best(bad) && split(bad, PatchVerdict::kTooManySides) == 0) break;
  }
  smooth(5);
  int last_failing = 1 << 30, stuck = 0;
  for (int round = 0; round < 60; ++round) {
    context_.report(Stage::kInsert, 0.3 + 0.7 * round / (round + 6.0));
    layout();
    std::vector<int> bad;
    const auto evaluations = evaluator_.patches(layout_);
    for (int p = 0; p < static_cast<int>(evaluations.size()); ++p)
      if (!evaluations[p]->viable()) bad.push_back(p);
    if (bad.empty()) {
      const LayoutEvaluation& e = evaluation();
      for (int p = 0; p < static_cast<int>(e.patch_error.size()); ++p)
        if (e.patch_error[p] > params_.evaluation.e_max) bad.push_back(p);
    }
    if (bad.empty()) break;
    stuck = static_cast<int>(bad.size()) < last_failing ? 0 : stuck + 1;
    last_failing = static_cast<int>(bad.size());
    if (stuck < 8 && insert_best(bad)) continue;
    if (split(bad, PatchVerdict::kError) == 0) break;
  }
  smooth(5);
}

void LayoutSearch::smooth(int rounds) {
  std::vector<char> path_edge(surface_.mesh.edges.size(), 0), fixed(surface_.mesh.points.size(), 0);
  const PathNetwork& net = network_.network();
  for (int e = 0; e < surface_.mesh.edge_count(); ++e) {
    if (!net.used(e)) continue;
    const PathKind kind = net.kinds[net.edge_path[e]];
    const auto& edge = surface_.mesh.edges[e];
    path_edge[e] = 1;
    if (kind == PathKind::kBorder || kind == PathKind::kCrease || kind == PathKind::kSymmetry) fixed[edge.v0] = fixed[edge.v1] = 1;
  }
  SmoothParams params;
  params.rounds = rounds;
  for (int v : smooth_paths(surface_.mesh, path_edge, fixed, *surface_.input, params, context_)) ++surface_.versions[v];
  changed();
}

bool LayoutSearch::changed_patches_viable(const PatchLayout& before, const PatchLayout& after) {
  std::unordered_set<std::uint64_t> known;
  for (const Patch& p : before.patches) known.insert(p.key);
  for (int p = 0; p < static_cast<int>(after.patches.size()); ++p) {
    if (known.count(after.patches[p].key)) continue;
    if (after.patches[p].defect != TopologyDefect::kNone) return false;
  }
  for (int p = 0; p < static_cast<int>(after.patches.size()); ++p) {
    if (known.count(after.patches[p].key)) continue;
    if (!evaluator_.patch(after, p)->viable()) return false;
  }
  return true;
}

bool LayoutSearch::no_worse(const LayoutEvaluation& before, const PatchLayout& layout_before, const LayoutEvaluation& after,
                            const PatchLayout& layout_after) const {
  if (after.failing == 0) return true;
  if (before.failing == 0) return false;
  auto failing_area = [&](const LayoutEvaluation& e, const PatchLayout& l) {
    double area = 0;
    for (std::size_t p = 0; p < l.patches.size(); ++p)
      if (e.patch_error[p] > params_.evaluation.e_max || !(e.patches[p]->viable() || e.patches[p]->verdict == PatchVerdict::kError))
        area += l.patches[p].area;
    return area;
  };
  return after.failing <= before.failing && failing_area(after, layout_after) <= failing_area(before, layout_before) + 1e-12 &&
         after.max_error <= std::max(before.max_error, params_.evaluation.e_max);
}

bool LayoutSearch::try_remove(const std::vector<int>& edges) {
  if (edges.empty() || network_.leaves_loose_end(edges)) return false;
  const PatchLayout before = layout();
  const LayoutEvaluation evaluation_before = evaluation();
  std::vector<int> paths;
  for (int e : edges) paths.push_back(network_.network().edge_path[e]);
  network_.remove_edges(edges);
  changed();
  bool keep = changed_patches_viable(before, layout());
  if (keep) keep = no_worse(evaluation_before, before, evaluation(), layout_);
  if (keep) return true;
  network_.restore_edges(edges, paths);
  layout_ = before, evaluation_ = evaluation_before;
  layout_valid_ = evaluation_valid_ = true;
  return false;
}

void LayoutSearch::remove_paths() {
  const int count = static_cast<int>(network_.network().kinds.size());
  for (bool removed = true; removed;) {
    removed = false;
    for (int path = count - 1; path > 0; --path) {
      context_.report(Stage::kRemove, 0.4 * (count - path) / count);
      const PathKind kind = network_.network().kinds[path];
      if (kind != PathKind::kTraced && kind != PathKind::kCut) continue;
      removed |= try_remove(network_.edges_of_path(path));
    }
  }
}

void LayoutSearch::remove_arches() {
  for (bool removed = true; removed;) {
    removed = false;
    const PatchLayout now = layout();
    std::vector<std::pair<double, int>> order;
    for (int a = 0; a < static_cast<int>(now.arches.size()); ++a) {
      const Arch& arch = now.arches[a];
      const PathKind kind = network_.network().kinds[arch.path];
      if (arch.left < 0 || arch.right < 0 || (kind != PathKind::kTraced && kind != PathKind::kCut)) continue;
      const double smaller = std::min(now.patches[arch.left].area, now.patches[arch.right].area);
      order.emplace_back(smaller - 1e-3 * arch.length, a);
    }
    std::sort(order.begin(), order.end());
    for (const auto& [value, a] : order) {
      const Arch& arch = now.arches[a];
      const std::uint64_t key = combine(arch.key, combine(now.patches[arch.left].key, now.patches[arch.right].key));
      if (rejected_.count(key)) continue;
      context_.report(Stage::kRemove, 0.7);
      if (try_remove(arch.edges)) {
        removed = true;
        break;
      }
      rejected_.insert(key);
    }
  }
}

}  // namespace sheetform
