#include "sheetform/search/patch_tilt.h"

#include <algorithm>
#include <cmath>

#include "sheetform/strip/certificate.h"

namespace sheetform {
namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846;

bool covers(const PatchPolygon& polygon, const std::array<int, 3>& t, const Vector2& u) {
  const Vector2 &a = polygon.uv[t[0]], &b = polygon.uv[t[1]], &c = polygon.uv[t[2]];
  return cross(b - a, u - a) >= 0 && cross(c - b, u - b) >= 0 && cross(a - c, u - c) >= 0;
}

}  // namespace

PatchTilt patch_tilt(const SearchSurface& surface, const Patch& patch, const PatchChart& chart,
                     const PatchPolygon& polygon, const std::vector<std::array<int, 3>>& strips,
                     const std::vector<Vector3>& position) {
  struct Face {
    double angle, area;
    Vector2 centre;
  };
  std::vector<Face> faces;
  double total = 0;
  for (std::size_t i = 0; i < patch.faces.size(); ++i) {
    const auto& t = chart.triangles[i];
    const Vector2 centre = (chart.uv[t[0]] + chart.uv[t[1]] + chart.uv[t[2]]) / 3;
    const auto strip =
        std::find_if(strips.begin(), strips.end(), [&](const auto& s) { return covers(polygon, s, centre); });
    if (strip == strips.end()) continue;  // beside the sampled outline
    const Vector3& a = position[(*strip)[0]];
    const Vector3 over = (position[(*strip)[1]] - a).cross(position[(*strip)[2]] - a),
                  own = surface.mesh.face_normal_raw(patch.faces[i]);
    faces.push_back({angle_between(own, over) * kDegrees, own.norm() / 2, centre});
    total += faces.back().area;
  }
  std::stable_sort(faces.begin(), faces.end(),
                   [](const Face& a, const Face& b) { return a.angle < b.angle; });
  double below = 0;
  for (const Face& f : faces)
    if ((below += f.area) >= NormalReport::kShare * total) return {f.angle, f.centre};
  return {};
}

}  // namespace sheetform
