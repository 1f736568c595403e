// FOLD 1.2: the crease pattern of all parts and, as a second frame, the folded form.
#pragma once
#include <string>

#include "sheetform/blueprint/blueprint.h"

namespace sheetform {

/// Key frame: creasePattern in mm, parts side by side as on the sheets (sheets in a row), outside up, every
/// inner edge with its fold angle (degrees, valley > 0, mountain < 0; F where exactly flat), borders B.
/// file_frames[0]: foldedForm, the same vertices in 3D mm. part >= 0: that part alone. Own data:
/// faces_sheetform:part (label), edges_sheetform:seam (number or null), edges_sheetform:kind ("ruling",
/// "diagonal", "seam", "border").
std::string to_fold(const Blueprint& blueprint, int part = -1);

}  // namespace sheetform
