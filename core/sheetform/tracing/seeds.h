// Well spread vertices: farthest-point sampling by distance along mesh edges.
#pragma once
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// Up to `count` vertices among those with candidate[v], each farthest from all before it and from the
/// vertices with start[v]. Ends early when no candidate is left at a positive distance. Ties go to the lower
/// id. About O(n log n log count).
std::vector<int> farthest_point_samples(const SurfaceMesh& mesh, const std::vector<char>& candidate,
                                        const std::vector<char>& start, int count);

}  // namespace sheetform
