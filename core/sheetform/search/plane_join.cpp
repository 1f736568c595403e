#include "sheetform/search/plane_join.h"

#include <algorithm>
#include <cmath>

namespace sheetform {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr double kClear = 1e-6;  // of the segment: height of all other points over it

bool glued_to_itself(const PatchLayout& layout, const Patch& patch) {
  return std::any_of(patch.boundary.begin(), patch.boundary.end(), [&](const ArchUse& use) {
    return layout.arches[use.arch].left == layout.arches[use.arch].right;
  });
}

// The end of the outline's stretch from point i on: a node, or a point far enough to tell a direction.
Vector2 ahead(const PatchPolygon& polygon, int i, int step, double reach) {
  const int n = polygon.size();
  int k = i;
  do k = (k + step + n) % n;
  while (k != i && !polygon.node[k] && (polygon.uv[k] - polygon.uv[i]).norm() < 0.9 * reach);
  return polygon.uv[k] - polygon.uv[i];
}

// Turning of the joined outline at an end of the segment: the patch and its image meet there.
bool turns(const Vector2& out, const Vector2& segment, double limit) {
  const double inside = std::abs(std::atan2(cross(segment, out), segment.dot(out)));
  return std::abs(2 * inside - 180 * kDegree) > limit * kDegree;
}

}  // namespace

bool fits_its_image(const SearchSurface& surface, const PatchLayout& layout, const Patch& patch,
                    const PatchPolygon& polygon, const std::vector<int>& corners,
                    const EvaluationParams& params) {
  std::vector<int> straight;  // uses
  for (int k = 0; k < static_cast<int>(patch.boundary.size()); ++k)
    if (surface.is_straight(layout.arches[patch.boundary[k].arch])) straight.push_back(k);
  if (straight.empty()) return true;
  if (straight.size() > 1 || glued_to_itself(layout, patch)) return false;
  const int uses = static_cast<int>(patch.boundary.size());
  const auto arch_of = [&](int use) -> const Arch& {
    return layout.arches[patch.boundary[(use + uses) % uses].arch];
  };
  if (surface.on_plane(arch_of(straight[0] - 1)) || surface.on_plane(arch_of(straight[0] + 1))) return false;
  const int n = polygon.size();
  int from = 0;
  while (from < n && polygon.origin[from].use != straight[0]) ++from;
  if (from == n) return false;
  const int to = (from + 1) % n;
  const Vector2 &a = polygon.uv[from], &b = polygon.uv[to];
  for (int i = 0; i < n; ++i) {
    if (i == from || i == to) continue;
    const int use = polygon.origin[i].use;
    const Arch& arch = arch_of(use);
    const int sample = polygon.origin[i].sample;
    const bool on_plane = surface.on_plane(arch) ||
                          (sample == 0 && surface.on_plane(arch.vertices.front())) ||
                          (polygon.node[i] && sample != 0 && surface.on_plane(arch.vertices.back()));
    // Along another arch on the plane the joined patch is glued to itself; it must not touch itself in a
    // point.
    const bool seam =
        surface.on_plane(arch) || surface.on_plane(arch_of(polygon.origin[(i + n - 1) % n].use));
    if (on_plane && !(seam && params.self_seams)) return false;
    if (cross(b - a, polygon.uv[i] - a) < kClear * (b - a).squaredNorm()) return false;
  }
  int sides = 0;
  for (int corner : corners) sides += corner == from || corner == to ? 0 : 2;
  const bool every = !params.t_junctions;
  sides += every || turns(ahead(polygon, from, -1, params.corner_reach), b - a, params.corner_turn);
  sides += every || turns(ahead(polygon, to, 1, params.corner_reach), a - b, params.corner_turn);
  return sides <= params.max_sides;
}

}  // namespace sheetform
