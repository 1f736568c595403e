// A sheet as SVG for cutters: layers, closed contours, single strokes.
#pragma once
#include <string>

#include "sheetform/blueprint/profiles.h"

namespace sheetform {

/// One sheet, 1 unit = 1 mm, y flipped. A layer (Inkscape) for each operation in the profile's order; in it a
/// group for each part (data-part, data-patch, data-op) with one closed path a contour. Inline attributes
/// only; no text elements, styles, transforms or clones. Coordinates are rounded to 1e-4 mm. Where it comes
/// from stands in <metadata>.
std::string to_svg(const Blueprint& blueprint, int sheet, const Profile& profile);

/// Where a blueprint comes from, as one line of JSON: goes into every format.
std::string origin_json(const Blueprint& blueprint);

}  // namespace sheetform
