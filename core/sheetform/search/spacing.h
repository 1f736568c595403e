// How far apart the ends of neighbouring rulings may lie on the outlines of the patches.
#pragma once
#include <cmath>
#include <limits>

#include "sheetform/strip/strip_mesh.h"

namespace sheetform {

/// Bounds of the distance between neighbouring points of an outline, where rulings end. `least` is to be no
/// more than half of `most`, or there are lengths that cannot be divided.
struct SpacingBounds {
  double least = 0, most = std::numeric_limits<double>::infinity();
  bool any() const { return least > 0 || std::isfinite(most); }
  /// The spacing nearest to the wanted one that divides an arch of this length within the bounds; where none
  /// does, `most` wins.
  double divide(double length, double wanted) const;
};

/// How far outlines miss bounds, as factors: above 1 is a miss.
struct SpacingMiss {
  double over = 0;   ///< longest segment over `most`
  double under = 0;  ///< `least` over the shortest segment
  Vector3 over_place = Vector3::Zero(), under_place = Vector3::Zero();
  bool any() const { return worst() > 1; }
  double worst() const { return over > under ? over : under; }
};

/// The segments of all arches against the bounds. Arches that could not have fewer segments (two, six when
/// closed) may have short ones.
SpacingMiss spacing_miss(const StripMesh& strips, const SpacingBounds& bounds);

/// Bounds narrowed by what was missed with them: the morph moves outline points a little.
SpacingBounds tightened(const SpacingBounds& bounds, const SpacingMiss& miss);

}  // namespace sheetform
