// The faces around a vertex.
#pragma once
#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// Faces at v, each twice (once for each of its two edges there), border faces at least once. O(valence).
template <typename Visit>
void visit_faces_at(const SurfaceMesh& mesh, int v, const Visit& visit) {
  for (const int* e = mesh.ring_begin_of(v); e != mesh.ring_end_of(v); ++e)
    for (int f : {mesh.edges[*e].f0, mesh.edges[*e].f1})
      if (f >= 0) visit(f);
}

}  // namespace sheetform
