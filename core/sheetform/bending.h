// How sharply the sheets of a result bend, and how far apart their rulings are.
#pragma once
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "sheetform/strip/strip_mesh.h"

namespace sheetform {

struct BendReport {
  std::vector<double> patch_radius;  ///< mm, smallest of each patch; infinite where nothing bends
  double smallest = std::numeric_limits<double>::infinity();  ///< mm
  int patch = -1;                                             ///< that bends to it, -1: nothing bends
  Vector3 place = Vector3::Zero();                            ///< middle of the ruling, units of the mesh
  double reach = 0;                                           ///< mm, of the stretches that were measured
};
/// Radii at the rulings as the exports take them (blueprint/fold_lines.h, bend_radii): over stretches of half
/// of the radius that is asked for (mm), or 5 % of the diagonal where none is. scale: mm for one unit of the
/// mesh.
BendReport measure_bending(const StripMesh& strips, double scale, std::optional<double> asked);

/// For people: the parts that bend more sharply than `least` mm, the sharpest ones by name; empty when none
/// does.
std::string too_sharp(const BendReport& report, const StripMesh& strips, double least);

struct SpacingReport {
  double shortest = 0, longest = 0;  ///< mm between neighbouring points of outlines; 0 without outlines
};
SpacingReport measure_spacing(const StripMesh& strips, double scale);

}  // namespace sheetform
