#include "sheetform/search/finish.h"

#include <algorithm>
#include <set>
#include <utility>

#include "sheetform/strip/unfold.h"

namespace sheetform {
namespace {

using Pair = std::pair<int, int>;
Pair ordered(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

// Chords must be edges of their own: not an arch edge, not the chord of another patch (or of the other side
// of a seam), or three faces would meet there.
class ChordBook {
 public:
  explicit ChordBook(const LayoutEvaluation& e) {
    for (const auto& points : e.arch_unknowns)
      for (std::size_t i = 0; i + 1 < points.size(); ++i) used_.insert(ordered(points[i], points[i + 1]));
  }
  std::set<Pair> conflicts(const PatchEvaluation& patch, const std::vector<int>& unknowns) const {
    std::set<Pair> bad, own;
    for (const auto& c : patch.rulings.chords) {
      const Pair pair = ordered(unknowns[c.a], unknowns[c.b]);
      if (pair.first == pair.second || used_.count(pair) || !own.insert(pair).second) bad.insert(pair);
    }
    return bad;
  }
  void take(const PatchEvaluation& patch, const std::vector<int>& unknowns) {
    for (const auto& c : patch.rulings.chords) used_.insert(ordered(unknowns[c.a], unknowns[c.b]));
  }

 private:
  std::set<Pair> used_;
};

bool has_strips(const PatchEvaluation& e) { return !e.rulings.triangles.empty() && e.rulings.found; }

// Makes the chords of all patches distinct; true when a patch changed.
bool make_distinct(LayoutEvaluator& evaluator, const PatchLayout& layout, LayoutEvaluation& e,
                   std::vector<char>& hopeless) {
  ChordBook book(e);
  bool changed = false;
  for (std::size_t p = 0; p < e.patches.size(); ++p) {
    std::set<Pair> forbidden;
    for (int attempt = 0; attempt < 6 && has_strips(*e.patches[p]); ++attempt) {
      const std::set<Pair> bad = book.conflicts(*e.patches[p], e.unknowns[p]);
      if (bad.empty()) break;
      forbidden.insert(bad.begin(), bad.end());
      const auto& ids = e.unknowns[p];
      e.patches[p] = evaluator.patch_avoiding(layout, static_cast<int>(p), [&](int a, int b) {
        return ids[a] == ids[b] || forbidden.count(ordered(ids[a], ids[b])) > 0;
      });
      changed = true;
    }
    if (!has_strips(*e.patches[p]) || !book.conflicts(*e.patches[p], e.unknowns[p]).empty()) {
      hopeless[p] = 1;
    } else {
      book.take(*e.patches[p], e.unknowns[p]);
    }
  }
  return changed;
}

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

FinishedLayout finish_layout(const SearchSurface& surface, const PathNetwork& network,
                             const PatchLayout& layout, const EvaluationParams& evaluation, int rounds,
                             RunContext& context) {
  LayoutEvaluator evaluator(surface, evaluation, context);
  LayoutEvaluation e = evaluator.layout(layout, rounds);
  std::vector<char> hopeless(layout.patches.size(), 0);
  if (make_distinct(evaluator, layout, e, hopeless))
    e = evaluator.solve(layout, std::move(e.patches), rounds);
  FinishedLayout out;
  out.source.points = e.position;
  out.patch_error = e.patch_error;
  for (int p = 0; p < static_cast<int>(layout.patches.size()); ++p) {
    out.source.patches.push_back(strip_patch(layout, p, *e.patches[p], e.unknowns[p]));
    PatchVerdict verdict = PatchVerdict::kViable;
    if (hopeless[p]) {
      verdict = e.patches[p]->viable() ? PatchVerdict::kNoRulings : e.patches[p]->verdict;
    } else if (!flat_layout_valid(out.source, out.source.patches.back())) {
      verdict = PatchVerdict::kOverlap;
    }
    if (verdict == PatchVerdict::kViable) continue;
    out.failing.push_back(p);
    out.why.push_back(verdict);
  }
  for (std::size_t a = 0; a < layout.arches.size(); ++a) {
    const Arch& arch = layout.arches[a];
    int left = arch.left, right = arch.right;
    if (left < 0) std::swap(left, right);
    out.source.arches.push_back(
        {e.arch_unknowns[a], {left, right}, network.kinds[arch.path] == PathKind::kCrease});
  }
  return out;
}

}  // namespace sheetform
