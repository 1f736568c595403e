#include "sheetform/search/finish.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

#include "sheetform/search/chord_book.h"
#include "sheetform/search/flatten.h"
#include "sheetform/strip/unfold.h"

namespace sheetform {
namespace {

bool has_strips(const PatchEvaluation& e) { return !e.rulings.triangles.empty() && e.rulings.found; }

// Fairer rulings follow the curvature and twist less, at the price of distance.
constexpr int kHighestLevel = 2;
// All triangles of a sliver are low, and one without area makes the others higher: it would break a promise.
// (In the search, where points are fewer, it costs parts: bunny at 0.5 % is 76 with a cost of 1 there,
// not 60.)
constexpr double kFlatCost = 0.1;
constexpr double kAlmostPlane = 0.05;  // of the tolerance
// A patch alone has to leave this share of the tolerance to its neighbours.
constexpr double kRoom = 0.9;
// Places that are too far weigh as much as so many samples, and more each time: at once these are gone
// sooner, and in more cases at all (33 meshes at 2 and 1 %: 277 and 494 parts instead of 281 and 510, in a
// quarter and a tenth less steps).
constexpr double kDrawn = 5, kDrawnMore = 1.3;

StripSource::Patch strip_patch(const PatchLayout& layout, int p, const PatchEvaluation& e,
                               const std::vector<int>& unknowns) {
  StripSource::Patch patch;
  patch.outline = unknowns;
  patch.triangles = e.rulings.triangles;
  for (const auto& c : e.rulings.chords) patch.rulings.push_back({c.a, c.b});
  patch.corners = e.corners;
  for (const ArchUse& use : layout.patches[p].boundary) patch.arches.push_back(use.arch);
  return patch;
}

bool flat_layout_valid(const StripSource& source, const StripSource::Patch& patch) {
  std::vector<Vector3> outline;
  for (int u : patch.outline) outline.push_back(source.points[u]);
  return simple_outline(unfold(outline, patch.triangles), 1e-7);
}

}  // namespace

FinalPass::FinalPass(const SearchSurface& surface, const PathNetwork& network, const PatchLayout& layout,
                     const EvaluationParams& evaluation, LayoutEvaluator& charts, RunContext& context)
    : surface_(surface),
      network_(network),
      layout_(layout),
      searched_(charts.patches(layout)),
      evaluator_(surface, evaluation, context, &charts, true),
      context_(context),
      level_(layout.patches.size(), 0),
      patches_(layout.patches.size()),
      hopeless_(layout.patches.size(), 0),
      pull_(kDrawn) {
  std::vector<int> order(patches_.size());
  std::iota(order.begin(), order.end(), 0);
  order = largest_first(layout, std::move(order));
  parallel_for(context_, static_cast<int>(order.size()),
               [&](int i) { choose_level(order[i], kHighestLevel); });
}

RulingParams FinalPass::ruling(int level) const {
  RulingParams ruling = evaluator_.params().ruling;
  ruling.flat_cost = kFlatCost;
  for (; level > 0; --level) ruling.align_weight *= 4, ruling.twist_weight *= 5;
  return ruling;
}

void FinalPass::choose_level(int p, int highest) {
  const double enough = kRoom * evaluator_.params().e_max;
  for (int level = highest; level >= 0; --level) {
    patches_[p] = evaluator_.patch_with(layout_, p, ruling(level), nullptr);
    level_[p] = level;
    if (patches_[p]->viable() && patches_[p]->error <= enough) return;
  }
}

bool FinalPass::plainer(const std::vector<int>& patches) {
  bool changed = false;
  for (int p : patches) {
    if (level_[p] == 0) continue;
    choose_level(p, level_[p] - 1);
    changed = true;
  }
  if (changed) distinct_ = false;
  return changed;
}

void FinalPass::make_distinct() {
  // Ids of unknowns and the chords of arches do not depend on the rulings.
  const LayoutEvaluation e = evaluator_.solve(layout_, patches_, 0);
  ChordBook book(e.on_plane);
  for (const auto& points : e.arch_unknowns) book.take_line(points);
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    hopeless_[p] = 0;
    std::set<ChordBook::Pair> forbidden;
    const auto& ids = e.unknowns[p];
    const std::function<bool(int, int)> avoid = [&](int a, int b) {
      return ids[a] == ids[b] || forbidden.count(ChordBook::ordered(ids[a], ids[b])) > 0;
    };
    for (int attempt = 0; attempt < 6 && has_strips(*patches_[p]); ++attempt) {
      const std::set<ChordBook::Pair> bad = book.conflicts(patches_[p]->rulings, ids);
      if (bad.empty()) break;
      forbidden.insert(bad.begin(), bad.end());
      patches_[p] = evaluator_.patch_with(layout_, static_cast<int>(p), ruling(level_[p]), &avoid);
    }
    if (!has_strips(*patches_[p]) || !book.conflicts(patches_[p]->rulings, ids).empty()) {
      hopeless_[p] = 1;
    } else {
      book.take(patches_[p]->rulings, ids);
    }
  }
  distinct_ = true;
}

void FinalPass::draw_to(const std::vector<FarPlace>& far) {
  double weight = 0;
  std::size_t count = 0;
  for (const Evaluation& e : patches_)
    for (const MorphSample& s : e->samples) weight += s.weight, count += s.weight > 0;
  for (const FarPlace& place : far) {
    MorphSample s;
    s.unknown = place.triangle;
    for (int k = 0; k < 3; ++k) s.coefficient[k] = place.barycentric[k];
    s.target = place.on_input;
    s.weight = pull_ * weight / static_cast<double>(std::max<std::size_t>(count, 1));
    s.slide = 0;
    drawn_.push_back(s);
  }
  pull_ *= kDrawnMore;
}

FinishedLayout FinalPass::solve(int rounds) {
  if (!distinct_) make_distinct();
  LayoutEvaluation e = evaluator_.solve(layout_, patches_, rounds, drawn_);
  std::vector<std::array<int, 3>> triangles;
  for (std::size_t p = 0; p < patches_.size(); ++p)
    for (const auto& t : patches_[p]->rulings.triangles)
      triangles.push_back({e.unknowns[p][t[0]], e.unknowns[p][t[1]], e.unknowns[p][t[2]]});
  flatten(e.unknowns, triangles, e.on_plane, kAlmostPlane * evaluator_.params().e_max, e.position);
  FinishedLayout out;
  out.source.points = e.position;
  const auto n = static_cast<int>(layout_.patches.size());
  out.source.patches.resize(n);
  std::vector<char> fails(n);
  parallel_for(context_, n, [&](int p) {
    StripSource::Patch& patch = out.source.patches[p];
    patch = strip_patch(layout_, p, *patches_[p], e.unknowns[p]);
    fails[p] = hopeless_[p] || !flat_layout_valid(out.source, patch);
  });
  for (int p = 0; p < n; ++p)
    if (fails[p]) out.failing.push_back(p);
  for (std::size_t a = 0; a < layout_.arches.size(); ++a) {
    const Arch& arch = layout_.arches[a];
    int left = arch.left, right = arch.right;
    if (left < 0) std::swap(left, right);
    out.source.arches.push_back({e.arch_unknowns[a],
                                 {left, right},
                                 network_.kinds[arch.path] == PathKind::kCrease,
                                 surface_.on_plane(arch),
                                 surface_.is_drawn(network_, arch)});
  }
  out.evaluation = std::move(e);
  return out;
}

}  // namespace sheetform
