#include "sheetform/blueprint/polygon_tools.h"

#include <algorithm>
#include <clipper.hpp>
#include <cmath>
#include <queue>

#include "sheetform/strip/outline.h"

namespace sheetform {
namespace {

constexpr double kGrid = 1e5;  // Clipper's integers in a millimetre

ClipperLib::Paths to_clipper(const Polygons& polygons) {
  ClipperLib::Paths paths;
  for (const Polygon& p : polygons) {
    ClipperLib::Path path;
    for (const Vector2& q : p) path.emplace_back(std::llround(q.x() * kGrid), std::llround(q.y() * kGrid));
    paths.push_back(std::move(path));
  }
  return paths;
}

Polygons from_clipper(const ClipperLib::Paths& paths) {
  Polygons out;
  for (const ClipperLib::Path& path : paths) {
    Polygon p;
    for (const ClipperLib::IntPoint& q : path)
      p.emplace_back(static_cast<double>(q.X) / kGrid, static_cast<double>(q.Y) / kGrid);
    out.push_back(std::move(p));
  }
  return out;
}

Polygons run(ClipperLib::ClipType type, const Polygons& subject, const Polygons& clip) {
  ClipperLib::Clipper clipper;
  clipper.StrictlySimple(true);
  clipper.AddPaths(to_clipper(subject), ClipperLib::ptSubject, true);
  clipper.AddPaths(to_clipper(clip), ClipperLib::ptClip, true);
  ClipperLib::Paths out;
  clipper.Execute(type, out, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
  return from_clipper(out);
}

// Positive inside.
double signed_distance(const Polygon& p, const Vector2& q) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < p.size(); ++i)
    nearest = std::min(nearest, point_segment_distance(q, p[i], p[(i + 1) % p.size()]));
  return contains(p, q) ? nearest : -nearest;
}

}  // namespace

Bounds bounds_of(const Polygon& polygon) {
  Bounds b{polygon.front(), polygon.front()};
  for (const Vector2& p : polygon) b.low = b.low.cwiseMin(p), b.high = b.high.cwiseMax(p);
  return b;
}

Polygons unite(const Polygons& polygons) { return run(ClipperLib::ctUnion, polygons, {}); }
Polygons subtract(const Polygons& from, const Polygons& what) {
  return run(ClipperLib::ctDifference, from, what);
}
Polygons intersect(const Polygons& a, const Polygons& b) { return run(ClipperLib::ctIntersection, a, b); }

Polygons offset(const Polygons& polygons, double distance, Corner corner) {
  ClipperLib::ClipperOffset clipper(3.0, 0.005 * kGrid);  // mitre limit; arcs within 5 micrometres
  clipper.AddPaths(to_clipper(polygons), corner == Corner::kRound ? ClipperLib::jtRound : ClipperLib::jtMiter,
                   ClipperLib::etClosedPolygon);
  ClipperLib::Paths out;
  clipper.Execute(out, distance * kGrid);
  return from_clipper(out);
}

double area_of(const Polygons& polygons) {
  double sum = 0;
  for (const Polygon& p : polygons) sum += signed_area(p);
  return sum;
}

Pole pole_of_inaccessibility(const Polygon& polygon, double precision) {
  struct Cell {
    Vector2 center;
    double half, distance;
    double potential() const { return distance + half * std::sqrt(2.0); }
    bool operator<(const Cell& other) const { return potential() < other.potential(); }
  };
  const Bounds box = bounds_of(polygon);
  const double half = std::max(box.size().minCoeff() / 2, box.size().maxCoeff() / 64);
  std::priority_queue<Cell> queue;
  const auto cell = [&](const Vector2& center, double h) {
    return Cell{center, h, signed_distance(polygon, center)};
  };
  Cell best = cell((box.low + box.high) / 2, 0);
  for (double x = box.low.x() + half; x - half < box.high.x(); x += 2 * half)
    for (double y = box.low.y() + half; y - half < box.high.y(); y += 2 * half)
      queue.push(cell({x, y}, half));
  while (!queue.empty()) {
    const Cell top = queue.top();
    queue.pop();
    if (top.distance > best.distance) best = top;
    if (top.potential() - best.distance <= precision) break;
    for (int k = 0; k < 4; ++k) {
      const double h = top.half / 2;
      queue.push(cell(top.center + Vector2(k & 1 ? h : -h, k & 2 ? h : -h), h));
    }
  }
  return {best.center, std::max(0.0, best.distance)};
}

Polygon TurnedBox::corners() const {
  const Vector2 u = half_width * axis, v = half_height * up();
  return {center - u - v, center + u - v, center + u + v, center - u + v};
}

bool overlap(const TurnedBox& a, const TurnedBox& b) {
  const Polygon p = a.corners(), q = b.corners();
  for (const Vector2& axis : {a.axis, a.up(), b.axis, b.up()}) {
    double p_low = 1e300, p_high = -1e300, q_low = 1e300, q_high = -1e300;
    for (int k = 0; k < 4; ++k) {
      p_low = std::min(p_low, axis.dot(p[k])), p_high = std::max(p_high, axis.dot(p[k]));
      q_low = std::min(q_low, axis.dot(q[k])), q_high = std::max(q_high, axis.dot(q[k]));
    }
    if (p_high < q_low || q_high < p_low) return false;
  }
  return true;
}

std::array<double, 2> stretch_in(const TurnedBox& box, const Vector2& a, const Vector2& b) {
  const Vector2 from(box.axis.dot(a - box.center), box.up().dot(a - box.center)),
      d(box.axis.dot(b - a), box.up().dot(b - a));
  double enter = 0, leave = 1;
  const double half[2] = {box.half_width, box.half_height};
  for (int k = 0; k < 2; ++k) {
    if (d[k] == 0) {
      if (std::abs(from[k]) > half[k]) return {1, 0};
      continue;
    }
    const double t0 = (-half[k] - from[k]) / d[k], t1 = (half[k] - from[k]) / d[k];
    enter = std::max(enter, std::min(t0, t1)), leave = std::min(leave, std::max(t0, t1));
  }
  return {enter, leave};
}

bool meets(const TurnedBox& box, const Vector2& a, const Vector2& b) {
  const auto [enter, leave] = stretch_in(box, a, b);
  return enter <= leave;
}

Inside::Inside(const Polygon& polygon) : polygon_(polygon), bounds_(bounds_of(polygon)) {
  const Vector2 size = bounds_.size();
  cell_ = std::max(size.maxCoeff() / 64, 1e-9);
  columns_ = static_cast<int>(size.x() / cell_) + 1, rows_ = static_cast<int>(size.y() / cell_) + 1;
  cells_.resize(static_cast<std::size_t>(columns_) * rows_);
  const auto place = [&](double x, int n) { return std::clamp(static_cast<int>(x / cell_), 0, n - 1); };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Bounds e = bounds_of({polygon[i], polygon[(i + 1) % polygon.size()]});
    for (int y = place(e.low.y() - bounds_.low.y(), rows_); y <= place(e.high.y() - bounds_.low.y(), rows_);
         ++y)
      for (int x = place(e.low.x() - bounds_.low.x(), columns_);
           x <= place(e.high.x() - bounds_.low.x(), columns_); ++x)
        cells_[static_cast<std::size_t>(y) * columns_ + x].push_back(static_cast<int>(i));
  }
}

template <class Visit>
bool Inside::any_edge(const Bounds& where, const Visit& visit) const {
  const auto place = [&](double x, int n) {
    return std::clamp(static_cast<int>(std::floor(x / cell_)), 0, n - 1);
  };
  for (int y = place(where.low.y() - bounds_.low.y(), rows_);
       y <= place(where.high.y() - bounds_.low.y(), rows_); ++y)
    for (int x = place(where.low.x() - bounds_.low.x(), columns_);
         x <= place(where.high.x() - bounds_.low.x(), columns_); ++x)
      for (int i : cells_[static_cast<std::size_t>(y) * columns_ + x])
        if (visit(polygon_[i], polygon_[(i + 1) % polygon_.size()])) return true;
  return false;
}

bool Inside::holds(const Vector2& point) const {
  if ((point.array() < bounds_.low.array()).any() || (point.array() > bounds_.high.array()).any())
    return false;
  return contains(polygon_, point);
}

bool Inside::holds(const TurnedBox& box) const {
  const Bounds b = bounds_of(box.corners());
  if ((b.low.array() < bounds_.low.array()).any() || (b.high.array() > bounds_.high.array()).any())
    return false;
  return !any_edge(b, [&](const Vector2& p, const Vector2& q) { return meets(box, p, q); }) &&
         contains(polygon_, box.center);
}

bool Inside::crossed(const Vector2& a, const Vector2& b) const {
  return any_edge(bounds_of({a, b}),
                  [&](const Vector2& p, const Vector2& q) { return segment_distance(a, b, p, q) == 0; });
}

}  // namespace sheetform
