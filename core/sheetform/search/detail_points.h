// Points of the surface that the working mesh misses, for patches to be measured at.
#pragma once
#include <vector>

#include "sheetform/search/component.h"

namespace sheetform {

/// Vertices of the input (in diagonals) that lie farther from the working mesh, which is `surface`'s at rest,
/// than a small share of the tolerance. None where the input was not remeshed. tree: of `input.reference`.
/// Throws as the context does. Cost: a closest-point query for most vertices of the input.
DetailPoints detail_points(const ComponentInput& input, const ClosestPointTree& tree,
                           const SearchSurface& surface, double e_max, RunContext& context);

/// The same after vertices (`moved`, one flag each) have slid along the surface: what lay on faces of theirs
/// goes to the face that is nearest now (see closest_from).
std::vector<DetailPoint> followed(const SurfaceMesh& mesh, const std::vector<char>& moved,
                                  std::vector<DetailPoint> details);

/// Faces that have other details in one than in the other; ascending.
std::vector<int> faces_that_differ(const std::vector<DetailPoint>& one,
                                   const std::vector<DetailPoint>& other);

}  // namespace sheetform
