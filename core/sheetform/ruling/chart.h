// The flat image of a patch, as isometric as can be: where straight rulings are searched (paper 3.3.1).
#pragma once
#include <vector>

#include "sheetform/layout/layout.h"

namespace sheetform {

/// As-rigid-as-possible parametrisation of one patch, cut open along its seams with itself.
/// uv in the units of the mesh; triangles are counter-clockwise where the map is not folded.
struct PatchChart {
  std::vector<int> vertices;                  ///< local vertex -> mesh vertex (seam vertices occur twice)
  std::vector<Vector2> uv;                    ///< per local vertex
  std::vector<std::array<int, 3>> triangles;  ///< local vertices, in the order of patch.faces
  std::vector<std::vector<int>> boundary;     ///< per arch use: local vertices along it, both ends included
  double folded = 0;                          ///< share of the area that is folded over
  double distortion = 0;                      ///< mean of (s1-1)^2 + (s2-1)^2, s = singular values of the map
};

struct ChartParams {
  int max_iterations = 4;
  double stop = 5e-3;           ///< relative decrease of the energy
  double close_enough = 0.008;  ///< distortion up to which the outline of the conformal map is left as it is
  /// Rank of each mesh vertex in a fill-reducing order of the whole mesh; null = as they come.
  const std::vector<int>* elimination_rank = nullptr;
};

/// A fill-reducing order of all vertices (approximate minimum degree): any patch factorises well in it.
std::vector<int> elimination_rank(const SurfaceMesh& mesh);

/// The conformal outline that keeps its lengths (or, where the map folds over, Tutte's on a circle), the
/// inside settled by local/global iterations (method.md 8.2). Where that distorts by much, the outline takes
/// part in some more: from there three or four do, from the circle long patches are far from settled after
/// twenty. Where it does not, these would change nothing in the parts needed and cost as much as all the
/// rest. The patch must be a disk when cut open. Cost: one sparse factorisation of the inner vertices and,
/// where the outline moves, one of all vertices.
PatchChart parametrize(const SurfaceMesh& mesh, const PatchLayout& layout, const Patch& patch,
                       const ChartParams& params);

}  // namespace sheetform
