#include "sheetform/morph/full_remesh.h"

#include <algorithm>
#include <cmath>

namespace sheetform {
namespace {

// Stops of an arch are kept a little further apart than what CutChart would merge.
constexpr double kApart = 1.5 * CutChart::kMerge;

// Twice the area over the square of the longest side; 0 for a degenerate triangle, of either orientation.
double fatness(const Vector2& a, const Vector2& b, const Vector2& c) {
  const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return longest > 0 ? std::abs(cross(b - a, c - a)) / longest : 0;
}

// One of the two halves of a polygon on both sides of the diagonal between its corners i < j.
std::vector<int> half_of(const std::vector<int>& polygon, std::size_t i, std::size_t j, bool inner) {
  std::vector<int> half;
  for (std::size_t k = 0; k < polygon.size(); ++k)
    if (k == i || k == j || (k > i && k < j) == inner) half.push_back(polygon[k]);
  return half;
}

// The triangle's outline, split by the pieces of lines that cross it.
std::vector<std::vector<int>> cells_of(std::vector<int> outline,
                                       const std::vector<std::array<int, 2>>& pieces) {
  std::vector<std::vector<int>> cells{std::move(outline)};
  for (const auto& piece : pieces)
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const auto& cell = cells[c];
      const auto a = std::find(cell.begin(), cell.end(), piece[0]),
                 b = std::find(cell.begin(), cell.end(), piece[1]);
      if (a == cell.end() || b == cell.end()) continue;
      const auto i = static_cast<std::size_t>(std::min(a, b) - cell.begin());
      const auto j = static_cast<std::size_t>(std::max(a, b) - cell.begin());
      if (j - i < 2 || j - i == cell.size() - 1) continue;
      std::vector<int> inner = half_of(cell, i, j, true), outer = half_of(cell, i, j, false);
      cells[c] = std::move(inner);
      cells.push_back(std::move(outer));
      break;
    }
  return cells;
}

class Cutter {
 public:
  Cutter(const SurfaceMesh& mesh, const Patch& patch, const RuledPatch& ruled,
         const std::vector<ArchStops>& stops)
      : mesh_(mesh), patch_(patch), ruled_(ruled), stops_(stops), chart_(*ruled.chart) {}

  CutPatch run(const std::vector<double>& isotropy) {
    for (std::size_t u = 0; u < patch_.boundary.size(); ++u) out_.sides.push_back(cut_outline(u));
    std::vector<std::vector<int>> lines;
    for (const RulingLine& l : ruled_.lines) {
      std::vector<int> line = chart_.add_line(outline_point(l.from), outline_point(l.to));
      if (line.empty())
        ++out_.dropped;
      else
        lines.push_back(std::move(line));
    }
    list_points(isotropy);
    for (const auto& line : lines) add_ruling(chart_.with_points_between(line));
    for (std::size_t t = 0; t < ruled_.chart->triangles.size(); ++t) add_triangles(static_cast<int>(t));
    return std::move(out_);
  }

 private:
  // Local vertices of the stops along one stretch of the outline, in the arch's direction.
  std::vector<int> cut_outline(std::size_t u) {
    std::vector<int> line = ruled_.chart->boundary[u];
    if (!patch_.boundary[u].forward) std::reverse(line.begin(), line.end());
    const ArchStops& stops = stops_[patch_.boundary[u].arch];
    std::vector<int> side;
    for (int s = 0; s < stops.count(); ++s) {
      const int edge = std::min(static_cast<int>(stops.at(s)), static_cast<int>(line.size()) - 2);
      side.push_back(chart_.add_on_edge(line[edge], line[edge + 1], stops.at(s) - edge));
    }
    return side;
  }

  int outline_point(const OutlinePlace& place) const {
    return out_.sides[place.use][stops_[patch_.boundary[place.use].arch].nearest(place.at)];
  }

  void list_points(const std::vector<double>& isotropy) {
    const int n = chart_.vertex_count();
    for (int p = 0; p < chart_.point_count(); ++p) {
      std::array<int, 2> ends{p, p};
      double t = 0;
      if (p >= n) ends = chart_.edge_ends(chart_.cut(p).edge), t = chart_.cut(p).t;
      const int a = ruled_.chart->vertices[ends[0]], b = ruled_.chart->vertices[ends[1]];
      out_.rest.push_back((1 - t) * mesh_.points[a] + t * mesh_.points[b]);
      out_.uv.push_back(chart_.uv(p));
      out_.isotropy.push_back(isotropy.empty() ? 1 : (1 - t) * isotropy[a] + t * isotropy[b]);
    }
  }

  void add_ruling(std::vector<int> vertices) {
    RuledMesh::Ruling ruling{0, std::move(vertices), {}};
    const Vector2 from = out_.uv[ruling.vertices.front()], chord = out_.uv[ruling.vertices.back()] - from;
    for (int v : ruling.vertices) ruling.at.push_back(chord.dot(out_.uv[v] - from) / chord.squaredNorm());
    ruling.at.front() = 0, ruling.at.back() = 1;
    out_.rulings.push_back(std::move(ruling));
  }

  void add_triangles(int triangle) {
    for (const auto& cell : cells_of(chart_.outline_of(triangle), chart_.pieces_of(triangle)))
      triangulate_convex(cell, out_.uv, out_.triangles);
  }

  const SurfaceMesh& mesh_;
  const Patch& patch_;
  const RuledPatch& ruled_;
  const std::vector<ArchStops>& stops_;
  CutChart chart_;
  CutPatch out_;
};

}  // namespace

ArchStops::ArchStops(int edges, std::vector<double> at) {
  for (int i = 0; i <= edges; ++i) at_.push_back(i);
  for (double x : at) {
    const double vertex = std::round(x);
    if (x > 0 && x < edges && std::abs(x - vertex) > kApart) at_.push_back(x);
  }
  std::sort(at_.begin(), at_.end());
  const auto last = std::unique(at_.begin(), at_.end(), [](double a, double b) { return b - a <= kApart; });
  at_.erase(last, at_.end());
}

int ArchStops::nearest(double at) const {
  const auto above = std::lower_bound(at_.begin(), at_.end(), at);
  if (above == at_.begin()) return 0;
  if (above == at_.end()) return count() - 1;
  const auto below = above - 1;
  return static_cast<int>((at - *below <= *above - at ? below : above) - at_.begin());
}

void triangulate_convex(const std::vector<int>& polygon, const std::vector<Vector2>& uv,
                        std::vector<std::array<int, 3>>& triangles) {
  const int n = static_cast<int>(polygon.size());
  const auto slot = [n](int i, int j) { return static_cast<std::size_t>(i) * n + j; };
  // best: of the worst triangle over all triangulations of corners i..j; apex: the third corner over i, j.
  std::vector<double> best(static_cast<std::size_t>(n) * n, 1e300);
  std::vector<int> apex(static_cast<std::size_t>(n) * n, -1);
  for (int span = 2; span < n; ++span)
    for (int i = 0; i + span < n; ++i) {
      const int j = i + span;
      double most = -1;
      for (int k = i + 1; k < j; ++k) {
        const double worst = std::min(
            {best[slot(i, k)], best[slot(k, j)], fatness(uv[polygon[i]], uv[polygon[k]], uv[polygon[j]])});
        if (worst > most) most = worst, apex[slot(i, j)] = k;
      }
      best[slot(i, j)] = most;
    }
  std::vector<std::array<int, 2>> open{{0, n - 1}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i < 2) continue;
    const int k = apex[slot(i, j)];
    triangles.push_back({polygon[i], polygon[k], polygon[j]});
    open.push_back({i, k});
    open.push_back({k, j});
  }
}

CutPatch cut_patch(const SurfaceMesh& mesh, const Patch& patch, const RuledPatch& ruled,
                   const std::vector<ArchStops>& stops, const std::vector<double>& isotropy) {
  return Cutter(mesh, patch, ruled, stops).run(isotropy);
}

}  // namespace sheetform
