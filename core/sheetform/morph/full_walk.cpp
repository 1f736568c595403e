#include "sheetform/morph/full_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>

#include "sheetform/base/error.h"

namespace sheetform {

CutChart::CutChart(const PatchChart& chart) : chart_(chart), vertices_(static_cast<int>(chart.uv.size())) {
  build_edges();
  vertex_triangles_.resize(vertices_);
  for (std::size_t t = 0; t < chart.triangles.size(); ++t)
    for (int v : chart.triangles[t]) vertex_triangles_[v].push_back(static_cast<int>(t));
  tolerance_.assign(vertices_, std::numeric_limits<double>::max());
  for (const Edge& e : edges_)
    for (int v : e.ends)
      tolerance_[v] = std::min(tolerance_[v], kMerge * (chart.uv[e.ends[1]] - chart.uv[e.ends[0]]).norm());
  pieces_.resize(chart.triangles.size());
}

void CutChart::build_edges() {
  struct Half {
    int low, high, triangle, corner;
    bool operator<(const Half& o) const {
      return std::tie(low, high, triangle, corner) < std::tie(o.low, o.high, o.triangle, o.corner);
    }
  };
  std::vector<Half> halves;
  for (std::size_t t = 0; t < chart_.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(chart_.triangles[t][k], chart_.triangles[t][(k + 1) % 3]);
      halves.push_back({low, high, static_cast<int>(t), k});
    }
  std::sort(halves.begin(), halves.end());
  triangle_edges_.resize(chart_.triangles.size());
  for (const Half& h : halves) {
    const bool fresh = edges_.empty() || edges_.back().ends != std::array<int, 2>{h.low, h.high};
    if (fresh)
      edges_.push_back({{h.low, h.high}, {h.triangle, -1}, {}});
    else
      edges_.back().triangles[1] = h.triangle;
    triangle_edges_[h.triangle][h.corner] = static_cast<int>(edges_.size()) - 1;
  }
}

Vector2 CutChart::uv(int point) const {
  if (point < vertices_) return chart_.uv[point];
  const auto [edge, t] = cut(point);
  return (1 - t) * chart_.uv[edges_[edge].ends[0]] + t * chart_.uv[edges_[edge].ends[1]];
}

int CutChart::near_point(int edge, double t) const {
  int best = -1;
  double gap = kMerge;
  for (int p : edges_[edge].points) {
    const double d = std::abs(cut(p).t - t);
    if (d < gap) gap = d, best = p;
  }
  return best;
}

int CutChart::cut_edge(int edge, double t) {
  const int near = near_point(edge, t);
  if (near >= 0) return near;
  const int id = point_count();
  auto& points = edges_[edge].points;
  const auto place = std::find_if(points.begin(), points.end(), [&](int p) { return cut(p).t > t; });
  points.insert(place, id);
  cuts_.push_back({edge, t});
  return id;
}

int CutChart::add_on_edge(int a, int b, double t) {
  for (int triangle : vertex_triangles_[a])
    for (int e : triangle_edges_[triangle])
      if (edges_[e].ends == std::array<int, 2>{std::min(a, b), std::max(a, b)}) {
        if (t <= 0) return a;
        if (t >= 1) return b;
        return cut_edge(e, a < b ? t : 1 - t);
      }
  throw Error(ErrorCode::kInternal, "the outline of a chart does not follow its triangles",
              "vertices " + std::to_string(a) + " and " + std::to_string(b));
}

CutChart::Spot CutChart::spot(int point) const {
  if (point < vertices_) return {point, -1, 0, 0};
  return {point, cut(point).edge, cut(point).t, 0};
}

CutChart::Spot CutChart::spot_at(const Line& line, int point) const {
  Spot s = spot(point);
  s.along = line.along(uv(point));
  return s;
}

CutChart::Spot CutChart::spot_on(const Line& line, int edge, double t) const {
  const int near = near_point(edge, t);
  if (near >= 0) return spot_at(line, near);
  const auto& [a, b] = edges_[edge].ends;
  return {-1, edge, t, line.along((1 - t) * chart_.uv[a] + t * chart_.uv[b])};
}

// Vertices as near as the tolerance count as on the line: the signs alone then decide how the line runs. Not
// so beyond its ends, where the line would miss its goal.
int CutChart::side_of(const Line& line, int vertex) const {
  const double s = line.side(chart_.uv[vertex]), along = line.along(chart_.uv[vertex]),
               near = tolerance_[vertex];
  if (std::abs(s) <= near && along > -near && along < line.length - near) return 0;
  return s > 0 ? 1 : -1;
}

std::vector<int> CutChart::triangles_at(const Spot& spot) const {
  if (spot.edge < 0) return vertex_triangles_[spot.point];
  const auto& t = edges_[spot.edge].triangles;
  return t[1] < 0 ? std::vector<int>{t[0]} : std::vector<int>{t[0], t[1]};
}

bool CutChart::share_triangle(const Spot& a, const Spot& b) const {
  const std::vector<int> at_a = triangles_at(a), at_b = triangles_at(b);
  return std::find_first_of(at_a.begin(), at_a.end(), at_b.begin(), at_b.end()) != at_a.end();
}

void CutChart::offer(const Spot& spot, double beyond, Spot& best) const {
  if (spot.along <= beyond) return;
  if ((best.point < 0 && best.edge < 0) || spot.along < best.along) best = spot;
}

// The nearest crossing ahead in the triangles around `here`.
CutChart::Spot CutChart::next(const Line& line, const Spot& here, double beyond) const {
  Spot best;
  for (int triangle : triangles_at(here))
    for (int k = 0; k < 3; ++k) {
      const int corner = chart_.triangles[triangle][k], edge = triangle_edges_[triangle][k];
      if (side_of(line, corner) == 0) offer(spot_at(line, corner), beyond, best);
      const auto& [a, b] = edges_[edge].ends;
      const bool holds_here = here.edge < 0 ? a == here.point || b == here.point : edge == here.edge;
      if (holds_here || side_of(line, a) * side_of(line, b) >= 0) continue;
      const double sa = line.side(chart_.uv[a]), sb = line.side(chart_.uv[b]);
      offer(spot_on(line, edge, sa / (sa - sb)), beyond, best);
    }
  return best;
}

bool CutChart::trace(const Line& line, int from, int to, std::vector<Spot>& path) const {
  const double least = 1e-9 * line.length;
  const Spot goal = spot_at(line, to);
  path = {spot_at(line, from)};
  while (!share_triangle(path.back(), goal)) {
    const Spot ahead = next(line, path.back(), path.back().along + least);
    if (ahead.point < 0 && ahead.edge < 0) return false;
    if (ahead.along >= goal.along - least) return false;
    path.push_back(ahead);
  }
  if (path.back().along >= goal.along - least) return false;
  path.push_back(goal);
  return true;
}

// The edge on which both lie, -1 if none.
int CutChart::common_edge(const Spot& a, const Spot& b) const {
  const auto lies_on = [&](const Spot& s, int e) {
    return s.edge >= 0 ? s.edge == e : edges_[e].ends[0] == s.point || edges_[e].ends[1] == s.point;
  };
  for (int t : triangles_at(a))
    for (int e : triangle_edges_[t])
      if (lies_on(a, e) && lies_on(b, e)) return e;
  return -1;
}

// Place on the outline of a triangle: corner k is k, points of the edge after it are up to k + 1.
double CutChart::place_in(int triangle, const Spot& spot) const {
  for (int k = 0; k < 3; ++k) {
    const int corner = chart_.triangles[triangle][k];
    if (spot.edge < 0 ? spot.point == corner : triangle_edges_[triangle][k] == spot.edge)
      return spot.edge < 0 ? k : k + (edges_[spot.edge].ends[0] == corner ? spot.t : 1 - spot.t);
  }
  return -1;
}

bool CutChart::crosses_pieces(const Spot& a, const Spot& b) const {
  for (int triangle : triangles_at(a)) {
    double low = place_in(triangle, a), high = place_in(triangle, b);
    if (low < 0 || high < 0) continue;
    if (low > high) std::swap(low, high);
    for (const auto& piece : pieces_[triangle]) {
      int inside = 0, outside = 0;
      for (int p : piece) {
        const double x = place_in(triangle, spot(p));
        inside += x > low && x < high;
        outside += x < low || x > high;
      }
      if (inside == 1 && outside == 1) return true;
    }
  }
  return false;
}

void CutChart::add_piece(const Spot& a, const Spot& b) {
  for (int triangle : triangles_at(a)) {
    if (place_in(triangle, b) < 0) continue;
    const std::array<int, 2> piece{std::min(a.point, b.point), std::max(a.point, b.point)};
    auto& pieces = pieces_[triangle];
    if (std::find(pieces.begin(), pieces.end(), piece) == pieces.end()) pieces.push_back(piece);
    return;
  }
}

std::vector<int> CutChart::add_line(int from, int to) {
  const Vector2 step = uv(to) - uv(from);
  const double length = step.norm();
  if (from == to || !(length > 0)) return {};
  const Line line{uv(from), step / length, length};
  std::vector<Spot> path;
  if (!trace(line, from, to, path)) return {};
  for (std::size_t i = 0; i + 1 < path.size(); ++i)
    if (common_edge(path[i], path[i + 1]) < 0 && crosses_pieces(path[i], path[i + 1])) return {};
  std::vector<int> points;
  for (Spot& s : path) {
    if (s.point < 0) s.point = cut_edge(s.edge, s.t);
    points.push_back(s.point);
  }
  for (std::size_t i = 0; i + 1 < path.size(); ++i)
    if (common_edge(path[i], path[i + 1]) < 0) add_piece(path[i], path[i + 1]);
  return points;
}

std::vector<int> CutChart::with_points_between(const std::vector<int>& line) const {
  std::vector<int> full{line.front()};
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Spot a = spot(line[i - 1]), b = spot(line[i]);
    const int e = common_edge(a, b);
    if (e >= 0) {
      const auto t_of = [&](const Spot& s) {
        return s.edge >= 0 ? s.t : edges_[e].ends[0] == s.point ? 0.0 : 1.0;
      };
      const double from = t_of(a), to = t_of(b);
      std::vector<int> between;
      for (int p : edges_[e].points)
        if (cut(p).t > std::min(from, to) && cut(p).t < std::max(from, to)) between.push_back(p);
      if (from > to) std::reverse(between.begin(), between.end());
      full.insert(full.end(), between.begin(), between.end());
    }
    full.push_back(line[i]);
  }
  return full;
}

std::vector<int> CutChart::outline_of(int triangle) const {
  std::vector<int> outline;
  for (int k = 0; k < 3; ++k) {
    const int corner = chart_.triangles[triangle][k];
    const Edge& e = edges_[triangle_edges_[triangle][k]];
    outline.push_back(corner);
    if (e.ends[0] == corner)
      outline.insert(outline.end(), e.points.begin(), e.points.end());
    else
      outline.insert(outline.end(), e.points.rbegin(), e.points.rend());
  }
  return outline;
}

}  // namespace sheetform
