// Splitting one patch in two when no field-aligned path will do: the ladder of fallbacks that always ends.
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
/// keep_out: by edge, where a cut counts as much longer than it is; null = nowhere.
std::vector<int> split_patch(const SurfaceMesh& mesh, const PatchLayout& layout, int patch,
                             const PatchEvaluation& evaluation, const std::vector<char>* keep_out = nullptr);

}  // namespace sheetform
