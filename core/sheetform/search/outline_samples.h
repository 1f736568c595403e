// Where the outlines of patches get their points.
#pragma once
#include "sheetform/search/evaluator.h"

namespace sheetform {

/// Samples along an arch, as coordinates edge index + fraction (as sample_arch gives them): every
/// params.spacing where the rulings of a patch beside it end, several times fewer where they run along it on
/// both sides or the surface is flat, since every point there takes a ruling across; never so few that the
/// polyline leaves the arch by more than a tenth of e_max. At least two segments; one for a straight arch on
/// the plane of symmetry. Never farther apart than params.bounds allows; with a lower bound, evenly, and so
/// where params.plain_arches say.
std::vector<double> outline_samples(const SearchSurface& surface, const Arch& arch,
                                    const EvaluationParams& params);

}  // namespace sheetform
