// Straight lines through a chart: which edges and vertices they cross. Part of full_morph.
#pragma once
#include <array>
#include <vector>

#include "sheetform/ruling/chart.h"

namespace sheetform {

/// A chart's triangles with the points that cut its edges. Ids of points: local vertices first, then cuts.
class CutChart {
 public:
  struct Cut {
    int edge;
    double t;  ///< from the edge's lower to its higher vertex
  };
  explicit CutChart(const PatchChart& chart);

  /// The point on the edge between two local vertices at fraction t from a to b; the cut that is there
  /// already when it is nearer than kMerge edges. Throws Error kInternal when a and b share no edge.
  int add_on_edge(int a, int b, double t);
  /// Inserts the straight line between two outline points; returns the points along it, or nothing when
  /// it leaves the chart, doubles back (folded charts) or crosses an earlier line. O(triangles crossed).
  std::vector<int> add_line(int from, int to);

  int point_count() const { return vertices_ + static_cast<int>(cuts_.size()); }
  int vertex_count() const { return vertices_; }
  const Cut& cut(int point) const { return cuts_[point - vertices_]; }
  std::array<int, 2> edge_ends(int edge) const { return edges_[edge].ends; }
  Vector2 uv(int point) const;
  /// The same points with those of their common edge in between, where a line runs along an edge.
  std::vector<int> with_points_between(const std::vector<int>& line) const;
  /// The corners of a triangle and the points on its edges, in its order.
  std::vector<int> outline_of(int triangle) const;
  /// Pieces of lines that cross the triangle, each once.
  const std::vector<std::array<int, 2>>& pieces_of(int triangle) const { return pieces_[triangle]; }

  static constexpr double kMerge = 1e-3;

 private:
  struct Edge {
    std::array<int, 2> ends;       // ends[0] < ends[1]
    std::array<int, 2> triangles;  // second -1 on the outline
    std::vector<int> points;       // cuts, by t
  };
  // Where a line crosses: an existing point, or a place on an edge that is still to be cut.
  struct Spot {
    int point = -1, edge = -1;
    double t = 0;
    double along = 0;  // distance from the start of the line
  };
  struct Line {
    Vector2 from, direction;  // direction is unit
    double length;
    double side(const Vector2& p) const {
      return direction.x() * (p.y() - from.y()) - direction.y() * (p.x() - from.x());
    }
    double along(const Vector2& p) const { return direction.dot(p - from); }
  };
  void build_edges();
  Spot spot(int point) const;
  Spot spot_at(const Line& line, int point) const;
  Spot spot_on(const Line& line, int edge, double t) const;
  int side_of(const Line& line, int vertex) const;
  std::vector<int> triangles_at(const Spot& spot) const;
  Spot next(const Line& line, const Spot& here, double beyond) const;
  void offer(const Spot& spot, double beyond, Spot& best) const;
  bool share_triangle(const Spot& a, const Spot& b) const;
  bool trace(const Line& line, int from, int to, std::vector<Spot>& path) const;
  int common_edge(const Spot& a, const Spot& b) const;
  double place_in(int triangle, const Spot& spot) const;
  bool crosses_pieces(const Spot& a, const Spot& b) const;
  int near_point(int edge, double t) const;
  int cut_edge(int edge, double t);
  void add_piece(const Spot& a, const Spot& b);

  const PatchChart& chart_;
  int vertices_;
  std::vector<Edge> edges_;
  std::vector<std::array<int, 3>> triangle_edges_;  // [k] joins corners k and k+1
  std::vector<std::vector<int>> vertex_triangles_;
  std::vector<double> tolerance_;  // per vertex: as near to a line counts as on it
  std::vector<Cut> cuts_;
  std::vector<std::vector<std::array<int, 2>>> pieces_;
};

}  // namespace sheetform
