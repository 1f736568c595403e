// Meshes of one shape at many sizes, for how cost grows.
#pragma once
#include "sheetform/mesh/surface_mesh.h"

namespace sheetform::bench {

/// Every face as four, `times` times (Loop 1987): the points go where the smooth limit wants them. Edges on
/// the border and creases, as the program finds them on `soup`, stay lines of their own; where other than two
/// of them meet stays a corner. A soup that is no manifold is repaired first. O(n log n).
TriangleSoup refined(const TriangleSoup& soup, int times);

/// The shape with about `faces` faces, made by the program's own remesher.
TriangleSoup remeshed(const TriangleSoup& soup, int faces);

}  // namespace sheetform::bench
