// Parts that are plane but for a trifle become plane.
#pragma once
#include <array>
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// Puts the points of every patch that lie within `slack` of a plane on it; patches share points, so a few
/// rounds are made. `patches`: the points of each; `on_plane`: points that stay on x = 0, may be empty.
/// A morph moves every point a little, and flat faces would get folds of some tenths of a degree.
/// `triangles`: those of the strips, by point; a sliver that lies within the slack of two planes would end as
/// the line where they meet, so points stay where they are if a triangle at them would turn over or lose
/// nearly all of its height. O(points + triangles) for each round.
void flatten(const std::vector<std::vector<int>>& patches, const std::vector<std::array<int, 3>>& triangles,
             const std::vector<char>& on_plane, double slack, std::vector<Vector3>& points);

}  // namespace sheetform
