// The mesh that a search works on: even, and as fine as the tolerance asks for.
#pragma once
#include <optional>

#include "sheetform/mesh/prepare.h"

namespace sheetform {

struct WorkingMeshParams {
  double e_max = 0.02;                 ///< tolerance, in the unit of the mesh, whose diagonal is about 1
  std::optional<double> crease_angle;  ///< degrees; none: no creases are looked for
  bool draft = false;                  ///< coarser, for a quick answer
};

/// Finds the creases of one component and remeshes it, unless it is even and of a fitting edge length as it
/// is; finer where vertices of the input would be lost. A noisy scan is smoothed before (is_noisy, denoised),
/// unless that takes more than 0.7 of the tolerance. Sharp edges are kept in place also where they are not
/// asked for as creases. `tree`: of `input`. Throws as the context does. Cost that of one to three
/// remeshings.
PreparedMesh working_mesh(const SurfaceMesh& input, const ClosestPointTree& tree,
                          const WorkingMeshParams& params, const RunContext& context);

}  // namespace sheetform
