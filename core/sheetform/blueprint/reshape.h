// Other shapes of the same result before it is drawn: the middle of thick material, and parts that fit their
// sheet.
#pragma once
#include <string>
#include <vector>

#include "sheetform/blueprint/blueprint.h"

namespace sheetform {

/// The surface moved along its normals (distance in units of the mesh, outwards positive) and unfolded again.
/// Points move so that every face around them moves by `distance` as nearly as can be; seams stay shared.
/// Throws Error kInvalidParameter (where "thickness") naming the parts that would overlap or vanish.
StripMesh moved_surface(const StripMesh& strips, double distance, const std::vector<std::string>& labels,
                        double bbox_diagonal);

/// Cuts a patch along an inner edge (two uvs of it): the second half becomes the last patch, the edge an
/// arch.
void split_patch(StripMesh& strips, int patch, const std::array<int, 2>& edge_vt);

/// Splits patches along rulings (inner edges where there are none) until every one fits into a rectangle of
/// this size, turned as it likes; lengths in units of the mesh. Parts of "A3" are called "A3a", "A3b". Throws
/// Error kInvalidParameter (where "sheet") when a patch cannot be split any further.
void split_to_fit(StripMesh& strips, std::vector<std::string>& labels, double width, double height);

}  // namespace sheetform
