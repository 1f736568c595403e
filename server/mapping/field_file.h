// Reading a cross field that the user gives (design.md 1.2): `.rosy`, or JSON.
#pragma once
#include <string_view>

#include "sheetform/decompose.h"

namespace sheetform::server {

/// One direction for each face or each vertex of a mesh as it was read; where both counts fit, faces.
///
/// .rosy, as field tools write it: the number of directions, then 4 (arms of a cross), then three numbers
/// each, separated by blanks or line ends. JSON: {"directions": [[x, y, z], ...], "per": "face"}, or the list
/// alone; `per` ("face" or "vertex") may be left out. Directions need not be unit or tangent; 0 0 0 (JSON
/// also null) leaves a place free.
///
/// Throws Error kInvalidParameter; where: "field", with the line or the number of the direction.
UserField read_field(std::string_view bytes, std::size_t vertices, std::size_t faces);

}  // namespace sheetform::server
