// Borders that run from triangle to triangle, as trimmed scans have them, and the same borders drawn
// smoothly.
#pragma once
#include <optional>

#include "sheetform/base/run_context.h"
#include "sheetform/mesh/closest_point.h"
#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// Longest shift of a border vertex, in tolerances. Teeth of twice that are gone.
constexpr double kMostBorderShift = 0.5;

/// The mesh with its ragged borders smoothed, none of their vertices moved by more than `most`; nothing where
/// no border is ragged. Ragged is where the border turns by 25 degrees and more at each of some eleven
/// vertices, to and fro: not a corner, not a small round hole, not a scallop of several edges. Vertices near
/// by follow, and stay on the surface (`tree`: of the mesh), but triangles can come out thin: made for
/// remeshing. No triangle turns over, the topology stays. O(n); deterministic.
///
/// Every tooth would be a corner of some part, which has six at most: a kitten cut in two, 18 teeth or so in
/// a row, took 33 parts at 2 % instead of 4 and 31 instead of 1 at 5 %, where the teeth are 1.5 % long.
std::optional<SurfaceMesh> without_ragged_borders(const SurfaceMesh& mesh, const ClosestPointTree& tree,
                                                  double most, const RunContext& context = {});

}  // namespace sheetform
