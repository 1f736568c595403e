#include "sheetform/mesh/feature_lines.h"

#include <algorithm>
#include <cmath>

namespace sheetform {
namespace {

constexpr double kCornerTurn = 50 * M_PI / 180;  // over the scale, on both sides

constexpr double kFewEdges = 12;  // scales: a loop that is no longer may end up with few edges

struct Line {
  std::vector<int> edges, vertices;  // as many vertices as edges when closed, else one more
  bool closed = false;
};

class Tracer {
 public:
  Tracer(const SurfaceMesh& mesh, const std::vector<char>& crease_edge)
      : mesh_(mesh), line_edge_(mesh.edges.size(), 0) {
    for (int e = 0; e < mesh.edge_count(); ++e)
      line_edge_[e] = static_cast<char>(mesh.edges[e].border() || (!crease_edge.empty() && crease_edge[e]));
  }

  std::vector<Line> lines() {
    std::vector<Line> found;
    seen_.assign(line_edge_.size(), 0);
    for (int v = 0; v < mesh_.vertex_count(); ++v) {
      if (degree(v) == 2) continue;
      for (const int* q = mesh_.ring_begin_of(v); q != mesh_.ring_end_of(v); ++q)
        if (line_edge_[*q] && !seen_[*q]) found.push_back(walk(v, *q));
    }
    for (int e = 0; e < mesh_.edge_count(); ++e)
      if (line_edge_[e] && !seen_[e]) {
        found.push_back(walk(mesh_.edges[e].v0, e));
        found.back().closed = true;
        found.back().vertices.pop_back();
      }
    return found;
  }

  int degree(int v) const {
    return static_cast<int>(
        std::count_if(mesh_.ring_begin_of(v), mesh_.ring_end_of(v), [&](int e) { return line_edge_[e]; }));
  }

 private:
  Line walk(int v, int e) {
    Line line;
    line.vertices.push_back(v);
    while (e >= 0) {
      seen_[e] = 1;
      line.edges.push_back(e);
      const int x = mesh_.edges[e].other(line.vertices.back());
      line.vertices.push_back(x);
      e = -1;
      if (x == v || degree(x) != 2) break;
      for (const int* q = mesh_.ring_begin_of(x); q != mesh_.ring_end_of(x); ++q)
        if (line_edge_[*q] && !seen_[*q]) e = *q;
    }
    return line;
  }

  const SurfaceMesh& mesh_;
  std::vector<char> line_edge_, seen_;
};

// Direction from vertex i of the line to the point `scale` away along it, forward (step 1) or backward (-1).
Vector3 chord(const SurfaceMesh& mesh, const Line& line, int i, int step, double scale) {
  const int n = static_cast<int>(line.vertices.size());
  const Vector3& start = mesh.points[line.vertices[i]];
  Vector3 at = start;
  double left = scale;
  for (int j = i, k = 0; k < n && left > 0; ++k) {
    int next = j + step;
    if (line.closed) next = (next + n) % n;
    if (next < 0 || next >= n) break;
    const Vector3 d = mesh.points[line.vertices[next]] - at;
    const double length = d.norm();
    if (length > left) return at + d * (left / length) - start;
    at += d, left -= length, j = next;
  }
  return at - start;
}

// Vertices where the line turns sharply: the sharpest one of each stretch of the scale.
void mark_corners(const SurfaceMesh& mesh, const Line& line, double scale, std::vector<char>& corner) {
  const int n = static_cast<int>(line.vertices.size());
  std::vector<std::pair<double, int>> turns;  // -turn, index: sharpest first
  for (int i = line.closed ? 0 : 1; i < (line.closed ? n : n - 1); ++i) {
    const Vector3 a = -chord(mesh, line, i, -1, scale), b = chord(mesh, line, i, 1, scale);
    const double turn = angle_between(a, b);
    if (turn > kCornerTurn) turns.emplace_back(-turn, i);
  }
  std::sort(turns.begin(), turns.end());
  for (const auto& [turn, i] : turns) {
    bool clear = true;  // no sharper one within the scale
    for (int step : {-1, 1}) {
      double way = 0;
      for (int j = i, k = 0; k < n && clear; ++k) {
        int next = j + step;
        if (line.closed) next = (next + n) % n;
        if (next < 0 || next >= n) break;
        way += (mesh.points[line.vertices[next]] - mesh.points[line.vertices[j]]).norm();
        if (way > scale) break;
        j = next;
        clear = !corner[line.vertices[j]];
      }
    }
    if (clear) corner[line.vertices[i]] = 1;
  }
}

double length_of(const SurfaceMesh& mesh, const Line& line) {
  double sum = 0;
  for (int e : line.edges) sum += mesh.edge_length(e);
  return sum;
}

// The vertex of a line that is farthest from the stretch between two points.
int farthest_vertex(const SurfaceMesh& mesh, const Line& line, const Vector3& a, const Vector3& b) {
  const Vector3 along = b - a;
  const auto distance = [&](int v) {
    const Vector3 d = mesh.points[v] - a;
    const double t = along.squaredNorm() > 0 ? std::clamp(d.dot(along) / along.squaredNorm(), 0.0, 1.0) : 0;
    return (d - t * along).norm();
  };
  return *std::max_element(line.vertices.begin(), line.vertices.end(),
                           [&](int u, int v) { return distance(u) < distance(v); });
}

// A loop of few edges keeps three vertices that are far apart: sliding freely along it they could come to lie
// on one side of a hole of three edges, which would leave a slit without width.
void hold_open(const SurfaceMesh& mesh, const Line& line, double scale, std::vector<char>& corner) {
  if (!line.closed || length_of(mesh, line) > kFewEdges * scale) return;
  const Vector3& start = mesh.points[line.vertices.front()];
  const int first = farthest_vertex(mesh, line, start, start);
  const Vector3& a = mesh.points[first];
  const int second = farthest_vertex(mesh, line, a, a);
  for (int v : {first, second, farthest_vertex(mesh, line, a, mesh.points[second])}) corner[v] = 1;
}

}  // namespace

FeatureLines feature_lines(const SurfaceMesh& mesh, const std::vector<char>& crease_edge, double scale) {
  FeatureLines result;
  result.edge_line.assign(mesh.edges.size(), -1);
  result.corner.assign(mesh.points.size(), 0);
  Tracer tracer(mesh, crease_edge);
  const std::vector<Line> lines = tracer.lines();
  for (const Line& line : lines)
    if (!line.closed) result.corner[line.vertices.front()] = result.corner[line.vertices.back()] = 1;
  for (const Line& line : lines) {
    std::vector<std::array<int, 3>> segments;
    for (int e : line.edges) {
      result.edge_line[e] = static_cast<int>(result.segments.size());
      segments.push_back({mesh.edges[e].v0, mesh.edges[e].v1, mesh.edges[e].v1});
    }
    mark_corners(mesh, line, scale, result.corner);
    hold_open(mesh, line, scale, result.corner);
    result.segments.emplace_back(mesh.points, segments);
  }
  return result;
}

}  // namespace sheetform
