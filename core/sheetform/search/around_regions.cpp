// The part of the search that keeps seams out of the regions where the user wants none.
#include <algorithm>
#include <cmath>

#include "sheetform/search/layout_search.h"
#include "sheetform/search/split.h"

namespace sheetform {
namespace {

constexpr double kMostInside = 0.35;  // of a patch's area: with more of it inside, going around is no cut
constexpr double kMargin = 0.5;       // edges: smoothed paths keep this far from a region
constexpr int kRecuts = 3;            // new cuts around a region in place of an arch through it
constexpr int kMostTries = 100;       // arches that are tried altogether: each may be tried again and again

}  // namespace

double LayoutSearch::length_inside(const std::vector<int>& edges) const {
  double sum = 0;
  if (!surface_.keep_out.empty())
    for (int e : edges)
      if (surface_.keep_out[e]) sum += surface_.mesh.edge_length(e);
  return sum;
}

double LayoutSearch::length_inside() {
  double sum = 0;
  if (surface_.keep_out.empty()) return sum;
  for (const Arch& a : layout().arches)
    if (!is_held(network_.network().kinds[a.path])) sum += length_inside(a.edges);
  return sum;
}

// Whether a cut of the patch can go around the regions inside of it.
bool LayoutSearch::can_avoid(const Patch& patch) const {
  if (surface_.keep_out.empty()) return false;
  double inside = 0;
  for (int f : patch.faces) {
    const auto& e = surface_.mesh.face_edges[f];
    if (surface_.keep_out[e[0]] && surface_.keep_out[e[1]] && surface_.keep_out[e[2]])
      inside += surface_.mesh.face_normal_raw(f).norm() / 2;
  }
  return inside <= kMostInside * patch.area;
}

std::vector<int> LayoutSearch::split_around(const PatchLayout& before, int patch,
                                            const PatchEvaluation& evaluation, double least_share) const {
  const bool around = can_avoid(before.patches[patch]);
  return split_patch(surface_.mesh, before, patch, evaluation, around ? &surface_.keep_out : nullptr,
                     least_share);
}

Vector3 LayoutSearch::outside_regions(const Vector3& from, const Vector3& to) const {
  const KeepOut& regions = *surface_.regions;
  const double margin = kMargin * edge_length_;
  return regions.depth(from, margin) > 0 ? to : regions.pushed_out(to, margin);
}

// Removable arches through a region, the one that is longest inside first, lowest edge next.
std::vector<std::vector<int>> LayoutSearch::arches_inside() {
  std::vector<std::pair<double, std::vector<int>>> found;
  for (const Arch& arch : layout().arches)
    if (const double inside = length_inside(arch.edges); inside > 0 && may_go(arch))
      found.emplace_back(-inside, arch.edges);
  std::sort(found.begin(), found.end());
  std::vector<std::vector<int>> edges;
  for (auto& [inside, list] : found) edges.push_back(std::move(list));
  return edges;
}

void LayoutSearch::clear_regions() {
  if (surface_.keep_out.empty()) return;
  const int paths = static_cast<int>(network_.network().kinds.size());
  for (int path = paths - 1; path > 0; --path)
    if (!is_held(network_.network().kinds[path]))
      if (const auto edges = network_.edges_of_path(path); length_inside(edges) > 0) try_remove(edges);
  if (!params_.evaluation.t_junctions) return;
  int tries = 0;
  for (bool changed = true; changed && tries < kMostTries;) {
    changed = false;
    for (const std::vector<int>& edges : arches_inside()) {
      ++tries;
      context_.report(Stage::kRemove, 0.4);
      if ((changed = try_remove(with_loose_ends(edges)) || recut_around(edges))) break;
    }
  }
}

// Takes an arch out and cuts what it leaves anew, around the regions; kept when less lies inside then and it
// costs two parts at most.
bool LayoutSearch::recut_around(const std::vector<int>& arch) {
  const std::vector<int> edges = with_loose_ends(arch);
  if (edges.empty()) return false;
  const double inside = length_inside();
  const std::size_t parts = layout().patches.size();
  have_places();
  State as_it_was = state();
  const std::vector<int> faces = faces_of(patches_beside(edges));
  network_.remove_edges(edges);
  changed();
  for (int attempt = 0; attempt <= kRecuts; ++attempt) {
    if (viable_region(network_.network(), faces) && region_fits(faces)) {
      if (length_inside() < inside - 1e-9 && layout().patches.size() <= parts + 2) return true;
      break;
    }
    if (split(failing_of(faces), PatchVerdict::kError) == 0) break;
  }
  take(std::move(as_it_was));
  return false;
}

// The patches over these faces that do not fit alone; all of them when each does.
std::vector<int> LayoutSearch::failing_of(const std::vector<int>& faces) {
  std::vector<int> all, failing;
  for (int f : faces) all.push_back(layout().face_patch[f]);
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  for (int p : all)
    if (!evaluator_->patch(layout_, p)->viable()) failing.push_back(p);
  return failing.empty() ? all : failing;
}

}  // namespace sheetform
