#include "sheetform/strip/outline.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace sheetform {

double signed_area(const std::vector<Vector2>& p) {
  double twice = 0;
  for (std::size_t i = 1; i + 1 < p.size(); ++i) twice += cross(p[i] - p[0], p[i + 1] - p[0]);
  return twice / 2;
}

bool contains(const std::vector<Vector2>& p, const Vector2& q) {
  bool in = false;
  for (std::size_t i = 0, j = p.size() - 1; i < p.size(); j = i++) {
    if ((p[i].y() > q.y()) == (p[j].y() > q.y())) continue;
    const double x = p[j].x() + (q.y() - p[j].y()) / (p[i].y() - p[j].y()) * (p[i].x() - p[j].x());
    if (q.x() < x) in = !in;
  }
  return in;
}

double point_segment_distance(const Vector2& q, const Vector2& a, const Vector2& b) {
  const Vector2 d = b - a;
  const double n = d.squaredNorm();
  const double t = n > 0 ? std::clamp((q - a).dot(d) / n, 0.0, 1.0) : 0.0;
  return (a + t * d - q).norm();
}

double segment_distance(const Vector2& a, const Vector2& b, const Vector2& c, const Vector2& d) {
  const double s1 = cross(b - a, c - a), s2 = cross(b - a, d - a), s3 = cross(d - c, a - c),
               s4 = cross(d - c, b - c);
  if (((s1 > 0) != (s2 > 0)) && ((s3 > 0) != (s4 > 0)) && s1 != 0 && s2 != 0 && s3 != 0 && s4 != 0) return 0;
  return std::min({point_segment_distance(a, c, d), point_segment_distance(b, c, d),
                   point_segment_distance(c, a, b), point_segment_distance(d, a, b)});
}

Contact self_contact(const std::vector<Vector2>& p, double tolerance) {
  const int n = static_cast<int>(p.size());
  struct Span {
    Vector2 low, high;
  };
  std::vector<Span> span;
  for (int i = 0; i < n; ++i) {
    const Vector2 &a = p[i], &b = p[(i + 1) % n];
    span.push_back({a.cwiseMin(b).array() - tolerance / 2, a.cwiseMax(b).array() + tolerance / 2});
  }
  std::vector<int> order(n), active;
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return span[a].low.x() < span[b].low.x(); });
  Contact worst{-1, -1, std::numeric_limits<double>::infinity()};
  for (int i : order) {
    std::size_t kept = 0;
    for (int j : active) {
      if (span[j].high.x() < span[i].low.x()) continue;
      active[kept++] = j;
      if (span[j].high.y() < span[i].low.y() || span[j].low.y() > span[i].high.y()) continue;
      if ((i + 1) % n == j || (j + 1) % n == i) continue;
      const double d = segment_distance(p[i], p[(i + 1) % n], p[j], p[(j + 1) % n]);
      if (d <= tolerance && d < worst.distance) worst = {std::min(i, j), std::max(i, j), d};
    }
    active.resize(kept);
    active.push_back(i);
  }
  return worst;
}

}  // namespace sheetform
