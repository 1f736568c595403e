#include "sheetform/blueprint/page_layout.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace sheetform {
namespace {

// Andrew's monotone chain, counter-clockwise.
Polygon convex_hull(Polygon points) {
  std::sort(points.begin(), points.end(), [](const Vector2& a, const Vector2& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  Polygon hull;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t base = hull.size();
    for (const Vector2& p : points) {
      while (hull.size() >= base + 2 && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0)
        hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

struct Box {
  Vector2 low = Vector2::Constant(std::numeric_limits<double>::infinity());
  Vector2 high = Vector2::Constant(-std::numeric_limits<double>::infinity());
  Vector2 size() const { return high - low; }
};

Box box_of(const Polygon& points, const Placement& turn) {
  Box box;
  for (const Vector2& p : points) {
    const Vector2 q = turn(p);
    box.low = box.low.cwiseMin(q), box.high = box.high.cwiseMax(q);
  }
  return box;
}

// Widest part, and a page that all of them fill about as high as wide.
double page_width(const std::vector<Box>& boxes, double gap) {
  double widest = 0, area = 0;
  for (const Box& b : boxes) {
    widest = std::max(widest, b.size().x());
    area += (b.size().x() + gap) * (b.size().y() + gap);
  }
  return std::max(widest, 1.15 * std::sqrt(area)) + 2 * gap;
}

}  // namespace

Placement flat_turn(const Polygon& points) {
  const Polygon hull = convex_hull(points);
  Placement best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vector2 d = hull[(i + 1) % hull.size()] - hull[i];
    const double length = d.norm();
    if (!(length > 0)) continue;
    const Placement turn{d.x() / length, -d.y() / length, Vector2::Zero()};
    const Vector2 size = box_of(hull, turn).size();
    if (size.prod() >= least * (1 - 1e-12)) continue;
    least = size.prod();
    best = size.x() >= size.y() ? turn : Placement{-turn.sin, turn.cos, Vector2::Zero()};
  }
  return best;
}

PageLayout arrange_on_one_page(const std::vector<Polygon>& outlines, double gap) {
  PageLayout page;
  std::vector<Box> boxes;
  for (const Polygon& outline : outlines) {
    page.placements.push_back(flat_turn(outline));
    boxes.push_back(box_of(outline, page.placements.back()));
  }
  std::vector<int> order(outlines.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return boxes[a].size().y() > boxes[b].size().y(); });
  page.width = page_width(boxes, gap);
  double x = gap, y = gap, shelf = 0;
  for (int i : order) {
    const Vector2 size = boxes[i].size();
    if (x > gap && x + size.x() + gap > page.width) x = gap, y += shelf + gap, shelf = 0;
    page.placements[i].shift = Vector2(x, y) - boxes[i].low;
    x += size.x() + gap;
    shelf = std::max(shelf, size.y());
  }
  page.height = y + shelf + gap;
  return page;
}

}  // namespace sheetform
