// Texts as single strokes: what a laser engraves and a plotter draws, the same in every format.
#pragma once
#include <string_view>
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// Polylines with the baseline along +x from the origin; capitals are `height` high, small letters are drawn
/// as capitals, what is not printable ASCII as a small box. Comma and the like reach a sixth of the height
/// below.
struct StrokeText {
  std::vector<std::vector<Vector2>> lines;
  double width = 0;  ///< from the left of the first to the right of the last character, 0 for no text
  double height = 0;
};
StrokeText stroke_text(std::string_view text, double height);
/// Width without the lines.
double stroke_text_width(std::string_view text, double height);

}  // namespace sheetform
