// The frame along the seams to print and glue sheets onto (the paper's rod-supported build).
#pragma once
#include <string>

#include "sheetform/blueprint/blueprint.h"

namespace sheetform {

struct FrameOptions {
  double radius = 1.5;     ///< mm, of the rods
  int sides = 12;          ///< of a rod's section, 3 to 64
  double text_height = 5;  ///< mm, of the labels that stand beside the rods; 0: none
  bool borders = true;     ///< rods along the surface's border too
};

/// Binary STL in mm: a closed rod along every arch, a ball at every node, and beside each rod in raised
/// strokes the parts on its sides and the seam's number ("A1/A3:12"; the number alone where the rod is short,
/// the part alone at the border). The solids overlap and are each closed; slicers unite them. Throws Error
/// kInvalidParameter for options out of range.
std::string to_seam_frame_stl(const Blueprint& blueprint, const FrameOptions& options);

}  // namespace sheetform
