#include "sheetform/strip/height_bound.h"

#include <algorithm>
#include <limits>

#include "sheetform/strip/topology.h"

namespace sheetform {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1e-12;  // of the diagonal
constexpr double kThin = 1e-6;       // sine at a corner below which a triangle has no normal to speak of
// Faces over one triangle, as their areas say, beyond which a split costs less than to look at all of them;
// and how many are looked at before it is given up.
constexpr double kMany = 32;
constexpr std::size_t kMost = 128;

// Not below the length.
double length_or_more(const Vector2& v) { return std::abs(v.x()) + std::abs(v.y()); }

// A triangle in its own plane, to which faces are projected.
class Shadowed {
 public:
  Shadowed(const std::array<Vector3, 3>& triangle, double rounding)
      : origin_(triangle[0]), rounding_(rounding) {
    x_ = (triangle[1] - triangle[0]).stableNormalized();
    const Vector3 across = x_.cross(triangle[2] - triangle[0]);
    z_ = across.stableNormalized();
    y_ = z_.cross(x_);
    thin_ = !(across.norm() > kThin * (triangle[2] - triangle[0]).norm());
    for (int k = 0; k < 3; ++k) corners_[k] = projected(triangle[k]).head<2>();
    for (int k = 0; k < 3; ++k) {
      sides_[k] = corners_[(k + 1) % 3] - corners_[k];
      outside_[k] = -rounding_ * length_or_more(sides_[k]);
    }
  }
  double area() const { return cross(sides_[0], sides_[1]) / 2; }
  bool thin() const { return thin_; }  // so much that it has no plane
  // A little beside its middle: that hardly ever lies on a side of a regular mesh.
  Vector2 middle() const { return 0.34519 * corners_[0] + 0.33173 * corners_[1] + 0.32308 * corners_[2]; }

  // A face: the third coordinate is its height; `inside` by corner and side of the triangle, positive inside.
  struct Face {
    std::array<Vector3, 3> corners;
    std::array<std::array<double, 3>, 3> inside;
    double height = 0;  // of the highest corner, or lowest
  };
  Face face(const Vector3& a, const Vector3& b, const Vector3& c) const {
    Face f{{projected(a), projected(b), projected(c)}, {}};
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) f.inside[i][k] = inside(f.corners[i], k);
      f.height = std::max(f.height, std::abs(f.corners[i].z()));
    }
    return f;
  }
  bool beside(const Face& f) const {
    for (int k = 0; k < 3; ++k)
      if (out(f, 0, k) && out(f, 1, k) && out(f, 2, k)) return true;
    return false;
  }
  // Whether side i of the face, to corner i + 1, is known not to lie over the triangle: a side of the
  // triangle or its own line parts the two. (No other line can part a segment from a triangle alone.)
  bool beside(const Face& f, int i) const {
    const int j = (i + 1) % 3;
    for (int k = 0; k < 3; ++k)
      if (out(f, i, k) && out(f, j, k)) return true;
    const Vector2 a = f.corners[i].head<2>(), along = f.corners[j].head<2>() - a;
    const double least = rounding_ * length_or_more(along);
    const double p = cross(along, corners_[0] - a), q = cross(along, corners_[1] - a),
                 r = cross(along, corners_[2] - a);
    return (p > least && q > least && r > least) || (p < -least && q < -least && r < -least);
  }

  // How often the face covers the point, and with which side up: 1, -1 or 0; 2 where that cannot be told.
  int covers(const Face& f, const Vector2& point) const {
    bool left = true, right = true, near = false;
    for (int i = 0; i < 3; ++i) {
      const Vector2 a = f.corners[i].head<2>(), along = f.corners[(i + 1) % 3].head<2>() - a;
      const double c = cross(along, point - a), least = rounding_ * length_or_more(along);
      left = left && c > -least, right = right && c < least, near = near || std::abs(c) <= least;
    }
    if (!left && !right) return 0;
    return near ? 2 : left ? 1 : -1;
  }

  // The largest |height| of the part of the face over the triangle; 0 where there is none.
  double height_over(const Face& f) const {
    std::array<std::array<Vector3, 9>, 2> part;  // three cuts: half as many corners again each, at worst
    std::size_t n = 3;
    std::copy(f.corners.begin(), f.corners.end(), part[0].begin());
    for (int k = 0; k < 3; ++k) {
      const auto& whole = part[k % 2];
      auto& left = part[(k + 1) % 2];
      std::size_t kept = 0;
      for (std::size_t i = 0; i < n; ++i) {
        const Vector3 &p = whole[i], &q = whole[(i + 1) % n];
        const double a = inside(p, k), b = inside(q, k);
        if (a >= 0) left[kept++] = p;
        if ((a >= 0) != (b >= 0)) left[kept++] = p + a / (a - b) * (q - p);
      }
      n = kept;
    }
    double highest = 0;
    for (std::size_t i = 0; i < n; ++i) highest = std::max(highest, std::abs(part[1][i].z()));
    return highest;
  }

 private:
  Vector3 projected(const Vector3& p) const {
    const Vector3 d = p - origin_;
    return {d.dot(x_), d.dot(y_), d.dot(z_)};
  }
  double inside(const Vector3& p, int side) const {
    return cross(sides_[side], p.head<2>() - corners_[side]);
  }
  bool out(const Face& f, int corner, int side) const { return f.inside[corner][side] < outside_[side]; }

  Vector3 origin_, x_, y_, z_;
  double rounding_;
  bool thin_;
  std::array<Vector2, 3> corners_, sides_;
  std::array<double, 3> outside_;
};

}  // namespace

HeightBound::HeightBound(const std::vector<Vector3>& points, const std::vector<std::array<int, 3>>& faces,
                         double diagonal, const RunContext& context)
    : points_(points), faces_(faces), rounding_(kRounding * diagonal), beside_(faces.size(), {-1, -1, -1}) {
  const EdgeTable table(faces, context);
  const auto side = [&](const EdgeTable::Use& u) -> int& {
    const auto& t = faces[u.face];
    return beside_[u.face][t[0] == u.a ? 0 : t[1] == u.a ? 1 : 2];
  };
  for (const EdgeTable::Edge& e : table.edges) {
    if (e.count != 2 || table.use(e, 0).a == table.use(e, 1).a) continue;
    side(table.use(e, 0)) = table.use(e, 1).face;
    side(table.use(e, 1)) = table.use(e, 0).face;
  }
}

double HeightBound::area_of(int face) const {
  const auto& t = faces_[face];
  return (points_[t[1]] - points_[t[0]]).cross(points_[t[2]] - points_[t[0]]).norm() / 2;
}

// Faces are taken from one to the next across the sides that lie over the triangle. When there are no more,
// no side at which the faces taken end lies over it, so faces turned up less faces turned down are as many at
// all of its points (the winding number of where they end). Where that is not 0 at its middle, all of it is
// covered.
double HeightBound::operator()(const std::array<Vector3, 3>& triangle, const std::array<int, 3>& near,
                               double limit) const {
  const Shadowed t(triangle, rounding_);
  if (t.thin()) return kUnknown;
  const Vector2 middle = t.middle();
  std::vector<int> over;
  const auto take = [&](int f) {
    if (std::find(over.begin(), over.end(), f) == over.end()) over.push_back(f);
  };
  double widest = 0;
  for (int f : near) take(f), widest = std::max(widest, area_of(f));
  if (t.area() > kMany * widest) return kUnknown;
  double highest = 0;
  int covered = 0;
  for (std::size_t i = 0; i < over.size(); ++i) {
    const auto& corners = faces_[over[i]];
    const auto& beside = beside_[over[i]];
    const Shadowed::Face face = t.face(points_[corners[0]], points_[corners[1]], points_[corners[2]]);
    if (t.beside(face)) continue;
    if (face.height > highest) highest = std::max(highest, t.height_over(face));
    if (!(highest <= limit)) return kUnknown;
    for (int k = 0; k < 3; ++k) {
      if (t.beside(face, k)) continue;
      if (beside[k] < 0 || over.size() >= kMost) return kUnknown;
      take(beside[k]);
    }
    const int c = t.covers(face, middle);
    if (c == 2) return kUnknown;
    covered += c;
  }
  return covered != 0 ? highest : kUnknown;
}

}  // namespace sheetform
