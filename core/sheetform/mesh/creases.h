// Sharp edges: where the surface really has an edge, not where it is merely strongly curved or rough.
#pragma once
#include <vector>

#include "sheetform/base/run_context.h"
#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// 1 for each interior edge on a crease, 0 for all others (border edges too). angle_degrees: least angle
/// between the normals of the two sides, (0, 180).
///
/// An edge counts when its dihedral angle is about the whole turning of the surface nearby (mean normals of
/// the two sides within two edge lengths): a rounded ridge turns over several edges, roughness turns back.
/// Weaker edges (two thirds of the angle) join gaps. The chains that result must be long, straight beyond the
/// zigzag of edges, and closed or ending at borders or other creases; chains with a loose end only count when
/// they are long, or smooth and held by other creases at the other end. Wants a mesh whose edges follow its
/// creases. O(n) but for chains; deterministic.
std::vector<char> detect_creases(const SurfaceMesh& mesh, double angle_degrees,
                                 const RunContext& context = {});

/// `crease` without what bounds regions narrower than `width` (twice the area over the outline), as a thin
/// chamfer or the overlap of a file's triangles: such a region joins a wider neighbour over the line between
/// them, the one that folds least of those that are long. Regions with narrow neighbours alone stay, and the
/// walls of thin plates. The lines that go are about `width` away from others that stay. O(n) for each of a
/// few passes; deterministic.
std::vector<char> without_narrow_regions(const SurfaceMesh& mesh, std::vector<char> crease, double width);

}  // namespace sheetform
