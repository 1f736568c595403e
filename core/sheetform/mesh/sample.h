// Points spread evenly over a mesh. Internal to mesh/.
#pragma once
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

struct SurfaceSample {
  Vector3 point, normal;  // unit normal of the face
};

/// `count` points, area-uniform and the same each time (a low-discrepancy sequence). None for a mesh without
/// area.
std::vector<SurfaceSample> sample_evenly(const SurfaceMesh& mesh, int count);

}  // namespace sheetform
