// The part of the search that cuts neighbours anew, straight in the chart of all of them together: two with a
// shorter seam between them, three so that two are left.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>
#include <tuple>
#include <utility>

#include "sheetform/search/layout_search.h"
#include "sheetform/search/split.h"

namespace sheetform {
namespace {

constexpr int kMostWays = 16;         // of one group that are tried
constexpr double kShorter = 0.97;     // of the seam that a line may be long
constexpr double kLeastGain = 0.02;   // of the seam: what has to be won when the cut has been smoothed
constexpr int kAhead = 3;             // groups for each thread
constexpr double kLeastShare = 0.15;  // of the smaller patch that stays on either side

// Of three patches that either of the two has at least: with 0.15 and 0.33 33 meshes take 2 to 4 % more
// parts.
constexpr double kLeastOfThree = 0.25;
// Root of the area of three patches times their integral of |Gaussian curvature|, in tolerances: beyond this
// one in 150 becomes two, below it one in 28.
constexpr double kMostCurved = 100;
constexpr int kCornersOfCut = 2;  // that both parts have more together, at least

// Those that are not among the others.
std::vector<int> without(std::vector<int> edges, std::vector<int> others) {
  std::sort(edges.begin(), edges.end());
  std::sort(others.begin(), others.end());
  std::vector<int> left;
  std::set_difference(edges.begin(), edges.end(), others.begin(), others.end(), std::back_inserter(left));
  return left;
}

}  // namespace

// All that lies between these patches, with the loose ends that it would leave; empty where a part of it may
// not go.
std::vector<int> LayoutSearch::seams_between(const std::vector<int>& patches) const {
  const auto has = [&](int p) { return std::find(patches.begin(), patches.end(), p) != patches.end(); };
  std::set<int> edges;
  for (int p : patches)
    for (const ArchUse& use : layout_.patches[p].boundary) {
      const Arch& arch = layout_.arches[use.arch];
      if (arch.left == arch.right || !has(arch.left) || !has(arch.right)) continue;
      if (!may_go(arch)) return {};
      edges.insert(arch.edges.begin(), arch.edges.end());
    }
  return with_loose_ends({edges.begin(), edges.end()});
}

// Seams of two patches instead of all that these have between them, straight in the chart of them together,
// the shortest first. longest: as a share of what goes; least_area: on either side.
std::vector<LayoutSearch::Sharing> LayoutSearch::straight_ways(const std::vector<int>& patches,
                                                               const std::vector<int>& seams, double longest,
                                                               double least_area) const {
  std::vector<Sharing> ways;
  if (seams.empty()) return ways;
  const std::vector<int> faces = faces_of(patches);
  PathNetwork without_seams = network_.network();
  double length = 0;
  for (int e : seams) without_seams.edge_path[e] = PathNetwork::kFree, length += surface_.mesh.edge_length(e);
  const PatchLayout all = extract_region(surface_.mesh, without_seams, surface_.versions, rules_, faces);
  if (all.patches.size() != 1 || all.patches[0].defect != TopologyDefect::kNone) return ways;
  for (const StraightCut& cut :
       straight_cuts(surface_.mesh, all, 0, *evaluator_->chart(all, all.patches[0]), longest * length,
                     least_area, kMostWays, surface_.keep_out.empty() ? nullptr : &surface_.keep_out))
    ways.push_back(
        {without(seams, cut.edges), without(cut.edges, seams), faces, static_cast<int>(patches.size())});
  return ways;
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

std::vector<LayoutSearch::Group> LayoutSearch::pairs_by_seam() {
  std::vector<std::tuple<double, int, int>> order;
  for (int p = 0; p < static_cast<int>(layout().patches.size()); ++p)
    for (const Taker& t : takers_of(p))
      if (t.patch > p) order.emplace_back(-t.seam, p, t.patch);
  std::sort(order.begin(), order.end());
  std::vector<Group> pairs;
  for (const auto& [seam, p, q] : order) pairs.push_back(group_of({p, q}));
  return pairs;
}

// Those with the least curvature on the least area first.
std::vector<LayoutSearch::Group> LayoutSearch::threes_by_curvature() {
  std::vector<double> gauss;
  for (const Patch& p : layout().patches) gauss.push_back(gauss_of(p));
  const auto curved = [&](const std::array<int, 3>& three) {
    double area = 0, sum = 0;
    for (int p : three) area += layout_.patches[p].area, sum += gauss[p];
    return std::sqrt(area * sum) / params_.evaluation.e_max;
  };
  std::set<std::pair<double, std::array<int, 3>>> order;
  for (int p = 0; p < static_cast<int>(gauss.size()); ++p) {
    const std::vector<Taker> takers = takers_of(p);
    for (std::size_t i = 0; i < takers.size(); ++i)
      for (std::size_t j = i + 1; j < takers.size(); ++j) {
        std::array<int, 3> three{p, takers[i].patch, takers[j].patch};
        std::sort(three.begin(), three.end());
        if (const double k = curved(three); k < kMostCurved) order.emplace(k, three);
      }
  }
  std::vector<Group> threes;
  for (const auto& [k, three] : order) threes.push_back(group_of({three.begin(), three.end()}));
  return threes;
}

LayoutSearch::Group LayoutSearch::group_of(const std::vector<int>& patches) const {
  Group group;
  for (int p : patches) group.faces.push_back(layout_.patches[p].faces.front());
  return group;
}

// Empty where two have become one.
std::vector<int> LayoutSearch::patches_of(const Group& group) const {
  std::vector<int> patches;
  for (int f : group.faces) patches.push_back(layout_.face_patch[f]);
  std::sort(patches.begin(), patches.end());
  if (std::adjacent_find(patches.begin(), patches.end()) != patches.end()) patches.clear();
  return patches;
}

std::uint64_t LayoutSearch::key_of(const Group& group) const {
  std::uint64_t key = 0;
  for (int p : patches_of(group)) key += layout_.patches[p].key;
  return key;
}

// Ways are looked for ahead, of some groups for each thread that is there; where another cut has changed one
// until then, again.
int LayoutSearch::recut(std::vector<Group> groups, const WaysOf& ways_of,
                        const std::function<bool(const std::vector<Sharing>&)>& goes) {
  int done = 0;
  std::size_t looked_at = 0;
  const auto look_at = [&](Group& group) {
    group.key = key_of(group);
    if (group.key != 0 && not_recut_.count(group.key) == 0) group.ways = ways_of(patches_of(group));
  };
  for (std::size_t i = 0; i < groups.size(); ++i) {
    context_.report(Stage::kRemove, 1);
    layout();
    if (i == looked_at) {
      const int threads = threads_at_hand(context_), ahead = threads > 1 ? kAhead * threads : 1;
      const std::size_t n = std::min<std::size_t>(ahead, groups.size() - i);
      parallel_for(context_, static_cast<int>(n), [&](int k) { look_at(groups[i + k]); });
      looked_at += n;
    }
    Group& group = groups[i];
    if (group.key != key_of(group)) group.ways.clear(), look_at(group);
    // What lies beside them matters too, but hardly ever.
    if (group.key != 0 && not_recut_.insert(group.key).second) done += goes(group.ways);
    group.ways.clear();
  }
  return done;
}

// The shortest that is viable, and shorter still when it has been smoothed.
int LayoutSearch::shorten_seams() {
  know_lost();
  return recut(
      pairs_by_seam(),
      [&](const std::vector<int>& pair) {
        const double smaller = std::min(layout_.patches[pair[0]].area, layout_.patches[pair[1]].area);
        return straight_ways(pair, seams_between(pair), kShorter, kLeastShare * smaller);
      },
      [&](const std::vector<Sharing>& ways) {
        return try_in_order(
            ways, [&](const Sharing& way, std::vector<int>& hopeless) { return is_viable(way, 0, hopeless); },
            [&](const Sharing& way) { return try_shorter(way); });
      });
}

int LayoutSearch::make_threes_two() {
  know_lost();
  int done = 0;
  for (int last = 1; last > 0; done += last)
    last = recut(
        threes_by_curvature(),
        [&](const std::vector<int>& three) {
          const std::vector<int> seams = seams_between(three);
          if (corners_without(three, seams).corners > 2 * params_.evaluation.max_sides - kCornersOfCut)
            return std::vector<Sharing>();
          double area = 0;
          for (int p : three) area += layout_.patches[p].area;
          return straight_ways(three, seams, 1, kLeastOfThree * area);
        },
        [&](const std::vector<Sharing>& ways) { return try_fewer(ways); });
  return done;
}

}  // namespace sheetform
