// What each operation looks like to a machine: layer, colour, width. There is no single standard, so there
// are named profiles, and the operator's own in one JSON file.
#pragma once
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "sheetform/blueprint/blueprint.h"

namespace sheetform {

struct LayerStyle {
  std::string layer;         ///< of DXF and Inkscape; letters, digits, - and _
  std::string colour;        ///< "#rrggbb"
  double width = 0.1;        ///< mm
  int aci = 7;               ///< AutoCAD colour index, 1 to 255
  std::vector<double> dash;  ///< mm: drawn, gap, drawn, gap...; real segments in every format; empty: solid
  bool drawn = true;         ///< false: the operation is left out
};

struct Profile {
  std::string name;
  std::string text;                            ///< one sentence for people
  std::array<LayerStyle, kOperations> layers;  ///< by Operation
  std::array<int, kOperations> order{
      0, 1, 2, 3, 4, 5, 6};  ///< in which operations stand in a file, first is worked first
  double minutes_per_metre_cut = 0, minutes_per_metre_score = 0;  ///< of a usual machine, for the estimate
  bool angle_as_opacity = false;  ///< Origami Simulator: opacity of a fold = angle / 180 degrees
  const LayerStyle& of(Operation operation) const { return layers[static_cast<int>(operation)]; }
};

/// makerspace, lightburn, boxes, ponoko, silhouette, inventor, astm, origami, print.
const std::vector<Profile>& built_in_profiles();

/// The operator's profiles: {"profiles": [{"name": "ours", "text": "...", "like": "makerspace", "layers":
/// {"cut_outer":
/// {"layer": "CUT", "colour": "#ff0000", "width": 0.1, "aci": 1, "dash": [], "drawn": true}, ...}, "order":
/// ["text", ...], "minutes_per_metre_cut": 1, "minutes_per_metre_score": 0.5}]}. What is not given is taken
/// from the profile named by "like" (makerspace). Throws Error kInvalidParameter with the place.
std::vector<Profile> read_profiles(std::string_view json);

/// Looks among `own` first. Throws Error kInvalidParameter naming the ones there are.
const Profile& profile_named(std::string_view name, const std::vector<Profile>& own = {});

/// "text", "notch", "score_mountain", "score_valley", "cut_inner", "cut_outer", "guide".
const char* to_string(Operation operation);

/// A polyline cut into the dashes of `pattern`; the whole line where the pattern is empty.
std::vector<std::vector<Vector2>> dashed(const std::vector<Vector2>& line, bool closed,
                                         const std::vector<double>& pattern);

}  // namespace sheetform
