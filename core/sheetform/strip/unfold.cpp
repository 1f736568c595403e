#include "sheetform/strip/unfold.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace sheetform {
namespace {

// Third corner from the lengths, on the left of a -> b.
Vector2 apex(const Vector2& a, const Vector2& b, double length, const Vector3& pa, const Vector3& pb,
             const Vector3& pc) {
  const Vector3 ab = pb - pa, ac = pc - pa;
  const double along = ac.dot(ab) / length, off = ab.cross(ac).norm() / length;
  const Vector2 x = (b - a) / (b - a).norm(), y(-x.y(), x.x());
  return a + along * x + off * y;
}

double point_segment2(const Vector2& p, const Vector2& a, const Vector2& b) {
  const Vector2 d = b - a;
  const double t = std::clamp((p - a).dot(d) / std::max(d.squaredNorm(), 1e-300), 0.0, 1.0);
  return (p - a - t * d).squaredNorm();
}

bool segments_cross(const Vector2& a, const Vector2& b, const Vector2& c, const Vector2& d) {
  const double u = cross(b - a, c - a), v = cross(b - a, d - a), w = cross(d - c, a - c),
               z = cross(d - c, b - c);
  return ((u > 0) != (v > 0)) && ((w > 0) != (z > 0));
}

bool too_close(const Vector2& a, const Vector2& b, const Vector2& c, const Vector2& d, double gap) {
  for (int k = 0; k < 2; ++k)
    if (std::max(a[k], b[k]) + gap < std::min(c[k], d[k]) ||
        std::max(c[k], d[k]) + gap < std::min(a[k], b[k]))
      return false;
  if (segments_cross(a, b, c, d)) return true;
  const double g2 = gap * gap;
  return point_segment2(a, c, d) < g2 || point_segment2(b, c, d) < g2 || point_segment2(c, a, b) < g2 ||
         point_segment2(d, a, b) < g2;
}

}  // namespace

std::vector<Vector2> unfold(const std::vector<Vector3>& points,
                            const std::vector<std::array<int, 3>>& triangles) {
  std::vector<Vector2> flat(points.size(), Vector2::Zero());
  if (triangles.empty()) return flat;
  std::map<std::pair<int, int>, int> side;  // directed edge -> triangle on its left
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t)
    for (int k = 0; k < 3; ++k) side[{triangles[t][k], triangles[t][(k + 1) % 3]}] = t;
  const auto& first = triangles[0];
  const double length = (points[first[1]] - points[first[0]]).norm();
  flat[first[1]] = {length, 0};
  flat[first[2]] =
      apex(flat[first[0]], flat[first[1]], length, points[first[0]], points[first[1]], points[first[2]]);
  std::vector<char> placed(triangles.size(), 0);
  std::vector<int> stack{0};
  placed[0] = 1;
  while (!stack.empty()) {
    const auto t = triangles[stack.back()];
    stack.pop_back();
    for (int k = 0; k < 3; ++k) {
      const auto it = side.find({t[(k + 1) % 3], t[k]});
      if (it == side.end() || placed[it->second]) continue;
      placed[it->second] = 1;
      const auto& other = triangles[it->second];
      const int a = t[(k + 1) % 3], b = t[k];
      const int c = other[0] != a && other[0] != b   ? other[0]
                    : other[1] != a && other[1] != b ? other[1]
                                                     : other[2];
      flat[c] = apex(flat[a], flat[b], (points[b] - points[a]).norm(), points[a], points[b], points[c]);
      stack.push_back(it->second);
    }
  }
  return flat;
}

bool simple_outline(const std::vector<Vector2>& outline, double gap) {
  const int n = static_cast<int>(outline.size());
  for (int i = 0; i < n; ++i) {
    const Vector2 &p = outline[(i + n - 1) % n], &q = outline[i], &r = outline[(i + 1) % n];
    // Neighbours that fold back: an angle of nearly zero.
    const Vector2 in = p - q, out = r - q;
    if (in.dot(out) > 0 && std::abs(cross(in, out)) < 1e-6 * in.norm() * out.norm()) return false;
    for (int j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;
      if (too_close(q, r, outline[j], outline[(j + 1) % n], gap)) return false;
    }
  }
  return true;
}

}  // namespace sheetform
