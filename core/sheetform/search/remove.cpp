// The part of the search that removes: whole paths, single arches, and what leaves darts.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>
#include <unordered_map>
#include <unordered_set>

#include "sheetform/search/layout_search.h"

namespace sheetform {
namespace {

// Degrees beyond its limit from which a corner stays one when the patch grows.
constexpr double kFirm = 5;
// Of all merges that succeed, 0.5 % are above it (at 1, 2 and 5 %), of those that are too far off 20 to 60 %.
constexpr double kTooRound = 9;
// Merges with more corners, bends of the outline with them, are not tried, nor darts: 33 meshes at 2 % take
// as many parts, in 3 % less time.
constexpr int kMostTurns = 10, kMostTurnsOfDart = 8;
// Of a diagonal inside of a region where no seam is wanted: its removal goes before all others.
constexpr double kInsideValue = 100;
// A merge counts less by so much of the misalignment of its rulings: twelve instead of three give 62 % within
// 15 degrees of the direction of least curvature instead of 60.5 (mean of 33 meshes at 2 %), and smoother
// arches, for 1 % more parts.
constexpr double kFlow = 12;
constexpr int kLeastHalved = 4;     // edges
constexpr std::size_t kAtOnce = 4;  // arches that lie apart and go at the same time

std::uint64_t combine(std::uint64_t a, std::uint64_t b) {
  return (a ^ (b + 0x9e3779b97f4a7c15ull + (a << 6) + (a >> 2))) * 0xff51afd7ed558ccdull;
}

}  // namespace

// Whether what becomes of the patches beside these edges is viable alone. Thread-safe.
bool LayoutSearch::fits_without(const std::vector<int>& edges, bool leaves_dart) {
  if (edges.empty() || (!leaves_dart && network_.leaves_loose_end(edges))) return false;
  PathNetwork trial = network_.network();
  for (int e : edges) trial.edge_path[e] = PathNetwork::kFree;
  return viable_region(trial, faces_of(patches_beside(edges))).has_value();
}

// What becomes of the patches around without these edges, where they fit then: with what is left joined where
// it goes on straight, or as it is. Thread-safe.
std::optional<LayoutSearch::Removed> LayoutSearch::fitted_without(const std::vector<int>& edges,
                                                                  bool leaves_dart) {
  if (!fits_without(edges, leaves_dart)) return std::nullopt;
  const std::vector<int> faces = faces_of(patches_beside(edges));
  EditableNetwork left = network_;
  left.remove_edges(edges);
  const EditableNetwork as_cut = left;
  bool joined = join_straight(edges, left);
  std::optional<Fitted> fit = fitted(left.network(), faces);
  if (!fit && joined) {
    joined = false;
    fit = fitted(as_cut.network(), faces);
  }
  if (!fit) return std::nullopt;
  return Removed{edges, joined, std::move(*fit)};
}

void LayoutSearch::take(const Removed& removed) {
  network_.remove_edges(removed.edges);
  if (removed.joined) join_straight(removed.edges, network_);
  changed();
  store(removed.fit.layout, removed.fit.evaluation);
}

bool LayoutSearch::try_remove(const std::vector<int>& edges) {
  have_places();
  const std::optional<Removed> left = fitted_without(edges);
  if (left) take(*left);
  return left.has_value();
}

// The arch that leaves vertex v over this edge, as far as its next node.
LayoutSearch::Walk LayoutSearch::arch_from(const PathNetwork& net, int v, int edge) const {
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
// corner. Whether there are any.
bool LayoutSearch::join_straight(const std::vector<int>& removed, EditableNetwork& network) const {
  const PathNetwork& net = network.network();
  bool joined = false;
  for (int e : removed)
    for (int v : {surface_.mesh.edges[e].v0, surface_.mesh.edges[e].v1}) {
      std::vector<int> at;
      for (const int* r = surface_.mesh.ring_begin_of(v); r != surface_.mesh.ring_end_of(v); ++r)
        if (net.used(*r)) at.push_back(*r);
      if (at.size() != 2 || net.edge_path[at[0]] == net.edge_path[at[1]]) continue;
      const auto movable = [&](int edge) { return !is_held(net.kinds[net.edge_path[edge]]); };
      if (!movable(at[0]) || !movable(at[1])) continue;
      const Walk one = arch_from(net, v, at[0]), other = arch_from(net, v, at[1]);
      if (direction_of(one).dot(direction_of(other)) > -std::cos(50 * 3.14159265358979 / 180)) continue;
      network.restore_edges(other.edges, std::vector<int>(other.edges.size(), net.edge_path[at[0]]));
      joined = true;
    }
  return joined;
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
  std::vector<int> paths;
  for (int path = count - 1; path > 0; --path)
    if (!is_held(network_.network().kinds[path])) paths.push_back(path);
  const int n = static_cast<int>(paths.size());
  for (bool removed = true; removed;) {
    removed = false;
    for (int i = 0; i < n;) {
      context_.report(Stage::kRemove, 0.4 * (count - paths[i]) / count);
      layout(), have_places();
      std::vector<std::optional<Removed>> left(n - i);
      const int goes = first_of(context_, n - i, [&](int k) {
        context_.checkpoint();
        left[k] = fitted_without(network_.edges_of_path(paths[i + k]));
        return left[k].has_value();
      });
      i += goes + 1;
      if (i > n) break;
      take(*left[goes]);
      removed = true;
    }
  }
}

// Frees the edges, and the loose ends that this leaves; empty when a loose end may not go.
std::vector<int> LayoutSearch::with_loose_ends(const PathNetwork& net, std::vector<int> edges,
                                               int tip) const {
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
      if (degree != 1 || v == tip) continue;
      const PathKind kind = net.kinds[net.edge_path[e]];
      if (is_held(kind)) return {};
      edges.push_back(e);
      gone.insert(e);
    }
  return edges;
}

// Whether the two patches beside these edges become one with too many corners, or with more than `most` with
// those that may bend within a side.
bool LayoutSearch::too_many_corners(const std::vector<int>& beside, const std::vector<int>& edges, int most) {
  if (beside.size() != 2) return false;  // what becomes of them may be more than one patch
  const CornerCount count = corners_without(beside, edges);
  return count.corners > params_.evaluation.max_sides || count.corners + count.bends > most;
}

// Those that these patches have together when the edges between them go: told without a chart, from the
// angles that they have where they stay, and from the sum of the angles where the edges end. A slit that
// stays has a corner at its tip. None where an angle is not known.
LayoutSearch::CornerCount LayoutSearch::corners_without(const std::vector<int>& beside,
                                                        const std::vector<int>& edges) const {
  const std::unordered_set<int> gone(edges.begin(), edges.end());
  std::unordered_map<int, std::vector<double>> at_ends;  // by vertex
  CornerCount count;
  for (int p : beside) {
    const std::vector<ArchUse>& uses = layout_.patches[p].boundary;
    const std::vector<NodeTurn>& turns = evaluator_->patch(layout_, p)->turns;
    if (turns.size() != uses.size()) return {};
    for (std::size_t i = 0; i < uses.size(); ++i) {
      const ArchUse &in = uses[(i + uses.size() - 1) % uses.size()], &out = uses[i];
      const std::vector<int>&to = layout_.arches[in.arch].edges, &from = layout_.arches[out.arch].edges;
      const bool in_goes = gone.count(in.forward ? to.back() : to.front()) > 0,
                 out_goes = gone.count(out.forward ? from.front() : from.back()) > 0,
                 out_ends = gone.count(out.forward ? from.back() : from.front()) > 0;
      if (in_goes != out_goes)
        at_ends[turns[i].vertex].push_back(turns[i].angle);
      else if (!in_goes && std::abs(turns[i].angle) > turns[i].limit + kFirm)
        ++(turns[i].may_bend ? count.bends : count.corners);
      if (p == beside[0] && out_goes != out_ends) ++count.corners;  // a tip
    }
  }
  for (const auto& [vertex, angles] : at_ends)
    if (angles.size() >= 2 && angles.size() <= beside.size() &&
        network_degree(surface_.mesh, network_.network(), vertex) > 2) {
      const double inside = 180.0 * static_cast<double>(angles.size() - 1);
      const double turn = std::accumulate(angles.begin(), angles.end(), -inside);
      count.corners += std::abs(turn) > params_.evaluation.corner_turn + kFirm;
    }
  return count;
}

// Whether the patches beside these edges bend both ways by too much to become one. O(faces).
bool LayoutSearch::too_round(const std::vector<int>& beside, double inner_length) const {
  double area = 0, outline = -2 * inner_length, gauss = 0;
  for (int p : beside) {
    const Patch& patch = layout_.patches[p];
    area += patch.area;
    for (const ArchUse& use : patch.boundary) outline += layout_.arches[use.arch].length;
    gauss += gauss_of(patch);
  }
  return too_round(area, outline, gauss);
}

// Whether no strips follow such a patch within the tolerance: told by the root of the mean Gaussian curvature
// over the squared width, which is what a sagitta is.
bool LayoutSearch::too_round(double area, double outline, double gauss) const {
  const double width = 2 * area / std::max(outline, 1e-9);
  return std::sqrt(gauss / area) * width * width > kTooRound * params_.evaluation.e_max;
}

// What the removal of an arch is worth: the length and parts that go, less where the tolerance is nearly used
// up or many sides result. Negative when it is not viable; where that is hopeless, the faces of it are told.
// Thread-safe.
double LayoutSearch::merge_value(const Removal& removal, std::vector<int>& hopeless) {
  const std::vector<int>& edges = removal.edges;
  if (edges.empty()) return -1;
  PathNetwork trial = network_.network();
  double length = 0;
  for (int e : edges) trial.edge_path[e] = PathNetwork::kFree, length += surface_.mesh.edge_length(e);
  const std::vector<int> beside = patches_beside(edges);
  if (!removal.leaves_dart && too_round(beside, length)) return -1;
  if (too_many_corners(beside, edges, removal.leaves_dart ? kMostTurnsOfDart : kMostTurns)) return -1;
  const auto has = [&](int face) {
    return std::find(beside.begin(), beside.end(), layout_.face_patch[face]) != beside.end();
  };
  if (!removal.leaves_dart && covers_hopeless(has)) return -1;
  const auto fit = viable_region(trial, faces_of(beside), removal.leaves_dart ? nullptr : &hopeless);
  if (!fit) return -1;
  const double side_factor = fit->sides <= 4 ? 1.0 : fit->sides == 5 ? 0.6 : 0.35;
  const double parts = static_cast<double>(beside.size()) - fit->patches;
  const double flow = std::max(1 - kFlow * fit->misalignment, 0.05);  // rulings that follow the shape
  const double value = (length + 0.15 * parts) * (1.05 - fit->error * fit->error) * side_factor * flow;
  return value + kInsideValue * length_inside(edges);
}

bool LayoutSearch::may_go(const Arch& arch) const {
  return arch.left >= 0 && arch.right >= 0 && arch.path != kept_path_ &&
         !is_held(network_.network().kinds[arch.path]);
}

std::uint64_t LayoutSearch::merge_key(const PatchLayout& now, const Arch& arch) const {
  const std::uint64_t left = now.patches[arch.left].key, right = now.patches[arch.right].key;
  return combine(arch.key, combine(std::min(left, right), std::max(left, right)));
}

// Every arch that may go.
std::vector<LayoutSearch::Removal> LayoutSearch::whole_arches(const PatchLayout& now) const {
  std::vector<Removal> all;
  for (const Arch& arch : now.arches)
    if (may_go(arch)) all.push_back({with_loose_ends(arch.edges), false, merge_key(now, arch)});
  return all;
}

// What may go of arches where darts stay: the whole arch but not what hung on it, or one half of it.
std::vector<LayoutSearch::Removal> LayoutSearch::dart_leavers(const PatchLayout& now) const {
  std::vector<Removal> all;
  if (!rules_.darts) return all;
  const auto is_tip = [&](int v) { return network_degree(surface_.mesh, network_.network(), v) == 1; };
  for (const Arch& arch : now.arches) {
    if (!may_go(arch)) continue;
    const std::uint64_t key = merge_key(now, arch);
    if (network_.leaves_loose_end(arch.edges)) all.push_back({arch.edges, true, combine(key, 1)});
    const auto n = static_cast<std::ptrdiff_t>(arch.edges.size());
    if (arch.closed() || n < kLeastHalved) continue;
    const auto half = [&](auto begin, int tip, std::uint64_t which) {
      all.push_back({with_loose_ends({begin, begin + n / 2}, tip), true, combine(key, which)});
    };
    if (!is_tip(arch.vertices.back())) half(arch.edges.begin(), arch.vertices[n / 2], 2);
    if (!is_tip(arch.vertices.front())) half(arch.edges.end() - n / 2, arch.vertices[n - n / 2], 3);
  }
  return all;
}

// These patches and those around them.
std::set<int> LayoutSearch::with_those_around(const std::vector<int>& patches) const {
  std::set<int> all(patches.begin(), patches.end());
  for (int p : patches)
    for (const ArchUse& use : layout_.patches[p].boundary)
      for (int q : {layout_.arches[use.arch].left, layout_.arches[use.arch].right})
        if (q >= 0) all.insert(q);
  return all;
}

// Of what is left of `order` the first, and the next ones that concern none of the same patches; they are
// taken out of it.
std::vector<int> LayoutSearch::apart(const std::vector<Removal>& all, std::vector<int>& order) {
  std::vector<char> taken(layout().patches.size(), 0);
  std::vector<int> chosen, left;
  for (int r : order) {
    std::set<int> around;
    if (chosen.size() < kAtOnce) around = with_those_around(patches_beside(all[r].edges));
    const bool goes =
        !around.empty() && std::none_of(around.begin(), around.end(), [&](int p) { return taken[p] != 0; });
    (goes ? chosen : left).push_back(r);
    if (goes)
      for (int p : around) taken[p] = 1;
  }
  order = std::move(left);
  return chosen;
}

// The most rewarding of these that is viable goes, and others with it that lie apart; false when none does.
bool LayoutSearch::remove_best(const std::vector<Removal>& all) {
  // Those whose value is not known, what takes longest first.
  std::vector<std::pair<double, int>> fresh;
  for (int r = 0; r < static_cast<int>(all.size()); ++r) {
    if (merge_values_.count(all[r].key)) continue;
    double area = 0;
    for (int p : patches_beside(all[r].edges)) area += layout_.patches[p].area;
    fresh.emplace_back(-area, r);
  }
  std::sort(fresh.begin(), fresh.end());
  std::vector<double> values(all.size(), -1);
  std::vector<std::vector<int>> hopeless(all.size());
  parallel_for(context_, static_cast<int>(fresh.size()), [&](int i) {
    const int r = fresh[i].second;
    values[r] = merge_value(all[r], hopeless[r]);
  });
  remember_hopeless(std::move(hopeless));
  std::vector<std::tuple<double, std::uint64_t, int>> by_value;
  for (int r = 0; r < static_cast<int>(all.size()); ++r) {
    const auto it = merge_values_.emplace(all[r].key, values[r]).first;
    if (it->second > 0) by_value.emplace_back(-it->second, all[r].key, r);
  }
  std::sort(by_value.begin(), by_value.end());
  std::vector<int> order;
  for (const auto& [value, key, r] : by_value) order.push_back(r);
  while (!order.empty()) {
    have_places();
    bool any = false;
    context_.report(Stage::kRemove, 0.7);
    const std::vector<int> chosen = apart(all, order);
    std::vector<std::optional<Removed>> left(chosen.size());
    parallel_for(context_, static_cast<int>(chosen.size()),
                 [&](int i) { left[i] = fitted_without(all[chosen[i]].edges, all[chosen[i]].leaves_dart); });
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      if (left[i])
        take(*left[i]), any = true;
      else
        merge_values_[all[chosen[i]].key] = -1;
    }
    if (any) return true;
  }
  return false;
}

void LayoutSearch::remove_arches() {
  know_lost();
  while (remove_best(whole_arches(layout()))) {
  }
}

void LayoutSearch::leave_darts() {
  know_lost();
  while (remove_best(whole_arches(layout())) || remove_best(dart_leavers(layout()))) {
  }
}

}  // namespace sheetform
