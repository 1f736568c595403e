#include "sheetform/mesh/surface_curve.h"

#include <algorithm>

namespace sheetform {
namespace {

constexpr int kDeepest = 16;  // halvings of one segment: where the surface jumps, they never get short

class Curve {
 public:
  Curve(const ClosestPointTree& tree, double spacing) : tree_(tree), spacing_(spacing) {}

  void go_to(const Vector3& p) {
    const CurvePoint end = projected(p);
    if (!points_.empty()) fill(points_.back(), end, 0);
    points_.push_back(end);
  }
  std::vector<CurvePoint> take() { return std::move(points_); }

 private:
  CurvePoint projected(const Vector3& p) const {
    const ClosestPoint hit = tree_.closest(p);
    return {hit.point, hit.face};
  }
  void fill(const CurvePoint& a, const CurvePoint& b, int depth) {
    const double length = (b.point - a.point).norm();
    if (length <= spacing_ || depth == kDeepest) return;
    const CurvePoint middle = projected((a.point + b.point) / 2);
    // Across a gap or a cave the middle falls on one of the ends: nothing lies between.
    const double nearer = std::min((middle.point - a.point).norm(), (middle.point - b.point).norm());
    if (nearer < 0.05 * length) return;
    fill(a, middle, depth + 1);
    points_.push_back(middle);
    fill(middle, b, depth + 1);
  }

  const ClosestPointTree& tree_;
  const double spacing_;
  std::vector<CurvePoint> points_;
};

}  // namespace

std::vector<CurvePoint> curve_on_surface(const ClosestPointTree& tree, const std::vector<Vector3>& polyline,
                                         bool closed, double spacing) {
  Curve curve(tree, spacing);
  for (const Vector3& p : polyline) curve.go_to(p);
  if (closed && !polyline.empty()) curve.go_to(polyline.front());
  return curve.take();
}

ClosestPointTree curve_tree(const std::vector<CurvePoint>& curve) {
  std::vector<Vector3> points;
  for (const CurvePoint& p : curve) points.push_back(p.point);
  std::vector<std::array<int, 3>> segments;
  for (int i = 0; i + 1 < static_cast<int>(points.size()); ++i) segments.push_back({i, i + 1, i + 1});
  if (points.size() == 1) segments.push_back({0, 0, 0});
  return {points, segments};
}

}  // namespace sheetform
