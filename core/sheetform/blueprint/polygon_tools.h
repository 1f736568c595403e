// Polygons in millimetres: unions and offsets (Clipper), the roomiest place, boxes for texts.
#pragma once
#include <array>
#include <vector>

#include "sheetform/blueprint/page_layout.h"

namespace sheetform {

using Polygons = std::vector<Polygon>;  ///< outer contours counter-clockwise, holes clockwise

struct Bounds {
  Vector2 low = Vector2::Zero(), high = Vector2::Zero();
  Vector2 size() const { return high - low; }
};
Bounds bounds_of(const Polygon& polygon);  ///< of a polygon with a point at least

/// Boolean operations on a grid of 1e-5 mm. Non-zero winding.
Polygons unite(const Polygons& polygons);
Polygons subtract(const Polygons& from, const Polygons& what);
Polygons intersect(const Polygons& a, const Polygons& b);
/// Moved outward by `distance` (inward if negative) with mitred corners, up to three times the distance, or
/// rounded.
enum class Corner { kMitred, kRound };
Polygons offset(const Polygons& polygons, double distance, Corner corner);
double area_of(const Polygons& polygons);

/// The centre of the largest circle inside, up to `precision` (Garcia-Castellanos and Lombardo 2007; the cell
/// search is Agafonkin's). Cost O(n) for each of some hundred cells.
struct Pole {
  Vector2 center = Vector2::Zero();
  double radius = 0;
};
Pole pole_of_inaccessibility(const Polygon& polygon, double precision);

/// A rectangle anywhere in the plane.
struct TurnedBox {
  Vector2 center = Vector2::Zero();
  Vector2 axis = Vector2::UnitX();  ///< unit, along the width
  double half_width = 0, half_height = 0;
  TurnedBox grown(double by) const { return {center, axis, half_width + by, half_height + by}; }
  Vector2 up() const { return {-axis.y(), axis.x()}; }
  Polygon corners() const;
};
bool overlap(const TurnedBox& a, const TurnedBox& b);
/// The share of the segment from a to b that lies in the box, as parameters from 0 to 1; first > second:
/// none.
std::array<double, 2> stretch_in(const TurnedBox& box, const Vector2& a, const Vector2& b);
/// The segment has a point in the box.
bool meets(const TurnedBox& box, const Vector2& a, const Vector2& b);

/// Answers whether boxes lie inside a polygon: outline edges in a grid of cells.
class Inside {
 public:
  explicit Inside(const Polygon& polygon);
  /// Wholly inside and its edge nowhere touches the outline.
  bool holds(const TurnedBox& box) const;
  bool holds(const Vector2& point) const;
  /// Whether the segment meets the outline.
  bool crossed(const Vector2& a, const Vector2& b) const;

 private:
  template <class Visit>
  bool any_edge(const Bounds& where, const Visit& visit) const;
  const Polygon& polygon_;
  Bounds bounds_;
  double cell_ = 1;
  int columns_ = 1, rows_ = 1;
  std::vector<std::vector<int>> cells_;
};

}  // namespace sheetform
