#include "sheetform/strip/assemble.h"

#include <cmath>

#include "sheetform/strip/certificate_checks.h"
#include "sheetform/strip/unfold.h"

namespace sheetform {
namespace {

constexpr double kFlat = 0.5 * 3.14159265358979323846 / 180;  // what a sheet may turn without a fold line

}  // namespace

StripMesh assemble_strips(const StripSource& source) {
  StripMesh mesh;
  mesh.points = source.points;
  for (const StripSource::Patch& from : source.patches) {
    StripMesh::Patch patch;
    const int first_uv = static_cast<int>(mesh.uvs.size()), n = static_cast<int>(from.outline.size());
    std::vector<Vector3> outline(n);
    for (int i = 0; i < n; ++i) outline[i] = source.points[from.outline[i]];
    const std::vector<Vector2> flat = unfold(outline, from.triangles);
    mesh.uvs.insert(mesh.uvs.end(), flat.begin(), flat.end());
    patch.boundary = from.outline;
    for (int i = 0; i < n; ++i) patch.boundary_vt.push_back(first_uv + i);
    for (const auto& t : from.triangles)
      patch.triangles.push_back({{from.outline[t[0]], from.outline[t[1]], from.outline[t[2]]},
                                 {first_uv + t[0], first_uv + t[1], first_uv + t[2]}});
    for (const auto& r : from.rulings) patch.rulings.push_back({from.outline[r[0]], from.outline[r[1]]});
    patch.corners = from.corners;
    patch.arches = from.arches;
    mesh.patches.push_back(std::move(patch));
  }
  for (const StripSource::Arch& a : source.arches)
    mesh.arches.push_back({a.points, a.patches, a.crease, a.on_plane, a.drawn});
  return mesh;
}

void drop_flat_rulings(StripMesh& strips) {
  const auto normal = [&](const StripMesh::Triangle& t) {
    const Vector3& a = strips.points[t.v[0]];
    return Vector3((strips.points[t.v[1]] - a).cross(strips.points[t.v[2]] - a));
  };
  for (int p = 0; p < static_cast<int>(strips.patches.size()); ++p) {
    StripMesh::Patch& patch = strips.patches[p];
    if (patch.rulings.empty()) continue;
    std::vector<std::array<int, 2>> kept;
    Vector3 face = normal(patch.triangles[0]), before = face;
    double sharpest = 0;
    std::array<int, 2> at = patch.rulings[0];
    for (std::size_t k = 0; k < patch.rulings.size(); ++k) {
      const Vector3 after = normal(patch.triangles[k + 1]);
      const double bend = angle_between(before, after);
      if (bend > sharpest) sharpest = bend, at = patch.rulings[k];
      if (angle_between(face, after) > kFlat) kept.push_back(patch.rulings[k]), face = after;
      before = after;
    }
    patch.rulings = std::move(kept);
    if (patch.rulings.empty() && !certificate::check_rulings(strips, p, shape_of(patch)).empty())
      patch.rulings = {at};
  }
}

void append(StripMesh& strips, const StripMesh& other, int component) {
  const int points = static_cast<int>(strips.points.size()), uvs = static_cast<int>(strips.uvs.size());
  const int patches = static_cast<int>(strips.patches.size()),
            arches = static_cast<int>(strips.arches.size());
  strips.points.insert(strips.points.end(), other.points.begin(), other.points.end());
  strips.uvs.insert(strips.uvs.end(), other.uvs.begin(), other.uvs.end());
  for (StripMesh::Patch patch : other.patches) {
    for (auto& t : patch.triangles)
      for (int k = 0; k < 3; ++k) t.v[k] += points, t.vt[k] += uvs;
    for (int& v : patch.boundary) v += points;
    for (int& v : patch.boundary_vt) v += uvs;
    for (int& a : patch.arches) a += arches;
    for (auto& r : patch.rulings) r[0] += points, r[1] += points;
    if (patch.mirror_of >= 0) patch.mirror_of += patches;
    patch.component = component;
    strips.patches.push_back(std::move(patch));
  }
  for (StripMesh::Arch arch : other.arches) {
    for (int& v : arch.vertices) v += points;
    for (int& p : arch.patches)
      if (p >= 0) p += patches;
    strips.arches.push_back(std::move(arch));
  }
}

}  // namespace sheetform
