// Makes an oriented manifold of any triangle soup and tells what it did.
#pragma once
#include <vector>

#include "sheetform/base/run_context.h"
#include "sheetform/mesh/mesh_audit.h"
#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

struct RepairResult {
  SurfaceMesh mesh;
  MeshAudit audit;
  std::vector<int> face_origin;    ///< repaired face -> face of the soup
  std::vector<int> vertex_origin;  ///< repaired vertex -> a point of the soup at the same place; -1: a new
                                   ///< point on an edge
};

/// Welds equal positions, then, only where the result is no oriented manifold: welds positions nearer than
/// 1e-9 of the diagonal, removes duplicate faces, cuts edges of more than two faces open (the two flattest
/// faces of matching orientation stay together), turns faces to their component's majority (by area), cuts
/// non-orientable components open, splits vertices where fans of faces touch. A soup that is an oriented
/// manifold once welded keeps its topology and orientation exactly, also when it points inward. Flat faces of
/// distinct vertices are kept. Throws Error kUnsupportedMesh when no face or no area is left. O(n log n).
RepairResult repair(const TriangleSoup& soup, const RunContext& context = {});

/// Loops of border edges, by their vertices; the loop of the lowest vertex first, from it on.
std::vector<std::vector<int>> border_loops(const SurfaceMesh& mesh);
int count_border_loops(const SurfaceMesh& mesh);

}  // namespace sheetform
