// The model as OBJ whose texture coordinates are the blueprint: any viewer shows which piece of sheet lies
// where.
#pragma once
#include <string>

#include "sheetform/blueprint/blueprint.h"

namespace sheetform {

/// v: positions in mm, shared along seams. vt: place on the sheet as a share of its width and height; sheet s
/// (from 0) lies in [s, s + 1] x [0, 1], as UDIM tiles do; parts drawn mirrored (marked inside) are mirrored
/// there. One group "part_LABEL" a part, triangles only. Sheet sizes and the origin stand in comments.
std::string to_obj(const Blueprint& blueprint);

}  // namespace sheetform
