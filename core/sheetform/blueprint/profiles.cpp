#include "sheetform/blueprint/profiles.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>

#include "sheetform/base/error.h"

namespace sheetform {
namespace {

using Json = nlohmann::json;

// Order of the styles: text, notch, mountain, valley, inner cut, outer cut, guide.
using Styles = std::array<LayerStyle, kOperations>;

Profile profile(const char* name, const char* text, Styles layers, double cut = 1.5, double score = 0.4) {
  Profile p;
  p.name = name, p.text = text, p.layers = std::move(layers);
  p.minutes_per_metre_cut = cut, p.minutes_per_metre_score = score;
  return p;
}

Profile makerspace() {
  return profile("makerspace", "Red is cut, blue is scored, black is engraved, grey is left alone",
                 {{{"TEXT", "#000000", 0.1, 7, {}},
                   {"NOTCH", "#000000", 0.1, 7, {}},
                   {"BEND_DOWN", "#0000ff", 0.1, 4, {}},
                   {"BEND_UP", "#0000ff", 0.1, 5, {}},
                   {"CUT_INNER", "#ff0000", 0.1, 6, {}},
                   {"CUT", "#ff0000", 0.1, 1, {}},
                   {"SHEET", "#999999", 0.1, 8, {}}}});
}

Profile lightburn() {
  return profile(
      "lightburn",
      "LightBurn's palette: C00 outer, C01 inner, C02 mountain, C03 valley, C05 notches, C06 text, T1 notes",
      {{{"C06_TEXT", "#00e0e0", 0.1, 4, {}},
        {"C05_NOTCH", "#ff8000", 0.1, 30, {}},
        {"C02_MOUNTAIN", "#ff0000", 0.1, 1, {}},
        {"C03_VALLEY", "#00e000", 0.1, 3, {}},
        {"C01_INNER", "#0000ff", 0.1, 5, {}},
        {"C00_OUTER", "#000000", 0.1, 7, {}},
        {"T1_NOTES", "#f36926", 0.1, 8, {}}}});
}

Profile boxes() {
  return profile("boxes", "boxes.py: black outer, blue inner cuts, green and cyan etched, red comments",
                 {{{"ETCH_DEEP", "#00ffff", 0.1, 4, {}},
                   {"ETCH_NOTCH", "#00ff00", 0.1, 3, {}},
                   {"ETCH_MOUNTAIN", "#00ff00", 0.1, 3, {}},
                   {"ETCH_VALLEY", "#00ff00", 0.1, 3, {}},
                   {"INNER_CUT", "#0000ff", 0.1, 5, {}},
                   {"OUTER_CUT", "#000000", 0.1, 7, {}},
                   {"ANNOTATIONS", "#ff0000", 0.1, 1, {}}}});
}

Profile ponoko() {
  LayerStyle none{"NOTES", "#999999", 0.01, 8, {}, false};
  return profile("ponoko", "Blue 0.01 mm is cut, red is engraved as a line; no bar, no notes",
                 {{{"ENGRAVE", "#ff0000", 0.01, 1, {}},
                   {"ENGRAVE_NOTCH", "#ff0000", 0.01, 1, {}},
                   {"ENGRAVE_DOWN", "#ff0000", 0.01, 1, {}},
                   {"ENGRAVE_UP", "#ff0000", 0.01, 1, {}},
                   {"CUT_INNER", "#0000ff", 0.01, 5, {}},
                   {"CUT", "#0000ff", 0.01, 5, {}},
                   none}});
}

Profile silhouette() {
  return profile("silhouette", "Layers Print, Score and Cut for blade and pen plotters",
                 {{{"Print", "#000000", 0.1, 7, {}},
                   {"Notch", "#000000", 0.1, 7, {}},
                   {"Score_Mountain", "#ff0000", 0.1, 1, {}},
                   {"Score_Valley", "#0000ff", 0.1, 5, {}},
                   {"Cut_Inner", "#00aa00", 0.1, 3, {}},
                   {"Cut", "#000000", 0.1, 7, {}},
                   {"Regmarks", "#999999", 0.3, 8, {}}}},
                 0.8, 0.5);
}

Profile inventor() {
  return profile("inventor", "Layers of Inventor's flat patterns, for sheet metal",
                 {{{"IV_UNCONSUMED_SKETCHES", "#000000", 0.1, 7, {}},
                   {"IV_NOTCH_MARKS", "#000000", 0.1, 7, {}},
                   {"IV_BEND_DOWN", "#0000ff", 0.1, 4, {}},
                   {"IV_BEND", "#0000ff", 0.1, 5, {}},
                   {"IV_INTERIOR_PROFILES", "#ff00ff", 0.1, 6, {}},
                   {"IV_OUTER_PROFILE", "#ff0000", 0.1, 1, {}},
                   {"SHEET", "#999999", 0.1, 8, {}}}},
                 0.5, 0.5);
}

Profile astm() {
  return profile("astm",
                 "ASTM D6673 layer numbers of the sewing trade: 1 boundary, 4 notches, 8 internal lines, 11 "
                 "cut-outs, 15 text",
                 {{{"15", "#000000", 0.1, 7, {}},
                   {"4", "#000000", 0.1, 3, {}},
                   {"8", "#0000ff", 0.1, 5, {}},
                   {"8", "#0000ff", 0.1, 5, {}},
                   {"11", "#ff00ff", 0.1, 6, {}},
                   {"1", "#ff0000", 0.1, 1, {}},
                   {"SHEET", "#999999", 0.1, 8, {}}}},
                 0.5, 0.5);
}

Profile origami() {
  LayerStyle none{"NOTES", "#999999", 0.1, 8, {}, false};
  Profile p =
      profile("origami", "Origami Simulator: black border, red mountain, blue valley, opacity = angle / 180",
              {{none,
                none,
                {"MOUNTAIN", "#ff0000", 0.3, 1, {}},
                {"VALLEY", "#0000ff", 0.3, 5, {}},
                {"INNER", "#00ff00", 0.3, 3, {}},
                {"BORDER", "#000000", 0.3, 7, {}},
                none}},
              0, 0);
  p.angle_as_opacity = true;
  return p;
}

Profile print() {
  return profile("print",
                 "Grey paper copies: cut solid, mountain dashed, valley dash and dot; the meaning survives "
                 "without colour",
                 {{{"TEXT", "#000000", 0.15, 7, {}},
                   {"NOTCH", "#000000", 0.3, 7, {}},
                   {"MOUNTAIN", "#000000", 0.15, 7, {3, 1.5}},
                   {"VALLEY", "#000000", 0.15, 7, {3, 1, 0.4, 1}},
                   {"CUT_INNER", "#000000", 0.3, 7, {}},
                   {"CUT", "#000000", 0.3, 7, {}},
                   {"NOTES", "#777777", 0.1, 8, {}}}},
                 4, 2);  // by hand
}

[[noreturn]] void refuse(const std::string& what, const std::string& where) {
  throw Error(ErrorCode::kInvalidParameter, what, "profiles: " + where,
              "Correct the operator's file of profiles");
}

int operation_named(const std::string& name, const std::string& where) {
  for (int i = 0; i < kOperations; ++i)
    if (name == to_string(static_cast<Operation>(i))) return i;
  refuse("there is no operation '" + name + "'", where);
}

double number(const Json& j, const char* key, double otherwise, double low, double high,
              const std::string& where) {
  if (!j.contains(key)) return otherwise;
  if (!j[key].is_number() || !(j[key].get<double>() >= low && j[key].get<double>() <= high))
    refuse(std::string(key) + " is out of range", where);
  return j[key].get<double>();
}

std::string text(const Json& j, const char* key, const std::string& otherwise, const char* pattern,
                 const std::string& where) {
  if (!j.contains(key)) return otherwise;
  if (!j[key].is_string() || !std::regex_match(j[key].get<std::string>(), std::regex(pattern)))
    refuse(std::string(key) + " is not usable", where);
  return j[key].get<std::string>();
}

void read_layer(const Json& j, LayerStyle& s, const std::string& where) {
  if (!j.is_object()) refuse("a layer is not an object", where);
  s.layer = text(j, "layer", s.layer, "[A-Za-z0-9_-]{1,64}", where);
  s.colour = text(j, "colour", s.colour, "#[0-9a-fA-F]{6}", where);
  s.width = number(j, "width", s.width, 0.001, 5, where);
  s.aci = static_cast<int>(number(j, "aci", s.aci, 1, 255, where));
  if (j.contains("drawn")) {
    if (!j["drawn"].is_boolean()) refuse("drawn is neither true nor false", where);
    s.drawn = j["drawn"].get<bool>();
  }
  if (!j.contains("dash")) return;
  if (!j["dash"].is_array() || j["dash"].size() > 16 || j["dash"].size() % 2 == 1)
    refuse("dash is not a list of pairs", where);
  s.dash.clear();
  for (const Json& d : j["dash"]) {
    if (!d.is_number() || !(d.get<double>() >= 0.1 && d.get<double>() <= 1000))
      refuse("a dash is out of range", where);
    s.dash.push_back(d.get<double>());
  }
}

Profile read_profile(const Json& j, const std::vector<Profile>& so_far) {
  if (!j.is_object()) refuse("a profile is not an object", "profiles");
  const std::string name = text(j, "name", "", "[a-z0-9_-]{1,32}", "name");
  if (name.empty()) refuse("a profile without a name", "profiles");
  Profile p = profile_named(text(j, "like", "makerspace", "[a-z0-9_-]{1,32}", name), so_far);
  p.name = name;
  p.text = text(j, "text", "", "[^\\x00-\\x1f]{0,200}", name);
  if (j.contains("layers")) {
    if (!j["layers"].is_object()) refuse("layers is not an object", name);
    for (const auto& [key, value] : j["layers"].items())
      read_layer(value, p.layers[operation_named(key, name)], name + ", " + key);
  }
  if (j.contains("order")) {
    std::vector<int> order;
    for (const Json& o : j["order"])
      order.push_back(operation_named(o.is_string() ? o.get<std::string>() : "", name));
    std::vector<int> sorted = order;
    std::sort(sorted.begin(), sorted.end());
    if (sorted != std::vector<int>{0, 1, 2, 3, 4, 5, 6}) refuse("order must name every operation once", name);
    std::copy(order.begin(), order.end(), p.order.begin());
  }
  p.minutes_per_metre_cut = number(j, "minutes_per_metre_cut", p.minutes_per_metre_cut, 0, 1000, name);
  p.minutes_per_metre_score = number(j, "minutes_per_metre_score", p.minutes_per_metre_score, 0, 1000, name);
  return p;
}

}  // namespace

const char* to_string(Operation operation) {
  switch (operation) {
    case Operation::kText:
      return "text";
    case Operation::kNotch:
      return "notch";
    case Operation::kScoreMountain:
      return "score_mountain";
    case Operation::kScoreValley:
      return "score_valley";
    case Operation::kCutInner:
      return "cut_inner";
    case Operation::kCutOuter:
      return "cut_outer";
    case Operation::kGuide:
      break;
  }
  return "guide";
}

const std::vector<Profile>& built_in_profiles() {
  static const std::vector<Profile> profiles{makerspace(), lightburn(), boxes(),   ponoko(), silhouette(),
                                             inventor(),   astm(),      origami(), print()};
  return profiles;
}

std::vector<Profile> read_profiles(std::string_view json) {
  std::vector<Profile> out;
  try {
    const Json root = Json::parse(json);
    if (!root.is_object() || !root.contains("profiles") || !root["profiles"].is_array())
      refuse("there is no list \"profiles\"", "root");
    for (const Json& j : root["profiles"]) out.push_back(read_profile(j, out));
  } catch (const Json::exception& e) {
    refuse(e.what(), "root");
  }
  return out;
}

const Profile& profile_named(std::string_view name, const std::vector<Profile>& own) {
  std::string known;
  for (const std::vector<Profile>* list : {&own, &built_in_profiles()})
    for (const Profile& p : *list) {
      if (p.name == name) return p;
      known += (known.empty() ? "" : ", ") + p.name;
    }
  throw Error(ErrorCode::kInvalidParameter, "there is no profile of this name", "profile",
              "Choose one of " + known);
}

std::vector<std::vector<Vector2>> dashed(const std::vector<Vector2>& line, bool closed,
                                         const std::vector<double>& pattern) {
  std::vector<Vector2> path = line;
  if (closed && !path.empty()) path.push_back(path.front());
  if (pattern.empty()) return {path};
  std::vector<std::vector<Vector2>> out;
  std::size_t at = 0;
  double left = pattern[0];
  bool on = true;
  if (!path.empty()) out.push_back({path.front()});
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    Vector2 from = path[i];
    double rest = (path[i + 1] - from).norm();
    while (rest > left) {
      from += left / rest * (path[i + 1] - from);
      rest -= left;
      if (on)
        out.back().push_back(from);
      else
        out.push_back({from});
      on = !on, at = (at + 1) % pattern.size(), left = pattern[at];
    }
    left -= rest;
    if (on) out.back().push_back(path[i + 1]);
  }
  std::erase_if(out, [](const std::vector<Vector2>& dash) { return dash.size() < 2; });
  return out;
}

}  // namespace sheetform
