// Unfolding a strip into the plane, triangle by triangle: lengths are kept to rounding (method.md 10.3).
#pragma once
#include <array>
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// Flat places of `points` under an isometry of each triangle. The triangles share edges as a tree, over
/// points 0..n-1 that are each used by at least one triangle. Orientation is kept: counter-clockwise stays
/// so. O(triangles).
std::vector<Vector2> unfold(const std::vector<Vector3>& points,
                            const std::vector<std::array<int, 3>>& triangles);

/// True when the closed polygon does not touch or cross itself: edges that are no neighbours keep `gap`
/// apart, and neighbours do not fold back onto each other. O(n^2) with box tests.
bool simple_outline(const std::vector<Vector2>& outline, double gap);

}  // namespace sheetform
