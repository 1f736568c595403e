// The paper's own morph on a finished layout, for `morph=full`.
#pragma once
#include <vector>

#include "sheetform/search/evaluator.h"

namespace sheetform {

/// Places of the outline points by the paper's energy (morph/full_morph.h) with the paper's weights, per
/// unknown of `evaluation`. keep: per patch; patches with a true entry, and those without rulings, take no
/// part: their outlines stay where `evaluation` has them. params: those of the evaluation; the surface
/// must be the one that was evaluated, its curvature is used for E_flat. About 0.2 s for 10^4 vertices.
std::vector<Vector3> full_morph_places(const SearchSurface& surface, const PatchLayout& layout,
                                       const LayoutEvaluation& evaluation, const EvaluationParams& params,
                                       const std::vector<char>& keep, const RunContext& context);

}  // namespace sheetform
