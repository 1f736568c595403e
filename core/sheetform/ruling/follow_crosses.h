// Rulings that follow a cross field given by the user.
#pragma once
#include <vector>

#include "sheetform/ruling/rulings.h"

namespace sheetform {

/// Where crosses are given (one arm per vertex, zero = free), rulings follow an arm of them instead of the
/// direction of least curvature: the arm next to it, or the given one where the surface does not say.
/// O(faces).
void follow_crosses(const SurfaceMesh& mesh, const std::vector<Vector3>& crosses, SurfaceGuide& guide);

}  // namespace sheetform
