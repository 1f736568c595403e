// The part of the search that cuts two neighbours anew, with a shorter seam between them.
#include <algorithm>
#include <array>
#include <iterator>
#include <tuple>
#include <utility>

#include "sheetform/search/layout_search.h"
#include "sheetform/search/split.h"

namespace sheetform {
namespace {

constexpr int kMostWays = 16;         // of one seam that are tried
constexpr double kShorter = 0.97;     // of the seam that a line may be long
constexpr std::size_t kAtOnce = 4;    // that are looked at side by side, whatever the number of threads
constexpr double kLeastGain = 0.02;   // of the seam: what has to be won when the cut has been smoothed
constexpr double kLeastShare = 0.15;  // of the smaller patch that stays on either side

// Those that are not among the others.
std::vector<int> without(std::vector<int> edges, std::vector<int> others) {
  std::sort(edges.begin(), edges.end());
  std::sort(others.begin(), others.end());
  std::vector<int> left;
  std::set_difference(edges.begin(), edges.end(), others.begin(), others.end(), std::back_inserter(left));
  return left;
}

}  // namespace

// All that lies between two patches, with the loose ends that it would leave; empty where a part of it may
// not go.
std::vector<int> LayoutSearch::seam_between(int patch, int other) const {
  std::vector<int> edges;
  for (const ArchUse& use : layout_.patches[patch].boundary) {
    const Arch& arch = layout_.arches[use.arch];
    if (arch.left == arch.right || (arch.left != other && arch.right != other)) continue;
    if (!may_go(arch)) return {};
    edges.insert(edges.end(), arch.edges.begin(), arch.edges.end());
  }
  return with_loose_ends(std::move(edges));
}

// Shorter seams of two neighbours, straight in the chart of both together, the shortest first.
std::vector<LayoutSearch::Sharing> LayoutSearch::straight_ways(int patch, int other) {
  std::vector<Sharing> ways;
  const std::vector<int> seam = seam_between(patch, other), faces = faces_of({patch, other});
  if (seam.empty()) return ways;
  PathNetwork without_seam = network_.network();
  double length = 0;
  for (int e : seam) without_seam.edge_path[e] = PathNetwork::kFree, length += surface_.mesh.edge_length(e);
  const PatchLayout both = extract_region(surface_.mesh, without_seam, surface_.versions, rules_, faces);
  if (both.patches.size() != 1 || both.patches[0].defect != TopologyDefect::kNone) return ways;
  const double least = kLeastShare * std::min(layout_.patches[patch].area, layout_.patches[other].area);
  for (const StraightCut& cut :
       straight_cuts(surface_.mesh, both, 0, *evaluator_->chart(both, both.patches[0]), kShorter * length,
                     least, kMostWays, surface_.keep_out.empty() ? nullptr : &surface_.keep_out))
    ways.push_back({without(seam, cut.edges), without(cut.edges, seam), faces, 2});
  return ways;
}

// The shortest that is viable, and shorter still when it has been smoothed.
bool LayoutSearch::shorten_seam(int patch, int other) {
  const std::vector<Sharing> ways = straight_ways(patch, other);
  for (std::size_t first = 0; first < ways.size(); first += kAtOnce) {
    const std::size_t n = std::min(kAtOnce, ways.size() - first);
    std::array<char, kAtOnce> viable{};
    std::vector<std::vector<int>> hopeless(n);
    parallel_for(context_, static_cast<int>(n), [&](int i) {
      const Sharing& way = ways[first + i];
      EditableNetwork trial = network_;
      apply(way, trial);
      const auto fit = viable_region(trial.network(), way.faces, &hopeless[i]);
      viable[i] = fit && fit->patches <= way.patches;
    });
    remember_hopeless(std::move(hopeless));
    for (std::size_t i = 0; i < n; ++i)
      if (viable[i] && try_shorter(ways[first + i])) return true;
  }
  return false;
}

bool LayoutSearch::try_shorter(const Sharing& way) {
  State as_it_was = state();
  double seam = 0;
  for (int e : way.gone) seam += surface_.mesh.edge_length(e);
  const double before = cut_length();
  if (!try_sharing(way)) return false;
  if (cut_length() < before - kLeastGain * seam) return true;
  take(std::move(as_it_was));
  return false;
}

int LayoutSearch::shorten_seams() {
  know_lost();
  std::vector<std::tuple<double, int, int>> pairs;  // a face of each
  const auto face_of = [&](int p) { return layout_.patches[p].faces.front(); };
  for (int p = 0; p < static_cast<int>(layout().patches.size()); ++p)
    for (const Taker& t : takers_of(p))
      if (t.patch > p) pairs.emplace_back(-t.seam, face_of(p), face_of(t.patch));
  std::sort(pairs.begin(), pairs.end());
  int done = 0;
  for (const auto& [seam, face, beyond] : pairs) {
    context_.report(Stage::kRemove, 1);
    const int patch = layout().face_patch[face], other = layout_.face_patch[beyond];
    if (patch == other) continue;
    // What lies beside them matters too, but hardly ever.
    if (!unshortened_.insert(layout_.patches[patch].key + layout_.patches[other].key).second) continue;
    done += shorten_seam(patch, other);
  }
  return done;
}

}  // namespace sheetform
