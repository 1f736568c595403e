// Scanned surfaces: whether there is noise on a mesh, and the mesh without it.
#pragma once
#include "sheetform/base/run_context.h"
#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// Whether roughness as fine as the triangles lies on the whole surface: a twelfth of the edges (by length,
/// of a sample) turn by 8 degrees and more where the surface around turns by less than two thirds of that.
/// Clean meshes have 6 % at most, with normal noise of 0.1 % of the diagonal it is 12 %. Meshes of very
/// uneven edges never count: not a scanner's, and coarse ones of that kind are angular all over. O(n).
bool is_noisy(const SurfaceMesh& mesh);

/// The same triangles with vertices moved so that flat and curved regions become smooth and edges between
/// them sharp (normals filtered bilaterally, vertices following them: Zheng et al. 2011, Sun et al. 2007).
/// Borders stay (of a half they lie on the plane of symmetry). O(n), 40 ms for 20 k faces; deterministic.
SurfaceMesh denoised(const SurfaceMesh& mesh, const RunContext& context = {});

}  // namespace sheetform
