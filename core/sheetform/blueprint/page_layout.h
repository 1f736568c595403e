// Parts side by side on one page: the flat layout that ruled.obj and layout.svg share.
#pragma once
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

using Polygon = std::vector<Vector2>;  ///< closed, first point not repeated

/// A motion of the plane that keeps orientation: parts are turned and shifted, never mirrored.
struct Placement {
  double cos = 1, sin = 0;
  Vector2 shift = Vector2::Zero();
  Vector2 operator()(const Vector2& p) const {
    return Vector2(cos * p.x() - sin * p.y(), sin * p.x() + cos * p.y()) + shift;
  }
};

struct PageLayout {
  std::vector<Placement> placements;  ///< one a part, in the order given
  double width = 0, height = 0;       ///< of the page, margins included; origin at its lower left
};

/// Turns each part so that the smallest rectangle around it lies flat, long side along x, and packs the
/// rectangles on shelves of a page about as wide as high, `gap` apart and `gap` from its edge. Units as
/// given, gap > 0. Cost O(n log n) plus, a part, hull edges times hull points.
PageLayout arrange_on_one_page(const std::vector<Polygon>& outlines, double gap);

/// The turn that lays the rectangle of least area around `points` flat, long side along x; no shift.
Placement flat_turn(const Polygon& points);

}  // namespace sheetform
