// The part of the search that cuts two neighbours anew, with a shorter seam between them.
#include <algorithm>
#include <iterator>
#include <tuple>
#include <utility>

#include "sheetform/search/layout_search.h"
#include "sheetform/search/split.h"

namespace sheetform {
namespace {

constexpr int kMostWays = 16;         // of one seam that are tried
constexpr double kShorter = 0.97;     // of the seam that a line may be long
constexpr double kLeastGain = 0.02;   // of the seam: what has to be won when the cut has been smoothed
constexpr int kAhead = 3;             // pairs for each thread
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
std::vector<LayoutSearch::Sharing> LayoutSearch::straight_ways(int patch, int other) const {
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
bool LayoutSearch::try_shortest(const std::vector<Sharing>& ways) {
  return try_in_order(
      ways, [&](const Sharing& way, std::vector<int>& hopeless) { return is_viable(way, 0, hopeless); },
      [&](const Sharing& way) { return try_shorter(way); });
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

std::vector<LayoutSearch::Pair> LayoutSearch::pairs_by_seam() {
  std::vector<std::tuple<double, int, int>> order;
  for (int p = 0; p < static_cast<int>(layout().patches.size()); ++p)
    for (const Taker& t : takers_of(p))
      if (t.patch > p) order.emplace_back(-t.seam, p, t.patch);
  std::sort(order.begin(), order.end());
  std::vector<Pair> pairs;
  const auto face_of = [&](int p) { return layout_.patches[p].faces.front(); };
  for (const auto& [seam, p, q] : order) pairs.push_back({face_of(p), face_of(q), 0, {}});
  return pairs;
}

std::uint64_t LayoutSearch::key_of(const Pair& pair) const {
  const int p = layout_.face_patch[pair.face], q = layout_.face_patch[pair.beyond];
  return p == q ? 0 : layout_.patches[p].key + layout_.patches[q].key;
}

// Ways are looked for ahead, some pairs for each thread that is there; where another seam has changed until
// then, again.
int LayoutSearch::shorten_seams() {
  know_lost();
  std::vector<Pair> pairs = pairs_by_seam();
  int done = 0;
  std::size_t looked_at = 0;
  const auto look_at = [&](Pair& pair) {
    pair.key = key_of(pair);
    if (pair.key != 0 && unshortened_.count(pair.key) == 0)
      pair.ways = straight_ways(layout_.face_patch[pair.face], layout_.face_patch[pair.beyond]);
  };
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    context_.report(Stage::kRemove, 1);
    layout();
    if (i == looked_at) {
      const int threads = threads_at_hand(context_), ahead = threads > 1 ? kAhead * threads : 1;
      const std::size_t n = std::min<std::size_t>(ahead, pairs.size() - i);
      parallel_for(context_, static_cast<int>(n), [&](int k) { look_at(pairs[i + k]); });
      looked_at += n;
    }
    Pair& pair = pairs[i];
    if (pair.key != key_of(pair)) pair.ways.clear(), look_at(pair);
    // What lies beside them matters too, but hardly ever.
    if (pair.key != 0 && unshortened_.insert(pair.key).second) done += try_shortest(pair.ways);
    pair.ways.clear();
  }
  return done;
}

}  // namespace sheetform
