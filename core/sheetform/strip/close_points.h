// Points of the strips that are in one place though they are not the same: surfaces that touch.
#pragma once
#include <array>
#include <vector>

#include "sheetform/strip/strip_mesh.h"

namespace sheetform {

/// Pairs of different ones of these points that are at most `distance` apart. O(n log n) where few are.
std::vector<std::array<int, 2>> close_points(const std::vector<Vector3>& points, const std::vector<int>& ids,
                                             double distance);

/// Moves points apart that are in one place, each into its own surface, by a millionth of the diagonal; the
/// patches around are unfolded anew. Where parts of the input touch in a point its copies lie a little apart,
/// and flat patches bring them together again: each plane is where it was, and so is the corner of three.
void part_close_points(StripMesh& strips, double bbox_diagonal);

}  // namespace sheetform
