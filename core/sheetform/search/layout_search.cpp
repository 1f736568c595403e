#include "sheetform/search/layout_search.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <set>

namespace sheetform {
namespace {

// Degrees beyond its limit from which a corner stays one when the patch grows.
constexpr double kFirm = 5;
// Of all merges that succeed, 0.5 % are above it (at 1, 2 and 5 %), of those that are too far off 20 to 60 %.
constexpr double kTooRound = 9;
// Of a diagonal inside of a region where no seam is wanted: its removal goes before all others, and it may
// cost that many parts.
constexpr double kInsideValue = 100, kInsideCost = 100;

std::uint64_t combine(std::uint64_t a, std::uint64_t b) {
  return (a ^ (b + 0x9e3779b97f4a7c15ull + (a << 6) + (a >> 2))) * 0xff51afd7ed558ccdull;
}

// Per face: the integral of the absolute Gaussian curvature.
std::vector<double> face_gauss(const SearchSurface& surface) {
  std::vector<double> gauss(surface.mesh.faces.size(), 0);
  if (surface.curvature == nullptr) return gauss;
  for (int f = 0; f < surface.mesh.face_count(); ++f) {
    for (int v : surface.mesh.faces[f])
      gauss[f] += std::abs(surface.curvature->k_max[v] * surface.curvature->k_min[v]) / 3;
    gauss[f] *= surface.mesh.face_normal_raw(f).norm() / 2;
  }
  return gauss;
}

}  // namespace

LayoutSearch::LayoutSearch(SearchSurface& surface, PathNetwork start, const TracingGraph& graph,
                           std::vector<Path> candidates, const SearchParams& params, RunContext& context)
    : surface_(surface),
      network_(surface.mesh, std::move(start)),
      graph_(graph),
      candidates_(candidates),
      pool_(std::move(candidates)),
      params_(params),
      context_(context),
      distance_(graph, 1.0),
      evaluator_(std::make_shared<LayoutEvaluator>(surface_, params_.evaluation, context)),
      rules_{params.evaluation.self_seams},
      edge_length_(mean_edge_length(surface.mesh)),
      rest_(surface.mesh.points),
      face_gauss_(std::make_shared<const std::vector<double>>(face_gauss(surface))) {}

LayoutSearch::LayoutSearch(LayoutSearch& before, PathNetwork start, const SearchParams& params)
    : surface_(before.surface_),
      network_(surface_.mesh, std::move(start)),
      graph_(before.graph_),
      candidates_(before.pool_),
      pool_(before.pool_),
      params_(params),
      context_(before.context_),
      distance_(graph_, 1.0),
      evaluator_(
          std::make_shared<LayoutEvaluator>(surface_, params_.evaluation, context_, before.evaluator_.get())),
      rules_{params.evaluation.self_seams},
      edge_length_(before.edge_length_),
      last_version_(before.last_version_),
      rest_(before.rest_),
      face_gauss_(before.face_gauss_) {
  surface_.mesh.points = rest_;
  surface_.versions.assign(rest_.size(), 0);
  surface_.straight.clear();
}

const PatchLayout& LayoutSearch::layout() {
  if (!layout_valid_) layout_ = extract_layout(surface_.mesh, network_.network(), surface_.versions, rules_);
  layout_valid_ = true;
  return layout_;
}

const LayoutEvaluation& LayoutSearch::evaluation() {
  if (!evaluation_valid_) evaluation_ = evaluator_->layout(layout(), params_.lawson_rounds);
  evaluation_valid_ = true;
  return evaluation_;
}

// Corners by the paths that meet, without a chart.
int LayoutSearch::combinatorial_corners(const Patch& patch) const {
  int corners = 0;
  const std::size_t n = patch.boundary.size();
  for (std::size_t i = 0; i < n; ++i) {
    const int a = layout_.arches[patch.boundary[i].arch].path,
              b = layout_.arches[patch.boundary[(i + 1) % n].arch].path;
    corners += a != b;
  }
  return corners;
}

std::vector<int> LayoutSearch::topologically_bad() {
  std::vector<int> bad;
  for (int p = 0; p < static_cast<int>(layout().patches.size()); ++p) {
    const Patch& patch = layout_.patches[p];
    if (patch.defect != TopologyDefect::kNone || combinatorial_corners(patch) > params_.evaluation.max_sides)
      bad.push_back(p);
  }
  return bad;
}

// How much the path is worth to the patch: its distance to parallel paths inside of it, weighted by how
// squarely it crosses the direction of least curvature (method.md 13.4). 0 when it does not run through the
// patch.
double LayoutSearch::priority(const Path& path, int patch) const {
  double sum = 0;
  int count = 0;
  const std::size_t n = path.vertices.size();
  for (std::size_t i = 0; i + 1 < n + (path.loop ? 1 : 0); ++i) {
    const int v = path.vertices[i], w = path.vertices[(i + 1) % n];
    const int e = surface_.mesh.find_edge(v, w);
    const auto& edge = surface_.mesh.edges[e];
    if (edge.border() || layout_.face_patch[edge.f0] != patch || layout_.face_patch[edge.f1] != patch)
      continue;
    const Vector3 direction = (surface_.mesh.points[w] - surface_.mesh.points[v]).normalized();
    const double along = surface_.guide.ruling_direction[edge.f0].dot(direction);
    const double crossing = 1 - surface_.guide.strength[edge.f0] * along * along;
    sum += std::min(distance_.at(TracingGraph::node(v, path.dirs[i])), 1.0) * (0.4 + 0.6 * crossing);
    ++count;
  }
  return count == 0 ? 0 : sum / count;
}

// Inserts the best fitting candidate for each bad patch that has not been cut in this round; false if none
// was found.
bool LayoutSearch::insert_best(const std::vector<int>& bad) {
  // Candidates that touch what is there are dropped for good; those too near to a parallel one as well.
  std::vector<Path> kept;
  for (Path& c : candidates_)
    if (network_.fits(c) && distance_.mean(c) > params_.min_spacing_edges * edge_length_)
      kept.push_back(std::move(c));
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
    const auto known = evaluator_->patch(before, p);
    PatchEvaluation asked = *known;
    if (known->viable() || known->verdict == PatchVerdict::kError) asked.verdict = reason;
    const std::vector<int> edges = split_around(before, p, asked);
    if (edges.empty()) continue;
    network_.insert_edges(edges, PathKind::kCut);
    ++done;
  }
  if (done > 0) changed();
  return done;
}

int LayoutSearch::give_away(const std::vector<int>& patches) {
  int done = 0;
  const PatchLayout before = layout();
  for (int p : patches) {
    std::vector<int> longest;
    double length = 0;
    for (const ArchUse& use : before.patches[p].boundary) {
      const Arch& arch = before.arches[use.arch];
      if (arch.left < 0 || arch.right < 0 || arch.length <= length ||
          !network_.network().used(arch.edges[0]) || is_held(network_.network().kinds[arch.path]))
        continue;
      const std::vector<int> edges = with_loose_ends(arch.edges);
      if (!edges.empty()) longest = edges, length = arch.length;
    }
    if (longest.empty()) continue;
    network_.remove_edges(longest);
    ++done;
  }
  if (done > 0) changed(), places_.clear();
  return done;
}

void LayoutSearch::insert() {
  for (int round = 0; round < 200; ++round) {
    context_.report(Stage::kInsert, 0.3 * round / (round + 10.0));
    const std::vector<int> bad = topologically_bad();
    if (bad.empty()) break;
    if (!insert_best(bad) && split(bad, PatchVerdict::kTooManySides) == 0) break;
  }
  settle();
}

// Smoothing shifts the outlines a little, so what fitted before is looked at again.
void LayoutSearch::settle() {
  for (int pass = 0; pass < 4; ++pass) {
    smooth();
    if (insert_for_geometry() == 0) break;
  }
}

void LayoutSearch::reject(const std::vector<int>& patches) {
  for (int p : patches) evaluator_->reject(layout().patches[p]);
}

// Patches that break a rule alone, or, when none does, in the global morph.
std::vector<int> LayoutSearch::geometrically_bad() {
  std::vector<int> bad;
  const auto evaluations = evaluator_->patches(layout());
  for (int p = 0; p < static_cast<int>(evaluations.size()); ++p)
    if (!evaluations[p]->viable()) bad.push_back(p);
  if (!bad.empty()) return bad;
  const LayoutEvaluation& e = evaluation();
  for (int p = 0; p < static_cast<int>(e.patch_error.size()); ++p)
    if (e.patch_error[p] > params_.evaluation.e_max) bad.push_back(p);
  return bad;
}

// Returns the number of rounds in which something was inserted.
int LayoutSearch::insert_for_geometry() {
  int last_failing = 1 << 30, stuck = 0;
  for (int round = 0; round < 60; ++round) {
    context_.report(Stage::kInsert, 0.3 + 0.7 * round / (round + 6.0));
    const std::vector<int> bad = geometrically_bad();
    if (bad.empty()) return round;
    stuck = static_cast<int>(bad.size()) < last_failing ? 0 : stuck + 1;
    last_failing = static_cast<int>(bad.size());
    if (stuck < 8 && insert_best(bad)) continue;
    if (split(bad, PatchVerdict::kError) == 0) return round;
  }
  return 60;
}

// The patches on either side of these edges.
std::vector<int> LayoutSearch::patches_beside(const std::vector<int>& edges) {
  std::set<int> beside;
  for (int e : edges)
    for (int f : {surface_.mesh.edges[e].f0, surface_.mesh.edges[e].f1})
      if (f >= 0) beside.insert(layout().face_patch[f]);
  return {beside.begin(), beside.end()};
}

std::vector<int> LayoutSearch::faces_of(const std::vector<int>& patches) const {
  std::vector<int> faces;
  for (int p : patches)
    faces.insert(faces.end(), layout_.patches[p].faces.begin(), layout_.patches[p].faces.end());
  return faces;
}

// What the region becomes under another network, when all of its patches are viable alone.
std::optional<RegionFit> LayoutSearch::viable_region(const PathNetwork& trial,
                                                     const std::vector<int>& faces) {
  const PatchLayout region = extract_region(surface_.mesh, trial, surface_.versions, rules_, faces);
  RegionFit fit;
  fit.patches = static_cast<int>(region.patches.size());
  for (const Patch& p : region.patches)
    if (p.defect != TopologyDefect::kNone) return std::nullopt;
  for (int p = 0; p < fit.patches; ++p) {
    const auto e = evaluator_->patch(region, p);
    if (!e->viable()) return std::nullopt;
    fit.error = std::max(fit.error, e->error / params_.evaluation.e_max);
    fit.sides = std::max(fit.sides, static_cast<int>(e->corners.size()));
    fit.misalignment = std::max(fit.misalignment, e->rulings.misalignment);
  }
  return fit;
}

// After the network has changed over these faces: morphs the new patches with their neighbours, the rest
// held; true when all of them have strips that stay within e_max, but for those that had none before.
bool LayoutSearch::region_fits(const std::vector<int>& faces) {
  const PathNetwork& network = network_.network();
  const PatchLayout region = extract_region(surface_.mesh, network, surface_.versions, rules_,
                                            with_neighbours(surface_.mesh, network, faces));
  const LayoutEvaluation e = evaluator_->solve_region(region, places_, params_.lawson_rounds);
  if (e.max_error > params_.evaluation.e_max) return false;
  for (std::size_t p = 0; p < e.patches.size(); ++p)
    if (!e.patches[p]->has_valid_strips() && lost_.count(region.patches[p].key) == 0) return false;
  store(region, e);
  return true;
}

void LayoutSearch::store(const PatchLayout& layout, const LayoutEvaluation& e) {
  for (std::size_t a = 0; a < e.arch_unknowns.size(); ++a) {
    if (e.arch_unknowns[a].empty()) continue;
    auto& places = places_[layout.arches[a].key];
    places.clear();
    for (int u : e.arch_unknowns[a]) places.push_back(e.position[u]);
  }
}

void LayoutSearch::have_places() {
  if (!places_.empty()) return;
  const LayoutEvaluation& e = evaluation();
  store(layout_, e);
}

bool LayoutSearch::try_remove(const std::vector<int>& edges) {
  if (edges.empty() || network_.leaves_loose_end(edges)) return false;
  const std::vector<int> beside = patches_beside(edges), faces = faces_of(beside);
  have_places();
  PathNetwork trial = network_.network();
  for (int e : edges) trial.edge_path[e] = PathNetwork::kFree;
  if (!viable_region(trial, faces)) return false;
  std::vector<int> paths;
  for (int e : edges) paths.push_back(network_.network().edge_path[e]);
  PatchLayout before = std::move(layout_);
  network_.remove_edges(edges);
  changed();
  const std::vector<Relabelled> joined = join_straight(edges);
  if (region_fits(faces)) return true;
  for (auto arch = joined.rbegin(); arch != joined.rend(); ++arch)
    network_.restore_edges(arch->edges, arch->path);
  if (!joined.empty() && region_fits(faces)) return true;
  network_.restore_edges(edges, paths);
  layout_ = std::move(before);
  layout_valid_ = true;
  return false;
}

// The arch that leaves vertex v over this edge, as far as its next node.
LayoutSearch::Walk LayoutSearch::arch_from(int v, int edge) const {
  const PathNetwork& net = network_.network();
  Walk walk{{v}, {}};
  while (edge >= 0) {
    walk.edges.push_back(edge);
    const int at = surface_.mesh.edges[edge].other(walk.vertices.back());
    walk.vertices.push_back(at);
    int next = -1, others = 0;
    for (const int* r = surface_.mesh.ring_begin_of(at); r != surface_.mesh.ring_end_of(at); ++r)
      if (*r != edge && net.used(*r)) ++others, next = *r;
    const bool goes_on = others == 1 && net.edge_path[next] == net.edge_path[edge] && at != v;
    edge = goes_on ? next : -1;
  }
  return walk;
}

// Where only two arches are left at a vertex and go on within 50 degrees, they become one path: no node, no
// corner. What was changed to that end, in order.
std::vector<LayoutSearch::Relabelled> LayoutSearch::join_straight(const std::vector<int>& removed) {
  const PathNetwork& net = network_.network();
  std::vector<Relabelled> changes;
  for (int e : removed)
    for (int v : {surface_.mesh.edges[e].v0, surface_.mesh.edges[e].v1}) {
      std::vector<int> at;
      for (const int* r = surface_.mesh.ring_begin_of(v); r != surface_.mesh.ring_end_of(v); ++r)
        if (net.used(*r)) at.push_back(*r);
      if (at.size() != 2 || net.edge_path[at[0]] == net.edge_path[at[1]]) continue;
      const auto movable = [&](int edge) { return !is_held(net.kinds[net.edge_path[edge]]); };
      if (!movable(at[0]) || !movable(at[1])) continue;
      const Walk one = arch_from(v, at[0]), other = arch_from(v, at[1]);
      if (direction_of(one).dot(direction_of(other)) > -std::cos(50 * 3.14159265358979 / 180)) continue;
      changes.push_back({other.edges, std::vector<int>(other.edges.size(), net.edge_path[at[1]])});
      network_.restore_edges(other.edges, std::vector<int>(other.edges.size(), net.edge_path[at[0]]));
    }
  return changes;
}

// Where an arch sets out to, over a few edges.
Vector3 LayoutSearch::direction_of(const Walk& arch) const {
  const std::size_t reach = std::min<std::size_t>(arch.edges.size(), 4);
  return (surface_.mesh.points[arch.vertices[reach]] - surface_.mesh.points[arch.vertices[0]]).normalized();
}

void LayoutSearch::know_lost() {
  const auto evaluations = evaluator_->patches(layout());
  lost_.clear();
  for (std::size_t p = 0; p < evaluations.size(); ++p)
    if (!evaluations[p]->has_valid_strips()) lost_.insert(layout_.patches[p].key);
}

void LayoutSearch::remove_paths() {
  know_lost();
  const int count = static_cast<int>(network_.network().kinds.size());
  for (bool removed = true; removed;) {
    removed = false;
    for (int path = count - 1; path > 0; --path) {
      context_.report(Stage::kRemove, 0.4 * (count - path) / count);
      const PathKind kind = network_.network().kinds[path];
      if (is_held(kind)) continue;
      removed |= try_remove(network_.edges_of_path(path));
    }
  }
}

// Frees the edges, and the loose ends that this leaves; empty when a loose end may not go.
std::vector<int> LayoutSearch::with_loose_ends(std::vector<int> edges) const {
  const PathNetwork& net = network_.network();
  std::unordered_set<int> gone(edges.begin(), edges.end());
  auto remaining = [&](int v) {
    std::pair<int, int> degree_and_edge{0, -1};
    for (const int* e = surface_.mesh.ring_begin_of(v); e != surface_.mesh.ring_end_of(v); ++e)
      if (net.used(*e) && !gone.count(*e)) ++degree_and_edge.first, degree_and_edge.second = *e;
    return degree_and_edge;
  };
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (int v : {surface_.mesh.edges[edges[i]].v0, surface_.mesh.edges[edges[i]].v1}) {
      const auto [degree, e] = remaining(v);
      if (degree != 1) continue;
      const PathKind kind = net.kinds[net.edge_path[e]];
      if (is_held(kind)) return {};
      edges.push_back(e);
      gone.insert(e);
    }
  return edges;
}

// Whether the two patches beside these edges become one with too many corners: tells without a chart, from
// the angles that they have where they stay, and from the sum of both angles where the edges end.
bool LayoutSearch::too_many_corners(const std::vector<int>& beside, const std::vector<int>& edges) {
  if (beside.size() > 2) return false;  // what becomes of them may be more than one patch
  std::unordered_map<int, std::vector<NodeTurn>> at_ends;
  for (int e : edges) at_ends[surface_.mesh.edges[e].v0], at_ends[surface_.mesh.edges[e].v1];
  int corners = 0;
  for (int p : beside)
    for (const NodeTurn& turn : evaluator_->patch(layout_, p)->turns) {
      const auto end = at_ends.find(turn.vertex);
      if (end == at_ends.end()) {
        corners += std::abs(turn.angle) > turn.limit + kFirm;
      } else {
        end->second.push_back(turn);
      }
    }
  for (const auto& [vertex, turns] : at_ends)
    if (turns.size() == 2 && network_degree(surface_.mesh, network_.network(), vertex) > 2)
      corners += std::abs(turns[0].angle + turns[1].angle - 180) > params_.evaluation.corner_turn + kFirm;
  return corners > params_.evaluation.max_sides;
}

// Whether the patches beside these edges bend both ways by too much to become one that any strips follow
// within the tolerance: told by the root of the mean Gaussian curvature over the squared width, which is what
// a sagitta is. O(faces).
bool LayoutSearch::too_round(const std::vector<int>& beside, double inner_length) const {
  double area = 0, outline = -2 * inner_length, gauss = 0;
  for (int p : beside) {
    const Patch& patch = layout_.patches[p];
    area += patch.area;
    for (const ArchUse& use : patch.boundary) outline += layout_.arches[use.arch].length;
    for (int f : patch.faces) gauss += (*face_gauss_)[f];
  }
  const double width = 2 * area / std::max(outline, 1e-9);
  return std::sqrt(gauss / area) * width * width > kTooRound * params_.evaluation.e_max;
}

// What the removal of an arch is worth: the length and parts that go, less where the tolerance is nearly used
// up or many sides result. Negative when it is not viable. Thread-safe.
double LayoutSearch::merge_value(int arch) {
  const std::vector<int> edges = with_loose_ends(layout_.arches[arch].edges);
  if (edges.empty()) return -1;
  PathNetwork trial = network_.network();
  double length = 0;
  for (int e : edges) trial.edge_path[e] = PathNetwork::kFree, length += surface_.mesh.edge_length(e);
  const std::vector<int> beside = patches_beside(edges);
  if (too_round(beside, length) || too_many_corners(beside, edges)) return -1;
  const auto fit = viable_region(trial, faces_of(beside));
  if (!fit) return -1;
  const double side_factor = fit->sides <= 4 ? 1.0 : fit->sides == 5 ? 0.6 : 0.35;
  const double parts = static_cast<double>(beside.size()) - fit->patches;
  const double flow = std::max(1 - 3.0 * fit->misalignment, 0.05);  // rulings that follow the shape
  const double value = (length + 0.15 * parts) * (1.05 - fit->error * fit->error) * side_factor * flow;
  return value + kInsideValue * length_inside(edges);
}

std::vector<std::pair<std::uint64_t, int>> LayoutSearch::removable_arches(const PatchLayout& now) const {
  std::vector<std::pair<std::uint64_t, int>> arches;
  for (int a = 0; a < static_cast<int>(now.arches.size()); ++a) {
    const Arch& arch = now.arches[a];
    const PathKind kind = network_.network().kinds[arch.path];
    if (arch.left < 0 || arch.right < 0 || arch.path == kept_path_ || is_held(kind)) continue;
    std::uint64_t left = now.patches[arch.left].key, right = now.patches[arch.right].key;
    arches.emplace_back(combine(arch.key, combine(std::min(left, right), std::max(left, right))), a);
  }
  return arches;
}

void LayoutSearch::remove_arches() {
  know_lost();
  while (true) {
    const PatchLayout& now = layout();
    const auto arches = removable_arches(now);
    std::vector<int> fresh;
    for (const auto& [key, a] : arches)
      if (!merge_values_.count(key)) fresh.push_back(a);
    std::vector<double> values(now.arches.size(), -1);
    parallel_for(context_, static_cast<int>(fresh.size()),
                 [&](int i) { values[fresh[i]] = merge_value(fresh[i]); });
    std::vector<std::pair<double, std::pair<std::uint64_t, int>>> order;
    for (const auto& [key, a] : arches) {
      const auto it = merge_values_.emplace(key, values[a]).first;
      if (it->second > 0) order.push_back({-it->second, {key, a}});
    }
    std::sort(order.begin(), order.end());
    bool removed = false;
    for (const auto& [value, which] : order) {
      context_.report(Stage::kRemove, 0.7);
      if ((removed = try_remove(with_loose_ends(now.arches[which.second].edges)))) break;
      merge_values_[which.first] = -1;
    }
    if (!removed) return;
  }
}

// Parts first, then the length of the cuts.
double LayoutSearch::objective() {
  double length = 0;
  for (const Arch& a : layout().arches)
    if (a.left >= 0 && a.right >= 0) length += a.length;
  return static_cast<double>(layout_.patches.size()) + 0.08 * length + kInsideCost * length_inside();
}

}  // namespace sheetform
