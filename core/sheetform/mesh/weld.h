// Points that are the same place.
#pragma once
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// For each point a class id: equal coordinates (bit by bit, but -0 = 0), equal id. Ids count from 0 in the
/// order of first appearance. O(n log n).
std::vector<int> exact_classes(const std::vector<Vector3>& points);

/// The same for near points, made transitive: all nearer than `distance` to each other are one class, none is
/// joined to one farther than 8 times that. `distance` must not be below 1e-15 of the extent. O(n log n),
/// whatever the points.
std::vector<int> near_classes(const std::vector<Vector3>& points, double distance);

/// Keeps the first point of each class and renumbers the faces. Returns the number of points left.
int merge_classes(const std::vector<int>& classes, std::vector<Vector3>& points,
                  std::vector<std::array<int, 3>>& faces);

}  // namespace sheetform
