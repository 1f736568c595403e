#include "sheetform/blueprint/materials.h"

#include "sheetform/base/error.h"

namespace sheetform {

const std::vector<Material>& materials() {
  static const std::vector<Material> all = {
      {"paper", "Paper: bends to any radius", {}},
      {"card", "Card: bends to any radius, sharp bends want a score", {}},
      {"fabric", "Fabric, felt, thin leather: bend to any radius", {}},
      {"plywood",
       "Birch plywood bent dry, stiffer way of the grain",
       {{0.9, 51}, {1.8, 132}, {3.2, 305}, {4.7, 508}, {6.4, 787}}},
      {"plywood-wet", "Birch plywood soaked in hot water", {{3.2, 97}}},
      {"steel", "Mild steel: radius of the thickness at least", {{1, 1}}},
      {"aluminium", "Soft aluminium: radius of the thickness at least", {{1, 1}}}};
  return all;
}

const Material& material_named(std::string_view name) {
  std::string known;
  for (const Material& m : materials()) {
    if (m.name == name) return m;
    known += (known.empty() ? "" : ", ") + m.name;
  }
  throw Error(ErrorCode::kInvalidParameter, "there is no material of this name", "material",
              "Choose one of " + known);
}

double smallest_radius(const Material& material, double thickness) {
  if (material.radii.empty() || thickness <= 0) return 0;
  const auto& r = material.radii;
  if (thickness <= r.front().first) return r.front().second * thickness / r.front().first;
  for (std::size_t i = 1; i < r.size(); ++i)
    if (thickness <= r[i].first) {
      const double share = (thickness - r[i - 1].first) / (r[i].first - r[i - 1].first);
      return r[i - 1].second + share * (r[i].second - r[i - 1].second);
    }
  return r.back().second * thickness / r.back().first;
}

}  // namespace sheetform
