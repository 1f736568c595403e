#include "sheetform/blueprint/option_limits.h"

#include <string>

#include "sheetform/base/error.h"
#include "sheetform/blueprint/text.h"

namespace sheetform {
namespace {

constexpr OptionLimits kLimits[] = {
    {"model_size", 0, 100000},   {"sheet_width", 0, 20000}, {"sheet_height", 0, 20000},
    {"margin", 0, 200},          {"gap", 0, 200},           {"turns", 1, 64},
    {"copies", 1, 100},          {"label_height", 0, 100},  {"seam_text_height", 0, 100},
    {"smallest_text", 0.1, 100}, {"notch_size", 0.1, 50},   {"ruling_step", 0, 180},
    {"hidden_bend", 0, 180},     {"ruling_clear", 0, 50},   {"dash", 0.1, 100},
    {"dash_gap", 0.1, 100},      {"tick_length", 0.1, 100}, {"tab_depth", 0.5, 100},
    {"tab_angle", 20, 90},       {"tab_pitch", 1, 1000},    {"kerf", 0, 5},
    {"thickness", 0, 100},       {"page_width", 0, 5000},   {"page_height", 0, 5000},
    {"page_margin", 0, 100},     {"page_overlap", 0, 100},  {"frame_radius", 0.05, 100},
    {"frame_text", 0, 100},      {"frame_sides", 3, 64},    {"sheet", 1, 100000}};

}  // namespace

const OptionLimits& limits_of(std::string_view name) {
  for (const OptionLimits& limits : kLimits)
    if (name == limits.name) return limits;
  throw Error(ErrorCode::kInternal, "an option without limits", std::string(name));
}

void require_in_range(double value, std::string_view name) {
  const OptionLimits& limits = limits_of(name);
  if (value >= limits.low && value <= limits.high) return;
  throw Error(
      ErrorCode::kInvalidParameter,
      std::string(name) + " must lie between " + rounded(limits.low, 3) + " and " + rounded(limits.high, 3),
      std::string(name), "Correct the value or leave it out");
}

}  // namespace sheetform
