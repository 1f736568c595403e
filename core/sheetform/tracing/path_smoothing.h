// Smooth cuts: moves the vertices of paths over the surface until the staircase of the mesh is gone
// (method.md 6).
#pragma once
#include <vector>

#include "sheetform/base/run_context.h"
#include "sheetform/mesh/closest_point.h"
#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

struct SmoothParams {
  int rounds = 5;            ///< each: path steps, then relaxation of the vertices around, then projection
  int path_steps = 4;        ///< Laplacian steps along the paths in a round
  int relax_steps = 2;       ///< tangential Laplacian steps of the other vertices in a round
  double damping = 0.5;      ///< part of the way to the average that a step goes
  double min_quality = 0.1;  ///< 2 r_in / R_circ that no touched face may fall below
};

/// Moves path vertices by Laplacian smoothing along the paths and other vertices within two rings of them by
/// tangential relaxation; all are put back on `surface`. Vertices with two path edges go to the middle of
/// their neighbours, crossings to the average of four, T-junctions stay on their straight bar. Border
/// vertices, `fixed_vertex` and loose ends stay. Guarantee: no face ends up turned over (against its normal
/// before) or with quality below min_quality, except one that was so before, which does not get worse;
/// vertices go back towards where they were until that holds. Returns the vertices that moved, ascending.
/// Cost: about 1 ms for each 100 path vertices.
std::vector<int> smooth_paths(SurfaceMesh& mesh, const std::vector<char>& path_edge,
                              const std::vector<char>& fixed_vertex, const ClosestPointTree& surface,
                              const SmoothParams& params, RunContext& context);

/// 2 r_in / R_circ: 1 for an equilateral triangle, 0 for a degenerate one.
double radius_ratio(const Vector3& a, const Vector3& b, const Vector3& c);

}  // namespace sheetform
