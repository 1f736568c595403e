// What the user draws on the surface to guide the cuts (design.md 1.8).
#pragma once
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// A polyline that becomes a seam.
struct SeamStroke {
  std::vector<Vector3> points;  ///< two at least, three of a closed one; near the surface
  bool closed = false;
};

/// The tube of this radius around a polyline (or a single point), taken on the surface: no seam is wanted
/// there.
struct BrushStroke {
  std::vector<Vector3> points;  ///< one at least; near the surface
  double radius = 0;
};

/// Lengths in units of the mesh that they were drawn on.
struct UserGuides {
  std::vector<SeamStroke> seams;
  std::vector<BrushStroke> keep_out;
  bool empty() const { return seams.empty() && keep_out.empty(); }
};

}  // namespace sheetform
