// Which faces and vertices of one surface may be far from another, without asking for every one of them.
#pragma once
#include <array>
#include <vector>

#include "sheetform/mesh/closest_point.h"

namespace sheetform {

/// All faces with a point that is farther than `limit` from the surface of `to`, and some that have none: a
/// ball of faces all of which is nearer is passed over. own: the tree of the faces. Ascending. When the two
/// surfaces are much nearer than `limit`, cost hardly depends on the number of faces; at worst it is
/// O(n log n).
std::vector<int> far_faces(const ClosestPointTree& own, const ClosestPointTree& to, double limit,
                           const RunContext& context);

struct FarVertex {
  int vertex, face;  ///< `face` is one of those around the vertex
};

/// The vertices of far_faces(), ascending, each once: all that are farther than `limit`, and some that are
/// not.
std::vector<FarVertex> far_vertices(const std::vector<std::array<int, 3>>& faces, const ClosestPointTree& own,
                                    const ClosestPointTree& to, double limit, const RunContext& context);

}  // namespace sheetform
