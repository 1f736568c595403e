// layout.svg: all parts on one page, true to scale, drawn with the outside up.
#pragma once
#include <array>
#include <string>

#include "sheetform/blueprint/page_layout.h"

namespace sheetform {

/// Lengths in millimetres, y up, origin at the page's lower left.
struct DrawnPart {
  int patch = 0;  ///< its id in layout.json
  std::string label;
  Polygon outline;
  std::vector<std::array<Vector2, 2>> rulings;
};
struct LayoutDrawing {
  double width = 0, height = 0;
  std::vector<DrawnPart> parts;
};

/// One page, 1 unit = 1 mm, y flipped, not mirrored; a group a part, its outline one closed path of class
/// cut, rulings of class ruling, the label in single strokes of class text; looks as inline attributes.
/// Coordinates are rounded to 1e-5 mm.
std::string write_layout_svg(const LayoutDrawing& drawing);

}  // namespace sheetform
