#include "sheetform/mesh/sample.h"

#include <cmath>

namespace sheetform {

std::vector<SurfaceSample> sample_evenly(const SurfaceMesh& mesh, int count) {
  std::vector<SurfaceSample> samples;
  const double area = surface_area(mesh);
  if (!(area > 0)) return samples;
  double before = 0;  // area of the faces before f
  int next = 0;
  for (int f = 0; f < mesh.face_count() && next < count; ++f) {
    const Vector3 n = mesh.face_normal_raw(f);
    const double own = n.norm() / 2;
    const auto& t = mesh.faces[f];
    for (; next < count && (next + 0.5) / count * area < before + own; ++next) {
      // R2 sequence of Roberts; a point beyond the diagonal is folded back.
      double u = std::fmod(0.5 + 0.7548776662466927 * next, 1.0),
             v = std::fmod(0.5 + 0.5698402909980532 * next, 1.0);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      samples.push_back(
          {(1 - u - v) * mesh.points[t[0]] + u * mesh.points[t[1]] + v * mesh.points[t[2]], n.normalized()});
    }
    before += own;
  }
  return samples;
}

}  // namespace sheetform
