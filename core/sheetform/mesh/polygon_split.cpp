#include "sheetform/mesh/polygon_split.h"

#include <cmath>

namespace sheetform {
namespace {

double turn(const Vector2& a, const Vector2& b, const Vector2& c) { return cross(b - a, c - b); }

// Twice the vector area (Newell): normal of the plane that fits the polygon, seen counter-clockwise.
Vector3 vector_area(const std::vector<Vector3>& polygon) {
  Vector3 sum = Vector3::Zero();
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    sum += (polygon[i] - polygon[0]).cross(polygon[i + 1] - polygon[0]);
  return sum;
}

std::vector<Vector2> projected(const std::vector<Vector3>& polygon, const Vector3& normal) {
  const Vector3 x = normal.unitOrthogonal(), y = normal.normalized().cross(x);
  std::vector<Vector2> flat;
  for (const Vector3& p : polygon) flat.emplace_back(x.dot(p - polygon[0]), y.dot(p - polygon[0]));
  return flat;
}

// All triangles of the fan of corner 0 are counter-clockwise, within rounding.
bool fan_is_right(const std::vector<Vector2>& flat, double tolerance) {
  for (std::size_t i = 1; i + 1 < flat.size(); ++i)
    if (cross(flat[i] - flat[0], flat[i + 1] - flat[0]) < -tolerance) return false;
  return true;
}

void fan(int sides, std::vector<std::array<int, 3>>& triangles) {
  for (int i = 1; i + 1 < sides; ++i) triangles.push_back({0, i, i + 1});
}

// A ring of the corners that are still there.
struct Ring {
  std::vector<int> next, prev;
  explicit Ring(int n) : next(n), prev(n) {
    for (int i = 0; i < n; ++i) next[i] = (i + 1) % n, prev[i] = (i + n - 1) % n;
  }
  void remove(int i) { next[prev[i]] = next[i], prev[next[i]] = prev[i]; }
};

bool inside(const Vector2& p, const Vector2& a, const Vector2& b, const Vector2& c) {
  return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

bool is_ear(const std::vector<Vector2>& flat, const Ring& ring, int i, std::uint64_t& budget) {
  const int a = ring.prev[i], c = ring.next[i];
  if (turn(flat[a], flat[i], flat[c]) <= 0) return false;
  for (int j = ring.next[c]; j != a; j = ring.next[j]) {
    if (budget == 0) return true;
    --budget;
    const bool twin = flat[j] == flat[a] || flat[j] == flat[i] || flat[j] == flat[c];
    if (!twin && inside(flat[j], flat[a], flat[i], flat[c])) return false;
  }
  return true;
}

void cut_ears(const std::vector<Vector2>& flat, std::uint64_t& budget,
              std::vector<std::array<int, 3>>& triangles) {
  const int n = static_cast<int>(flat.size());
  Ring ring(n);
  int i = 0, misses = 0;
  for (int left = n; left > 3;) {
    // A polygon that crosses itself may have no ear: then any corner has to do.
    if (misses < left && !is_ear(flat, ring, i, budget)) {
      i = ring.next[i], ++misses;
      continue;
    }
    triangles.push_back({ring.prev[i], i, ring.next[i]});
    ring.remove(i);
    i = ring.next[i];
    --left, misses = 0;
  }
  triangles.push_back({ring.prev[i], i, ring.next[i]});
}

}  // namespace

void split_polygon(const std::vector<Vector3>& polygon, std::uint64_t& budget,
                   std::vector<std::array<int, 3>>& triangles) {
  const int sides = static_cast<int>(polygon.size());
  if (sides < 3) return;
  const Vector3 area = vector_area(polygon);
  if (sides == 3 || !(area.norm() > 0) || !std::isfinite(area.norm())) return fan(sides, triangles);
  const std::vector<Vector2> flat = projected(polygon, area);
  if (fan_is_right(flat, 1e-9 * area.norm())) return fan(sides, triangles);
  cut_ears(flat, budget, triangles);
}

}  // namespace sheetform
