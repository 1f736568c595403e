// Polylines in space brought onto a surface.
#pragma once
#include <vector>

#include "sheetform/mesh/closest_point.h"

namespace sheetform {

/// A point of a curve on the surface.
struct CurvePoint {
  Vector3 point;
  int face;
};

/// The polyline's points and points between them, each the closest of the surface; consecutive ones are not
/// farther apart than `spacing` unless the surface jumps there. Between two points the middle is projected
/// again and again, so that sparse points give about the shortest way. A closed polyline ends where it
/// starts. O(length / spacing) queries.
std::vector<CurvePoint> curve_on_surface(const ClosestPointTree& tree, const std::vector<Vector3>& polyline,
                                         bool closed, double spacing);

/// The curve as triangles without area: for distances to it. A single point counts as a point.
ClosestPointTree curve_tree(const std::vector<CurvePoint>& curve);

}  // namespace sheetform
