// Points of the input that the working mesh misses, for patches to be measured at.
#pragma once
#include <vector>

#include "sheetform/search/component.h"

namespace sheetform {

/// Vertices of the input (in diagonals) that lie farther from the working mesh, which is `surface`'s at rest,
/// than a small share of the tolerance; ascending by face. None where the input was not remeshed. tree: of
/// `input.reference`. Throws as the context does. Cost: a closest-point query for most vertices of the input.
std::vector<DetailPoint> detail_points(const ComponentInput& input, const ClosestPointTree& tree,
                                       const SearchSurface& surface, double e_max, RunContext& context);

}  // namespace sheetform
