#include "server/mapping/guides_file.h"

#include <cmath>
#include <initializer_list>

#include "sheetform/base/error.h"
#include "sheetform_api/json_text.h"

namespace sheetform::server {
namespace {

constexpr const char* kForm =
    "give JSON {\"seams\": [{\"points\": [[x, y, z], ...], \"closed\": false}], \"keep_out\": [{\"points\": "
    "[[x, y, z], ...], \"radius\": r}]}";

[[noreturn]] void refuse(const std::string& what, const std::string& where, const std::string& fix = kForm) {
  throw Error(ErrorCode::kInvalidParameter, what, where.empty() ? "guides" : "guides, " + where, fix);
}

void only_members(const api::Json& object, std::initializer_list<const char*> names,
                  const std::string& where) {
  for (const auto& [name, member] : object.items()) {
    bool known = false;
    for (const char* n : names) known |= name == n;
    if (!known) refuse("there is no member " + name.substr(0, 40), where);
  }
}

class Reader {
 public:
  UserGuides read(const api::Json& value) {
    if (!value.is_object()) refuse("the guides are not an object", {});
    only_members(value, {"seams", "keep_out"}, {});
    UserGuides guides;
    for_each(value, "seams", [&](const api::Json& stroke, const std::string& where) {
      only_members(stroke, {"points", "closed"}, where);
      SeamStroke seam;
      if (const auto closed = stroke.find("closed"); closed != stroke.end()) {
        if (!closed->is_boolean()) refuse("closed is neither true nor false", where);
        seam.closed = closed->get<bool>();
      }
      seam.points = points(stroke, seam.closed ? 3 : 2, where);
      guides.seams.push_back(std::move(seam));
    });
    for_each(value, "keep_out", [&](const api::Json& stroke, const std::string& where) {
      only_members(stroke, {"points", "radius"}, where);
      guides.keep_out.push_back({points(stroke, 1, where), radius(stroke, where)});
    });
    if (guides.empty()) refuse("the guides hold no stroke", {}, "draw one, or leave the guides out");
    return guides;
  }

 private:
  template <class Take>
  void for_each(const api::Json& value, const char* name, const Take& take) {
    const auto list = value.find(name);
    if (list == value.end()) return;
    if (!list->is_array()) refuse(std::string(name) + " is not a list", name);
    if (list->size() > kMostStrokes)
      refuse("there are " + std::to_string(list->size()) + " strokes in " + name, name,
             "draw " + std::to_string(kMostStrokes) + " at most");
    for (std::size_t i = 0; i < list->size(); ++i) {
      const std::string where = std::string(name) + "[" + std::to_string(i) + "]";
      if (!(*list)[i].is_object()) refuse("a stroke is not an object", where);
      take((*list)[i], where);
    }
  }

  std::vector<Vector3> points(const api::Json& stroke, std::size_t least, const std::string& where) {
    const auto list = stroke.find("points");
    if (list == stroke.end() || !list->is_array()) refuse("the stroke has no list of points", where);
    if (list->size() < least)
      refuse("the stroke has " + std::to_string(list->size()) + " points", where,
             "give " + std::to_string(least) + " at least");
    if ((count_ += list->size()) > kMostStrokePoints)
      refuse("the strokes have more than " + std::to_string(kMostStrokePoints) + " points", where,
             "draw them with fewer points");
    std::vector<Vector3> points;
    for (std::size_t k = 0; k < list->size(); ++k)
      points.push_back(point((*list)[k], where + ", point " + std::to_string(k)));
    return points;
  }

  static Vector3 point(const api::Json& value, const std::string& where) {
    Vector3 p;
    if (!value.is_array() || value.size() != 3) refuse("a point is not a list of three numbers", where);
    for (int k = 0; k < 3; ++k) {
      const api::Json& x = value[static_cast<std::size_t>(k)];
      if (!x.is_number()) refuse("a point is not a list of three numbers", where);
      p[k] = x.get<double>();
    }
    if (!p.allFinite()) refuse("a coordinate is not finite", where, "give three numbers");
    return p;
  }

  static double radius(const api::Json& stroke, const std::string& where) {
    const auto value = stroke.find("radius");
    if (value == stroke.end() || !value->is_number()) refuse("the stroke has no radius", where);
    const double r = value->get<double>();
    if (!(r > 0) || !std::isfinite(r))
      refuse("the radius is not above 0", where, "give the half width of the brush in units of the mesh");
    return r;
  }

  std::size_t count_ = 0;
};

}  // namespace

UserGuides read_guides(std::string_view bytes) {
  api::Json value;
  std::string why;
  if (!api::parse_json(bytes, value, why)) refuse("the guides " + why, {});
  return Reader().read(value);
}

}  // namespace sheetform::server
