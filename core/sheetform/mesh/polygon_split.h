// Splits one polygon in space into triangles: a fan where it is convex, ears where it is not.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// Appends sides - 2 triangles (indices into the polygon, its orientation kept) to `triangles`. A convex
/// polygon becomes the fan of its first corner in O(sides); another one is cut ear by ear, as a rule in
/// O(sides^2) steps, which are taken from `budget`; when that is used up the rest is cut as it comes, in
/// O(sides).
void split_polygon(const std::vector<Vector3>& polygon, std::uint64_t& budget,
                   std::vector<std::array<int, 3>>& triangles);

}  // namespace sheetform
