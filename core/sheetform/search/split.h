// Cuts through one patch: when no field-aligned path will do, a ladder of fallbacks that always ends, and
// straight lines.
#pragma once
#include <vector>

#include "sheetform/search/evaluator.h"

namespace sheetform {

/// Edges of a cut through the patch, chosen by what is wrong with it; empty only for a patch of one triangle:
/// - not a disk: the shortest cut that is not contractible (tree-cotree), or a loop on a closed surface;
/// - touches itself, glued to itself when that is not allowed: between the two places;
/// - too many sides: so that the corners are shared evenly;
/// - folded: between the two points of its outline that are farthest apart;
/// - no rulings, overlapping: across the longer axis of its chart;
/// - error: across its rulings at the worst place, so that they get shorter (method.md 13.4).
/// keep_out: by edge, where a cut counts as much longer than it is; null = nowhere. least_share: of the
/// patch's area that either side should have: where the cut of a disk leaves less, others are tried, and the
/// one that leaves most on its smaller side is taken.
std::vector<int> split_patch(const SurfaceMesh& mesh, const PatchLayout& layout, int patch,
                             const PatchEvaluation& evaluation, const std::vector<char>* keep_out = nullptr,
                             double least_share = 0);

/// A cut that is straight in the chart, as mesh edges; length: of the line in the chart.
struct StraightCut {
  std::vector<int> edges;
  double length;
};

/// Cuts through a patch from outline to outline that are shorter than `most` and leave at least this area on
/// either side: the shortest first, each well apart from those before it, `count` at most. The patch must be
/// a disk. Cost: O(n^2) for n vertices of the outline (every few of them where there are many), and a
/// shortest-path search each.
std::vector<StraightCut> straight_cuts(const SurfaceMesh& mesh, const PatchLayout& layout, int patch,
                                       const PatchChart& chart, double most, double least_area, int count,
                                       const std::vector<char>* keep_out = nullptr);

}  // namespace sheetform
