// The final pass: finer outline samples, chords that no two patches share, the last morph, the strips
// (paper 3.5).
#pragma once
#include <vector>

#include "sheetform/search/evaluator.h"
#include "sheetform/strip/assemble.h"

namespace sheetform {

struct FinishedLayout {
  StripSource source;               ///< in the units of the search surface
  std::vector<double> patch_error;  ///< per patch: largest distance at its samples
  std::vector<int> failing;         ///< patches that break a promise and have to be split
  std::vector<PatchVerdict> why;    ///< for each of `failing`
};

/// evaluation.spacing is that of the final mesh. Patches whose error exceeds e_max are not listed as failing
/// (the caller decides by the measured distance); those that overlap, or have no valid strips, are.
FinishedLayout finish_layout(const SearchSurface& surface, const PathNetwork& network,
                             const PatchLayout& layout, const EvaluationParams& evaluation, int rounds,
                             RunContext& context);

}  // namespace sheetform
