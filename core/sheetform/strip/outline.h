// Closed polygons in the plane: contact with itself, area, containment.
#pragma once
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// Signed: positive when counter-clockwise. The polygon is closed, its first point not repeated.
double signed_area(const std::vector<Vector2>& polygon);
/// Even-odd rule; on the outline itself either answer.
bool contains(const std::vector<Vector2>& polygon, const Vector2& point);
double point_segment_distance(const Vector2& point, const Vector2& a, const Vector2& b);
/// 0 where they cross.
double segment_distance(const Vector2& a, const Vector2& b, const Vector2& c, const Vector2& d);

struct Contact {
  int i = -1, j = -1;  ///< edges (from point i to i + 1); -1: none
  double distance = 0;
};
/// The two closest edges that are no neighbours and not more than `tolerance` apart. A crossing that rounding
/// hides leaves an end within rounding of the other edge, so a tolerance well above rounding misses none.
/// Cost O(n log n + n w), w = edges over one x.
Contact self_contact(const std::vector<Vector2>& polygon, double tolerance);

}  // namespace sheetform
