// The part of the search that lets patches grow that are too small to handle.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <queue>
#include <set>
#include <tuple>
#include <utility>

#include "sheetform/search/layout_search.h"

namespace sheetform {
namespace {

constexpr double kLeastArea = 0.0031;  // of the surface: a little more than is promised
// Of a diagonal; of the rectangle of the same area and outline: seams that wind make it a quarter less than
// it is.
constexpr double kLeastWidth = 0.015;
constexpr double kUsualShare = 0.8;  // of their area on the surface small patches keep as strips
constexpr double kGain = 0.05;       // of what patches lack, together, from which a change counts
// Multiples of the area that a patch has to get; the last is for those that cannot have more.
constexpr std::array<double, 4> kTargets{1.3, 2.2, 4, 1};
constexpr std::size_t kMostGivers = 4;  // with more of them the ways to choose two become too many
// With so many parts small ones are what the tolerance asks for, and there are too many of them to try.
constexpr std::size_t kMostParts = 40;

// Of the rectangle that has this area and this outline; of a square where none has.
double width_of(double area, double outline) {
  const double root = outline * outline / 4 - 4 * area;
  return (outline / 2 - std::sqrt(std::max(root, 0.0))) / 2;
}

double width_of(const PatchLayout& layout, const Patch& patch) {
  double outline = 0;
  for (const ArchUse& use : patch.boundary) outline += layout.arches[use.arch].length;
  return width_of(patch.area, outline);
}

}  // namespace

// The share of half of a symmetric surface counts in the whole.
double LayoutSearch::least_area() const {
  return kLeastArea * surface_area(surface_.mesh) * (surface_.plane.vertex.empty() ? 1 : 2);
}

// As strips, of which a patch that is no larger than the tolerance loses a part.
double LayoutSearch::strip_area(const Patch& patch) const {
  const auto it = strip_share_.find(patch.key);
  return patch.area * (it == strip_share_.end() ? kUsualShare : it->second);
}

// On the surface, so that its strips are large and wide enough.
double LayoutSearch::area_wanted(const Patch& patch) const {
  const double wide = patch.area * kLeastWidth / std::max(width_of(layout_, patch), 1e-9);
  return std::max(least_area() * patch.area / std::max(strip_area(patch), 0.05 * patch.area), wide);
}

// What a patch lacks to be handled, from 0 to 1.
double LayoutSearch::lacks(const PatchLayout& layout, const Patch& patch) const {
  const double by_area = strip_area(patch) / least_area(), by_width = width_of(layout, patch) / kLeastWidth;
  return std::max(0.0, 1 - std::min(by_area, by_width));
}

double LayoutSearch::lacks(const PatchLayout& layout) const {
  double sum = 0;
  for (const Patch& p : layout.patches) sum += lacks(layout, p);
  return sum;
}

// The faces of these patches nearest to the patch, as many as make up this area, and where they go: to it.
// Ways do not cross lines that are held.
std::map<int, int> LayoutSearch::nearest_around(int patch, const std::vector<int>& from, double area) const {
  const SurfaceMesh& mesh = surface_.mesh;
  const PathNetwork& net = network_.network();
  std::map<int, double> nearest;
  std::priority_queue<std::pair<double, int>> open;
  const auto reach = [&](int f, int over, double distance) {
    if (net.used(over) && is_held(net.kinds[net.edge_path[over]])) return;
    if (std::find(from.begin(), from.end(), layout_.face_patch[f]) == from.end()) return;
    const auto [it, fresh] = nearest.emplace(f, distance);
    if (!fresh && it->second <= distance) return;
    it->second = distance;
    open.emplace(-distance, f);
  };
  for (int f : layout_.patches[patch].faces)
    for (int k = 0; k < 3; ++k) {
      const int e = mesh.face_edges[f][k], g = mesh.face_neighbours[f][k];
      if (g < 0) continue;
      reach(
          g, e,
          (mesh.face_middle(g) - (mesh.points[mesh.edges[e].v0] + mesh.points[mesh.edges[e].v1]) / 2).norm());
    }
  std::map<int, int> to;
  while (!open.empty() && area > 0) {
    const auto [distance, f] = open.top();
    open.pop();
    if (nearest.at(f) != -distance || !to.emplace(f, patch).second) continue;
    area -= mesh.face_normal_raw(f).norm() / 2;
    for (int k = 0; k < 3; ++k) {
      const int g = mesh.face_neighbours[f][k];
      if (g >= 0)
        reach(g, mesh.face_edges[f][k], -distance + (mesh.face_middle(f) - mesh.face_middle(g)).norm());
    }
  }
  return to;
}

// What this would cut off from a patch that gives, but for its largest piece, goes with the rest.
void LayoutSearch::add_cut_off(const std::vector<int>& from, std::map<int, int>& to) const {
  const int patch = to.begin()->second;
  const PathNetwork& net = network_.network();
  for (int giver : from) {
    std::vector<std::vector<int>> pieces;
    std::set<int> seen;
    for (int start : layout_.patches[giver].faces) {
      if (to.count(start) > 0 || !seen.insert(start).second) continue;
      std::vector<int> piece{start};
      for (std::size_t i = 0; i < piece.size(); ++i)
        for (int k = 0; k < 3; ++k) {
          const int g = surface_.mesh.face_neighbours[piece[i]][k];
          if (g < 0 || layout_.face_patch[g] != giver || to.count(g) > 0) continue;
          if (net.used(surface_.mesh.face_edges[piece[i]][k])) continue;
          if (seen.insert(g).second) piece.push_back(g);
        }
      pieces.push_back(std::move(piece));
    }
    std::stable_sort(pieces.begin(), pieces.end(),
                     [](const auto& a, const auto& b) { return a.size() > b.size(); });
    for (std::size_t i = 1; i < pieces.size(); ++i)
      for (int f : pieces[i]) to.emplace(f, patch);
  }
}

LayoutSearch::Sharing LayoutSearch::handed_over(const std::map<int, int>& to,
                                                const std::vector<int>& beside) const {
  std::vector<int> faces, takers;
  for (const auto& [face, taker] : to) faces.push_back(face), takers.push_back(taker);
  return handed_over(faces, takers, beside);
}

std::vector<LayoutSearch::Sharing> LayoutSearch::growths(int patch) {
  std::vector<std::vector<int>> choices;
  std::vector<int> givers;
  for (const Taker& t : takers_of(patch)) givers.push_back(t.patch);
  if (givers.size() > 1) choices.push_back(givers);
  for (int g : givers) choices.push_back({g});
  for (std::size_t i = 0; i < givers.size() && givers.size() > 2 && givers.size() <= kMostGivers; ++i)
    for (std::size_t j = i + 1; j < givers.size(); ++j) choices.push_back({givers[i], givers[j]});
  const Patch& own = layout_.patches[patch];
  const double wanted = area_wanted(own);
  std::vector<Sharing> all;
  for (double target : kTargets)
    for (const std::vector<int>& choice : choices) {
      std::vector<int> beside = choice;
      beside.push_back(patch);
      std::map<int, int> to = nearest_around(patch, choice, target * wanted - own.area);
      if (to.empty()) continue;
      add_cut_off(choice, to);
      add_ways(handed_over(to, beside), all);
    }
  return all;
}

// Distances over these faces from one of them, from middle to middle; ways do not cross lines that are held.
std::map<int, double> LayoutSearch::distances_from(int start, const std::set<int>& inside) const {
  const SurfaceMesh& mesh = surface_.mesh;
  const PathNetwork& net = network_.network();
  std::map<int, double> distance{{start, 0}};
  std::priority_queue<std::pair<double, int>> open;
  open.emplace(0, start);
  while (!open.empty()) {
    const auto [d, f] = open.top();
    open.pop();
    if (distance.at(f) != -d) continue;
    for (int k = 0; k < 3; ++k) {
      const int e = mesh.face_edges[f][k], g = mesh.face_neighbours[f][k];
      if (g < 0 || inside.count(g) == 0 || (net.used(e) && is_held(net.kinds[net.edge_path[e]]))) continue;
      const double there = -d + (mesh.face_middle(f) - mesh.face_middle(g)).norm();
      const auto [it, fresh] = distance.emplace(g, there);
      if (!fresh && it->second <= there) continue;
      it->second = there;
      open.emplace(-there, g);
    }
  }
  return distance;
}

// The patch and a neighbour anew: each face goes to the nearer of two that lie far apart on the outline of
// both together.
std::vector<LayoutSearch::Sharing> LayoutSearch::recuts(int patch) {
  std::vector<Sharing> all;
  for (const Taker& taker : takers_of(patch)) {
    const std::vector<int> both = faces_of({patch, taker.patch});
    const std::set<int> inside(both.begin(), both.end());
    std::vector<int> rim;
    for (int f : both)
      for (int g : surface_.mesh.face_neighbours[f])
        if (inside.count(g) == 0) rim.push_back(f);
    if (rim.size() < 4) continue;
    std::vector<std::map<int, double>> from;  // the seeds
    std::vector<double> nearest(rim.size(), 1e30);
    std::size_t seed = 0;
    for (int k = 0; k <= 4; ++k) {
      std::map<int, double> d = distances_from(rim[seed], inside);
      for (std::size_t i = 0; i < rim.size(); ++i) {
        const auto it = d.find(rim[i]);
        const double there = it == d.end() ? 0 : it->second;  // beyond a line: no seed
        nearest[i] = k < 2 ? there : std::min(nearest[i], there);
      }
      if (k > 0) from.push_back(std::move(d));
      seed = std::max_element(nearest.begin(), nearest.end()) - nearest.begin();
    }
    for (std::size_t i = 0; i < from.size(); ++i)
      for (std::size_t j = i + 1; j < from.size(); ++j) {
        std::map<int, int> to;
        for (const auto& [f, d] : from[i]) {
          const auto it = from[j].find(f);
          to[f] = it == from[j].end() || d <= it->second ? patch : taker.patch;
        }
        add_ways(handed_over(to, {patch, taker.patch}), all);
      }
  }
  return all;
}

// What its neighbours could take of it as a whole, one, two or all of them.
std::vector<LayoutSearch::Sharing> LayoutSearch::ways_to_go(int patch) {
  std::vector<Sharing> all;
  for (const Taker& taker : takers_of(patch)) add_ways(sharing(patch, {taker.patch}), all);
  for (Sharing& s : sharings(patch)) all.push_back(std::move(s));
  return all;
}

bool LayoutSearch::grow(int patch, double slack) {
  return (slack > 1 && try_ways(ways_to_go(patch), slack)) || try_ways(growths(patch), slack) ||
         try_ways(recuts(patch), slack);
}

// Whether the way leaves no more patches that lack less, all viable.
bool LayoutSearch::helps(const Sharing& way) {
  EditableNetwork trial = network_;
  apply(way, trial);
  const auto region = [&](const PathNetwork& network) {
    return extract_region(surface_.mesh, network, surface_.versions, rules_, way.faces);
  };
  const PatchLayout before = region(network_.network()), after = region(trial.network());
  if (after.patches.size() > before.patches.size() || lacks(after) > lacks(before) - kGain) return false;
  std::vector<int> hopeless;  // not remembered: what may not grow may still go otherwise
  return viable_region(trial.network(), way.faces, &hopeless).has_value();
}

bool LayoutSearch::try_ways(const std::vector<Sharing>& all, double slack) {
  return try_in_order(
      all, [&](const Sharing& way, std::vector<int>&) { return helps(way); },
      [&](const Sharing& way) { return try_sharing(way, slack); });
}

void LayoutSearch::know_strip_areas(const std::vector<double>& areas) {
  for (std::size_t p = 0; p < areas.size(); ++p)
    strip_share_[layout().patches[p].key] = std::min(areas[p] / layout_.patches[p].area, 1.0);
}

int LayoutSearch::grow_slight(double slack) {
  if (layout().patches.size() > kMostParts) return 0;
  know_lost();
  const auto slight = [&](const Patch& p) { return lacks(layout_, p) > 0; };
  int done = 0;
  for (int face : smallest_first(slight)) {
    context_.report(Stage::kRemove, 1);
    const Patch& p = layout().patches[layout_.face_patch[face]];
    if (!slight(p) || goes_on_across_plane(p) ||
        !ungrown_.insert(neighbourhood_key(p) + (slack > 1 ? 1 : 0)).second)
      continue;
    const bool grown = grow(layout_.face_patch[face], slack);
    done += grown;
    if (grown && slack > 1) break;  // one at a time: the last passes have to keep the tolerance
  }
  return done;
}

}  // namespace sheetform
