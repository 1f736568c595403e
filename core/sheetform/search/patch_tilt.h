// The normal-deviation criterion on one patch (answers the paper's first limitation; method.md 13.12).
#pragma once
#include <vector>

#include "sheetform/search/evaluator.h"

namespace sheetform {

struct PatchTilt {
  double angle = 0;                 ///< degrees that 95 % of the patch's area do not exceed
  Vector2 place = Vector2::Zero();  ///< in the chart: where it is attained
};

/// Angles between the faces of the patch and the strips above them. position: per polygon point.
/// O(faces * strips).
PatchTilt patch_tilt(const SearchSurface& surface, const Patch& patch, const PatchChart& chart,
                     const PatchPolygon& polygon, const std::vector<std::array<int, 3>>& strips,
                     const std::vector<Vector3>& position);

/// Patches below this share of the surface are not split for their normals alone: on noise there would be no
/// end to it.
constexpr double kLeastTiltedShare = 0.01;

}  // namespace sheetform
