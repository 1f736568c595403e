// The part of the search that shares a small patch out among its neighbours.
#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <queue>
#include <set>
#include <tuple>
#include <utility>

#include "sheetform/search/layout_search.h"

namespace sheetform {
namespace {

constexpr double kSmall = 0.1;              // of the surface: larger patches hardly ever go this way
constexpr std::size_t kMostNeighbours = 6;  // with more of them the ways to choose two become too many
constexpr std::size_t kAtOnce = 8;          // ways that are looked at side by side

}  // namespace

// The neighbours beyond arches that may go, the one with the longest seam first.
std::vector<LayoutSearch::Taker> LayoutSearch::takers_of(int patch) {
  std::map<int, Taker> by_patch;
  for (const ArchUse& use : layout().patches[patch].boundary) {
    const Arch& arch = layout_.arches[use.arch];
    if (!may_go(arch) || arch.left == arch.right) continue;
    const int q = arch.left == patch ? arch.right : arch.left;
    Taker& taker = by_patch[q];
    taker.patch = q, taker.seam += arch.length, ++taker.arches;
  }
  std::vector<Taker> takers;
  for (const auto& [q, taker] : by_patch) takers.push_back(taker);
  std::stable_sort(takers.begin(), takers.end(),
                   [](const Taker& a, const Taker& b) { return a.seam > b.seam; });
  return takers;
}

// The nearest of these neighbours of each face of the patch, ways not crossing any line; empty where there is
// none.
std::vector<int> LayoutSearch::nearest_of(int patch, const std::vector<int>& takers) const {
  const SurfaceMesh& mesh = surface_.mesh;
  const PathNetwork& net = network_.network();
  const std::vector<int>& faces = layout_.patches[patch].faces;  // ascending
  const auto place_of = [&](int f) {
    return std::lower_bound(faces.begin(), faces.end(), f) - faces.begin();
  };
  std::vector<std::pair<double, int>> nearest(faces.size(), {std::numeric_limits<double>::infinity(), -1});
  std::priority_queue<std::tuple<double, int, int>> open;
  const auto reach = [&](int f, double distance, int taker) {
    std::pair<double, int>& known = nearest[place_of(f)];
    if (known.first <= distance) return;
    known = {distance, taker};
    open.emplace(-distance, f, taker);
  };
  for (int f : faces)
    for (int k = 0; k < 3; ++k) {
      const int e = mesh.face_edges[f][k], g = mesh.face_neighbours[f][k];
      if (g < 0 || layout_.face_patch[g] == patch || is_held(net.kinds[net.edge_path[e]])) continue;
      if (std::find(takers.begin(), takers.end(), layout_.face_patch[g]) == takers.end()) continue;
      const Vector3 seam = (mesh.points[mesh.edges[e].v0] + mesh.points[mesh.edges[e].v1]) / 2;
      reach(f, (mesh.face_middle(f) - seam).norm(), layout_.face_patch[g]);
    }
  while (!open.empty()) {
    const auto [distance, f, taker] = open.top();
    open.pop();
    if (nearest[place_of(f)] != std::pair(-distance, taker)) continue;
    for (int k = 0; k < 3; ++k) {
      const int g = mesh.face_neighbours[f][k];
      if (g < 0 || layout_.face_patch[g] != patch || net.used(mesh.face_edges[f][k])) continue;
      reach(g, -distance + (mesh.face_middle(f) - mesh.face_middle(g)).norm(), taker);
    }
  }
  std::vector<int> to;
  for (const auto& [distance, taker] : nearest) {
    if (taker < 0) return {};
    to.push_back(taker);
  }
  return to;
}

// What changes in the network when these neighbours take the patch: the seams to them go, and new ones are
// cut where their shares meet.
LayoutSearch::Sharing LayoutSearch::sharing(int patch, const std::vector<int>& takers) const {
  const std::vector<int> to = nearest_of(patch, takers);
  if (to.empty()) return {};
  const std::vector<int>& own = layout_.patches[patch].faces;
  std::vector<int> beside = takers;
  beside.push_back(patch);
  return handed_over(own, to, beside);
}

// What changes in the network when these faces, ascending, go to other patches; `beside`: all patches that
// this concerns.
LayoutSearch::Sharing LayoutSearch::handed_over(const std::vector<int>& faces, const std::vector<int>& to,
                                                const std::vector<int>& beside) const {
  Sharing s;
  const auto patch_at = [&](int f) {
    const auto it = std::lower_bound(faces.begin(), faces.end(), f);
    return it == faces.end() || *it != f ? layout_.face_patch[f] : to[it - faces.begin()];
  };
  std::vector<int> edges;
  for (int f : faces)
    edges.insert(edges.end(), surface_.mesh.face_edges[f].begin(), surface_.mesh.face_edges[f].end());
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  const PathNetwork& net = network_.network();
  for (int e : edges) {
    const auto& edge = surface_.mesh.edges[e];
    if (edge.border()) continue;
    const bool apart = patch_at(edge.f0) != patch_at(edge.f1), used = net.used(e);
    if (apart && !used) s.cut.push_back(e);
    if (!apart && used && !is_held(net.kinds[net.edge_path[e]])) s.gone.push_back(e);
  }
  s.patches = static_cast<int>(beside.size());
  s.faces = faces_of(beside);
  return s;
}

// Also with the loose ends that this leaves, where there are any, as darts. Where a single arch would go that
// has been tried.
std::vector<LayoutSearch::Sharing> LayoutSearch::sharings(int patch) {
  std::vector<std::vector<int>> choices;
  std::vector<int> takers;
  for (const Taker& taker : takers_of(patch)) {
    takers.push_back(taker.patch);
    if (taker.arches > 1) choices.push_back({taker.patch});
  }
  for (std::size_t i = 0; i < takers.size() && takers.size() <= kMostNeighbours; ++i)
    for (std::size_t j = i + 1; j < takers.size(); ++j) choices.push_back({takers[i], takers[j]});
  if (takers.size() > 2) choices.push_back(takers);
  std::vector<std::vector<Sharing>> found(choices.size());
  parallel_for(context_, static_cast<int>(choices.size()),
               [&](int i) { add_ways(sharing(patch, choices[i]), found[i]); });
  std::vector<Sharing> all;
  for (std::vector<Sharing>& some : found)
    all.insert(all.end(), std::make_move_iterator(some.begin()), std::make_move_iterator(some.end()));
  return all;
}

// With the loose ends that it leaves gone, and with them as darts.
void LayoutSearch::add_ways(Sharing s, std::vector<Sharing>& all) const {
  if (s.gone.empty()) return;
  EditableNetwork cut = network_;
  cut.insert_edges(s.cut, PathKind::kCut);
  Sharing trimmed = s;
  trimmed.gone = with_loose_ends(cut.network(), s.gone);
  const bool loose = trimmed.gone.size() != s.gone.size();
  if (!trimmed.gone.empty()) all.push_back(std::move(trimmed));
  if (loose && rules_.darts) all.push_back(std::move(s));
}

void LayoutSearch::apply(const Sharing& s, EditableNetwork& network) {
  network.insert_edges(s.cut, PathKind::kCut);
  network.remove_edges(s.gone);
}

// New cuts follow the edges of the mesh: they have a staircase each.
void LayoutSearch::smooth_cuts(const std::vector<int>& edges) {
  std::set<int> done;  // by lowest edge of an arch
  for (int e : edges) {
    if (!network_.network().used(e)) continue;  // it went as a loose end
    const Arch& arch = layout().arches[layout_.edge_arch[e]];
    if (!done.insert(*std::min_element(arch.edges.begin(), arch.edges.end())).second) continue;
    smooth_arch_of(e);
  }
}

// Whether the way leaves patches that are viable alone, so many fewer than there are. Thread-safe.
bool LayoutSearch::is_viable(const Sharing& way, int fewer, std::vector<int>& hopeless) {
  EditableNetwork trial = network_;
  apply(way, trial);
  const auto fit = viable_region(trial.network(), way.faces, &hopeless);
  return fit && fit->patches <= way.patches - fewer;
}

// The first of these ways that is promising and goes. What turns out to be hopeless counts for those after
// the ones that are looked at side by side, whatever the number of threads.
bool LayoutSearch::try_in_order(const std::vector<Sharing>& ways, const Promising& promising,
                                const std::function<bool(const Sharing&)>& goes) {
  for (std::size_t begin = 0; begin < ways.size();) {
    const std::size_t n = std::min(kAtOnce, ways.size() - begin);
    std::vector<std::vector<int>> hopeless(n);
    const auto found = static_cast<std::size_t>(first_of(
        context_, static_cast<int>(n), [&](int i) { return promising(ways[begin + i], hopeless[i]); }));
    hopeless.resize(std::min(found + 1, n));
    remember_hopeless(std::move(hopeless));
    if (found < n && goes(ways[begin + found])) return true;
    begin += found + (found < n);
  }
  return false;
}

// The first that leaves fewer patches.
bool LayoutSearch::try_fewer(const std::vector<Sharing>& ways) {
  return try_in_order(
      ways, [&](const Sharing& way, std::vector<int>& hopeless) { return is_viable(way, 1, hopeless); },
      [&](const Sharing& way) { return try_sharing(way); });
}

bool LayoutSearch::share_out(int patch) { return try_fewer(sharings(patch)); }

// Undone where the patches around do not fit then, or more cuts lie where none are wanted.
bool LayoutSearch::try_sharing(const Sharing& s, double slack) {
  have_places();
  const EditableNetwork network_before = network_;
  const PatchLayout layout_before = layout_;
  const double inside = length_inside();
  apply(s, network_);
  changed();
  if (length_inside() <= inside && region_fits(s.faces, slack)) {
    smooth_cuts(s.cut);
    return true;
  }
  network_ = network_before, layout_ = layout_before;
  layout_valid_ = true;
  return false;
}

// A face of each patch that is asked for, the smallest patch first.
std::vector<int> LayoutSearch::smallest_first(const std::function<bool(const Patch&)>& asked_for) {
  std::vector<std::pair<double, int>> found;
  for (const Patch& p : layout().patches)
    if (p.defect == TopologyDefect::kNone && asked_for(p)) found.emplace_back(p.area, p.faces.front());
  std::sort(found.begin(), found.end());
  std::vector<int> faces;
  for (const auto& [area, face] : found) faces.push_back(face);
  return faces;
}

bool LayoutSearch::goes_on_across_plane(const Patch& patch) const {
  return std::any_of(patch.boundary.begin(), patch.boundary.end(),
                     [&](const ArchUse& use) { return surface_.is_straight(layout_.arches[use.arch]); });
}

int LayoutSearch::share_out_small() {
  know_lost();
  const double most = kSmall * surface_area(surface_.mesh);
  const auto small = [&](const Patch& p) { return p.area < most; };
  int done = 0;
  for (int face : smallest_first(small)) {
    context_.report(Stage::kRemove, 1);
    const Patch& p = layout().patches[layout_.face_patch[face]];
    if (!small(p) || goes_on_across_plane(p) || !unshared_.insert(neighbourhood_key(p)).second) continue;
    done += share_out(layout_.face_patch[face]);
  }
  return done;
}

// Of the patch and those around it.
std::uint64_t LayoutSearch::neighbourhood_key(const Patch& patch) const {
  std::uint64_t around = 0;
  for (const ArchUse& use : patch.boundary)
    for (int q : {layout_.arches[use.arch].left, layout_.arches[use.arch].right})
      if (q >= 0) around += layout_.patches[q].key * 0xff51afd7ed558ccdull;
  return patch.key ^ (around + 0x9e3779b97f4a7c15ull);
}

}  // namespace sheetform
