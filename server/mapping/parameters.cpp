#include "server/mapping/parameters.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "server/mapping/errors.h"

namespace sheetform::server {
namespace {

constexpr const char* kOff = "off";
constexpr std::array<const char*, 3> kEfforts{"draft", "normal", "thorough"};
constexpr std::array<const char*, 2> kMorphs{"reduced", "full"};

template <class Enum, std::size_t N>
Enum from_name(const std::array<const char*, N>& names, const std::string& name) {
  for (std::size_t i = 0; i < N; ++i)
    if (name == names[i]) return static_cast<Enum>(i);
  throw Error(ErrorCode::kInvalidParameter, "unknown choice " + name);
}

std::optional<double> optional_number(const api::Json& values, const char* name) {
  const auto found = values.find(name);
  if (found == values.end() || !found->is_number()) return std::nullopt;  // "off" is no number
  return found->get<double>();
}

std::optional<std::string> optional_text(const api::Json& values, const char* name) {
  const auto found = values.find(name);
  if (found == values.end()) return std::nullopt;
  return found->get<std::string>();
}

/// The text NX,NY,NZ,D; the schema has checked its form. The normal is made unit, D with it.
Plane plane_from(const std::string& text) {
  std::array<double, 4> value{};
  const char* at = text.data();
  const char* end = text.data() + text.size();
  for (double& number : value) {
    at = std::from_chars(at, end, number).ptr;
    if (at != end) ++at;
  }
  const Vector3 normal(value[0], value[1], value[2]);
  const double length = normal.norm();
  return {normal / length, value[3] / length};
}

std::string plane_text(const Plane& plane) {
  std::string text;
  for (const double number : {plane.normal.x(), plane.normal.y(), plane.normal.z(), plane.offset}) {
    char digits[32];
    if (!text.empty()) text += ',';
    text.append(digits, std::to_chars(digits, digits + sizeof digits, number).ptr);
  }
  return text;
}

void read_symmetry(const std::string& text, DecomposeParams& params) {
  if (text == kOff)
    params.symmetry = SymmetryMode::kOff;
  else if (text == "auto")
    params.symmetry = SymmetryMode::kAuto;
  else {
    params.symmetry = SymmetryMode::kPlane;
    params.plane = plane_from(text);
  }
}

std::string symmetry_text(const DecomposeParams& params) {
  switch (params.symmetry) {
    case SymmetryMode::kOff:
      return kOff;
    case SymmetryMode::kAuto:
      return "auto";
    case SymmetryMode::kPlane:
      return plane_text(params.plane);
  }
  return kOff;
}

double finest(const api::Json& tolerance) {
  return tolerance.is_array() ? *std::min_element(tolerance.begin(), tolerance.end()) : tolerance;
}

template <class Complete>
api::Json understood(const api::Json& given, Complete complete) {
  try {
    api::Json values = complete(given);
    validate(to_core(values));
    return values;
  } catch (const api::InvalidParameter& e) {
    throw to_core_error(e);
  }
}

api::Json number_or_off(const std::optional<double>& value) {
  return value ? api::Json(*value) : api::Json(kOff);
}

}  // namespace

DecomposeParams to_core(const api::Json& values) {
  DecomposeParams p;
  p.e_max = finest(values.at(api::kTolerance));
  p.e_max_mm = optional_number(values, "e_max_mm");
  p.t_junctions = values.at("t_junctions");
  read_symmetry(values.at("symmetry"), p);
  p.max_sides = values.at("max_sides");
  p.crease_angle = optional_number(values, "creases");
  p.self_seams = values.at("self_seams");
  p.normal_deviation = optional_number(values, "normal_deviation");
  p.ruling_spacing_min = optional_number(values, "ruling_spacing_min");
  p.ruling_spacing_max = optional_number(values, "ruling_spacing_max");
  p.min_bend_radius = optional_number(values, "min_bend_radius");
  p.effort = from_name<Effort>(kEfforts, values.at("effort"));
  p.morph = from_name<MorphKind>(kMorphs, values.at("morph"));
  p.scale = values.at("scale");
  p.target_size = optional_number(values, "target_size");
  p.seed = values.at("seed");
  p.material = optional_text(values, "material");
  p.up = optional_text(values, "up");
  return p;
}

api::Json to_wire(const DecomposeParams& p) {
  api::Json values{{"e_max", p.e_max},
                   {"t_junctions", p.t_junctions},
                   {"symmetry", symmetry_text(p)},
                   {"max_sides", p.max_sides},
                   {"creases", number_or_off(p.crease_angle)},
                   {"self_seams", p.self_seams},
                   {"normal_deviation", number_or_off(p.normal_deviation)},
                   {"ruling_spacing_min", number_or_off(p.ruling_spacing_min)},
                   {"ruling_spacing_max", number_or_off(p.ruling_spacing_max)},
                   {"min_bend_radius", number_or_off(p.min_bend_radius)},
                   {"effort", kEfforts[static_cast<std::size_t>(p.effort)]},
                   {"morph", kMorphs[static_cast<std::size_t>(p.morph)]},
                   {"scale", p.scale},
                   {"seed", p.seed}};
  if (p.e_max_mm) values["e_max_mm"] = *p.e_max_mm;
  if (p.target_size) values["target_size"] = *p.target_size;
  if (p.material) values["material"] = *p.material;
  if (p.up) values["up"] = *p.up;
  return values;
}

api::Json understood_parameters(const api::Json& given) {
  return understood(given, api::complete_parameters);
}

api::Json understood_sweep_parameters(const api::Json& given) {
  return understood(given, api::complete_sweep_parameters);
}

}  // namespace sheetform::server
