// How far a flat triangle is at most from a surface of which many faces lie over it.
#pragma once
#include <array>
#include <vector>

#include "sheetform/base/run_context.h"
#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// Bounds by height. Where faces that hang together cover a triangle, seen along its normal, each of its
/// points has one of theirs straight above or below it: no point is farther from the surface than the highest
/// of these faces over the triangle. So one step settles what convexity alone (OneWayDistance) would have to
/// split until each piece has a single face over it.
class HeightBound {
 public:
  /// points and faces must outlive it. diagonal: of their bounding box. O(faces). Throws as
  /// context.checkpoint() does, and nothing else.
  HeightBound(const std::vector<Vector3>& points, const std::vector<std::array<int, 3>>& faces,
              double diagonal, const RunContext& context = {});

  /// No point of the triangle is farther from the surface. Infinity where that is not known to be at most
  /// `limit`: where the surface ends over the triangle, has as many faces over it turned up as down, is too
  /// high, or has too many faces there for this to pay. near: faces to start from. O(faces over the
  /// triangle).
  double operator()(const std::array<Vector3, 3>& triangle, const std::array<int, 3>& near,
                    double limit) const;

 private:
  double area_of(int face) const;

  const std::vector<Vector3>& points_;
  const std::vector<std::array<int, 3>>& faces_;
  double rounding_;  // lengths below it mean nothing
  // By face, and side from corner k to k + 1: the one other face there, if it is turned alike.
  std::vector<std::array<int, 3>> beside_;
};

}  // namespace sheetform
