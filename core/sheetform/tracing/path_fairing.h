// The smooth course of paths over a surface: least geodesic bending, close to where they were.
#pragma once
#include <array>
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// Three consecutive vertices of a path, the middle one movable. `across_only`: only bending across the path
/// counts, spacing along it does not (at crossings, where it would hold the other path back).
struct PathStencil {
  int before, at, after;  ///< mesh vertices
  bool across_only;
};

/// Minimises anchor * |x - x0|^2 + |tangential part of (x_at - (x_before + x_after) / 2)|^2 over tangential
/// moves of the movable vertices; all others stay. `normal[i]` is the unit normal of movable[i], `slot` the
/// index into movable of each mesh vertex, or -1. Returns the new places of `movable`, not yet on the
/// surface. One sparse factorisation of 2 |movable| unknowns.
std::vector<Vector3> fair_paths(const std::vector<Vector3>& points, const std::vector<int>& movable,
                                const std::vector<int>& slot, const std::vector<Vector3>& normal,
                                const std::vector<PathStencil>& stencils, double anchor);

}  // namespace sheetform
