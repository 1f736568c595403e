#include "sheetform/strip/height_bound.h"

#include <algorithm>
#include <limits>

namespace sheetform {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1e-12;  // of the diagonal
constexpr double kThin = 1e-6;       // sine at a corner below which a triangle has no normal to speak of
constexpr std::size_t kMost = 256;   // faces over one triangle; beyond it a split costs less

using Triangle2 = std::array<Vector2, 3>;

double cross(const Vector2& a, const Vector2& b) { return a.x() * b.y() - a.y() * b.x(); }

// All of the triangle lies more than `gap` on one side of the line through a and b, or the segment so far
// outside of one of the triangle's sides. (No other line can part a segment from a triangle.)
bool apart(const Triangle2& t, const Vector2& a, const Vector2& b, double gap) {
  for (int k = 0; k < 3; ++k) {
    const Vector2 side = t[(k + 1) % 3] - t[k];
    const double outside = -gap * side.norm();
    if (cross(side, a - t[k]) < outside && cross(side, b - t[k]) < outside) return true;
  }
  const Vector2 along = b - a;
  const double least = gap * along.norm();
  double lo = kUnknown, hi = -kUnknown;
  for (const Vector2& p : t) {
    const double c = cross(along, p - a);
    lo = std::min(lo, c), hi = std::max(hi, c);
  }
  return lo > least || hi < -least;
}

// How often the face covers the point, and with which side up: 1, -1 or 0; 2 where that cannot be told.
int cover(const Triangle2& face, const Vector2& point, double gap) {
  double lo = kUnknown, hi = -kUnknown;
  for (int k = 0; k < 3; ++k) {
    const Vector2 side = face[(k + 1) % 3] - face[k];
    const double c = cross(side, point - face[k]), least = gap * side.norm();
    if (std::abs(c) <= least) {
      lo = std::min(lo, 0.0), hi = std::max(hi, 0.0);
    } else {
      lo = std::min(lo, c), hi = std::max(hi, c);
    }
  }
  if (lo > 0) return 1;
  if (hi < 0) return -1;
  return lo < 0 && hi > 0 ? 0 : 2;
}

// The largest |z| of the part of the face over the triangle, which turns to the left; 0 where there is none.
double height_over(const Triangle2& t, const std::array<Vector3, 3>& face) {
  std::array<std::array<Vector3, 9>, 2> part;  // three cuts: half as many corners again each, at worst
  std::size_t n = 3;
  std::copy(face.begin(), face.end(), part[0].begin());
  for (int k = 0; k < 3; ++k) {
    const auto& whole = part[k % 2];
    auto& left = part[(k + 1) % 2];
    const Vector2 side = t[(k + 1) % 3] - t[k];
    const auto inside = [&](const Vector3& p) { return cross(side, p.head<2>() - t[k]); };
    std::size_t kept = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Vector3 &p = whole[i], &q = whole[(i + 1) % n];
      const double a = inside(p), b = inside(q);
      if (a >= 0) left[kept++] = p;
      if ((a >= 0) != (b >= 0)) left[kept++] = p + a / (a - b) * (q - p);
    }
    n = kept;
  }
  double highest = 0;
  for (std::size_t i = 0; i < n; ++i) highest = std::max(highest, std::abs(part[1][i].z()));
  return highest;
}

}  // namespace

HeightBound::HeightBound(const std::vector<Vector3>& points, const std::vector<std::array<int, 3>>& faces,
                         double diagonal)
    : points_(points), faces_(faces), rounding_(kRounding * diagonal), beside_(faces.size(), {-1, -1, -1}) {
  const auto from = [&](int side) { return faces[side / 3][side % 3]; };
  const auto to = [&](int side) { return faces[side / 3][(side % 3 + 1) % 3]; };
  // All sides by their lower end.
  const auto n = static_cast<int>(3 * faces.size());
  std::vector<int> begin(points.size() + 1, 0), sides(n);
  for (int s = 0; s < n; ++s) ++begin[std::min(from(s), to(s)) + 1];
  for (std::size_t v = 0; v < points.size(); ++v) begin[v + 1] += begin[v];
  std::vector<int> end(begin.begin(), begin.end() - 1);
  for (int s = 0; s < n; ++s) sides[end[std::min(from(s), to(s))]++] = s;
  for (int s = 0; s < n; ++s) {
    const int lower = std::min(from(s), to(s));
    int count = 0, other = -1;
    for (int i = begin[lower]; i < begin[lower + 1]; ++i) {
      if (from(sides[i]) + to(sides[i]) != from(s) + to(s)) continue;  // the lower end is the same
      ++count;
      if (from(sides[i]) == to(s)) other = sides[i] / 3;
    }
    if (count == 2 && other >= 0) beside_[s / 3][s % 3] = other;
  }
}

// Faces are taken from one to the next across the sides that lie over the triangle. When there are no more,
// no side at which the faces taken end lies over it, so faces turned up less faces turned down are as many at
// all of its points (the winding number of where they end). Where that is not 0 at its middle, all of it is
// covered.
double HeightBound::operator()(const std::array<Vector3, 3>& triangle, const std::array<int, 3>& near,
                               double limit) const {
  const Vector3 x = (triangle[1] - triangle[0]).stableNormalized();
  const Vector3 across = x.cross(triangle[2] - triangle[0]), z = across.stableNormalized(), y = z.cross(x);
  if (!(across.norm() > kThin * (triangle[2] - triangle[0]).norm())) return kUnknown;
  const auto flat = [&](const Vector3& p) {
    const Vector3 d = p - triangle[0];
    return Vector2(d.dot(x), d.dot(y));
  };
  const Triangle2 t{flat(triangle[0]), flat(triangle[1]), flat(triangle[2])};
  // Near the middle, but hardly ever on a side of a regular mesh.
  const Vector2 middle = 0.34519 * t[0] + 0.33173 * t[1] + 0.32308 * t[2];
  std::vector<int> over;
  const auto take = [&](int f) {
    if (std::find(over.begin(), over.end(), f) == over.end()) over.push_back(f);
  };
  for (int f : near) take(f);
  double highest = 0;
  int covered = 0;
  for (std::size_t i = 0; i < over.size(); ++i) {
    const int f = over[i];
    Triangle2 face;
    std::array<Vector3, 3> risen;
    double corner = 0;
    for (int k = 0; k < 3; ++k) {
      const Vector3& p = points_[faces_[f][k]];
      face[k] = flat(p);
      risen[k] << face[k], (p - triangle[0]).dot(z);
      corner = std::max(corner, std::abs(risen[k].z()));
    }
    if (corner > highest) highest = std::max(highest, height_over(t, risen));
    if (!(highest <= limit)) return kUnknown;
    for (int k = 0; k < 3; ++k) {
      if (apart(t, face[k], face[(k + 1) % 3], rounding_)) continue;
      if (beside_[f][k] < 0 || over.size() >= kMost) return kUnknown;
      take(beside_[f][k]);
    }
    const int c = cover(face, middle, rounding_);
    if (c == 2) return kUnknown;
    covered += c;
  }
  return covered != 0 ? highest : kUnknown;
}

}  // namespace sheetform
