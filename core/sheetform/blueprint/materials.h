// What a material allows: the smallest radius to which it bends.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace sheetform {

struct Material {
  std::string name, text;
  /// (thickness mm, smallest radius mm), ascending; empty: bends to any radius.
  std::vector<std::pair<double, double>> radii;
};

/// paper, card, fabric, plywood (FAA AC 43.13-1B, bent dry, across the face grain: the stiffer way),
/// plywood-wet (soaked in hot water), steel, aluminium (first rule: the thickness itself).
const std::vector<Material>& materials();
/// Throws Error kInvalidParameter naming the ones there are.
const Material& material_named(std::string_view name);

/// mm; between the entries by interpolation, outside of them in proportion to the thickness. 0: any radius.
double smallest_radius(const Material& material, double thickness);

}  // namespace sheetform
