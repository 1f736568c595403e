#include "sheetform/tracing/path_smoothing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

namespace sheetform {
namespace {

// A vertex that follows its paths: one path through it, or two that cross. Neighbours 0 and 1 are of the
// first path, 2 and 3 of the second.
struct PathVertex {
  int vertex;
  int paths;
  std::array<int, 4> neighbour;
};

struct Region {
  std::vector<PathVertex> on_path;   // movable ones
  std::vector<int> around;           // movable vertices within two rings, not on paths
  std::vector<int> movable;          // both, ascending
  std::vector<Vector3> normal;       // per entry of `slot`
  std::vector<int> slot;             // per mesh vertex: index into movable, -1 for the others
  std::vector<int> faces;            // that have a movable vertex
  std::vector<Vector3> face_normal;  // of `faces`, before
  std::vector<double> quality;       // of `faces`, before
  std::vector<Vector3> start;        // of `movable`, before
};

std::vector<std::vector<int>> path_neighbours(const SurfaceMesh& mesh, const std::vector<char>& path_edge,
                                              std::vector<int>& on_path) {
  std::vector<std::vector<int>> neighbours(mesh.points.size());
  for (int e = 0; e < mesh.edge_count(); ++e) {
    if (!path_edge[e]) continue;
    neighbours[mesh.edges[e].v0].push_back(mesh.edges[e].v1);
    neighbours[mesh.edges[e].v1].push_back(mesh.edges[e].v0);
  }
  for (int v = 0; v < mesh.vertex_count(); ++v)
    if (!neighbours[v].empty()) on_path.push_back(v);
  return neighbours;
}

// Cosine between the ways from v to a and to b: -1 when v lies straight between them.
double bend(const SurfaceMesh& mesh, int v, int a, int b) {
  return (mesh.points[a] - mesh.points[v]).normalized().dot((mesh.points[b] - mesh.points[v]).normalized());
}

// The two of three path neighbours that lie most nearly opposite each other: the bar of a T.
PathVertex bar_of(const SurfaceMesh& mesh, int v, const std::vector<int>& n) {
  PathVertex best{v, 1, {n[0], n[1]}};
  for (const auto& [a, b] : {std::pair(n[1], n[2]), std::pair(n[2], n[0])})
    if (bend(mesh, v, a, b) < bend(mesh, v, best.neighbour[0], best.neighbour[1])) best = {v, 1, {a, b}};
  return best;
}

// Two paths through v: the straightest way to pair four neighbours.
PathVertex crossing_of(const SurfaceMesh& mesh, int v, const std::vector<int>& n) {
  PathVertex best{v, 2, {n[0], n[1], n[2], n[3]}};
  double straightest = bend(mesh, v, n[0], n[1]) + bend(mesh, v, n[2], n[3]);
  for (const auto& [mate, a, b] : {std::tuple(2, 1, 3), std::tuple(3, 1, 2)}) {
    const double sum = bend(mesh, v, n[0], n[mate]) + bend(mesh, v, n[a], n[b]);
    if (sum < straightest) straightest = sum, best = {v, 2, {n[0], n[mate], n[a], n[b]}};
  }
  return best;
}

// What pulls a path vertex; no paths for one that stays.
PathVertex pull_of(const SurfaceMesh& mesh, int v, const std::vector<int>& n) {
  switch (n.size()) {
    case 2:
      return {v, 1, {n[0], n[1]}};
    case 3:
      return bar_of(mesh, v, n);
    case 4:
      return crossing_of(mesh, v, n);
    default:
      return {v, 0, {}};
  }
}

void add_around(const SurfaceMesh& mesh, const std::vector<int>& on_path,
                const std::vector<char>& fixed_vertex, const std::vector<char>& is_path,
                std::vector<int>& around) {
  std::vector<char> seen = is_path;
  std::vector<int> ring = on_path;
  for (int step = 0; step < 2; ++step) {
    std::vector<int> next;
    for (int v : ring)
      for (const int* e = mesh.ring_begin_of(v); e != mesh.ring_end_of(v); ++e) {
        const int w = mesh.edges[*e].other(v);
        if (seen[w] || fixed_vertex[w] || mesh.border_vertex[w]) continue;
        seen[w] = 1;
        next.push_back(w);
      }
    around.insert(around.end(), next.begin(), next.end());
    ring = std::move(next);
  }
}

std::array<Vector3, 3> corners(const SurfaceMesh& mesh, int f) {
  const auto& t = mesh.faces[f];
  return {mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]};
}

double quality_of(const SurfaceMesh& mesh, int f) {
  const auto c = corners(mesh, f);
  return radius_ratio(c[0], c[1], c[2]);
}

void add_faces(const SurfaceMesh& mesh, Region& region) {
  std::vector<char> seen(mesh.faces.size(), 0);
  for (int v : region.movable)
    for (const int* e = mesh.ring_begin_of(v); e != mesh.ring_end_of(v); ++e)
      for (int f : {mesh.edges[*e].f0, mesh.edges[*e].f1}) {
        const auto& t = f >= 0 ? mesh.faces[f] : std::array<int, 3>{-1, -1, -1};
        if (f < 0 || seen[f] || std::find(t.begin(), t.end(), v) == t.end()) continue;
        seen[f] = 1;
        region.faces.push_back(f);
      }
  std::sort(region.faces.begin(), region.faces.end());
  region.normal.assign(region.movable.size(), Vector3::Zero());
  for (int f : region.faces) {
    const Vector3 raw = mesh.face_normal_raw(f);
    region.face_normal.push_back(raw.normalized());
    region.quality.push_back(quality_of(mesh, f));
    for (int v : mesh.faces[f])
      if (region.slot[v] >= 0) region.normal[region.slot[v]] += raw;
  }
  for (Vector3& n : region.normal) n.normalize();
}

Region find_region(const SurfaceMesh& mesh, const std::vector<char>& path_edge,
                   const std::vector<char>& fixed_vertex) {
  Region region;
  std::vector<int> on_path;
  const auto neighbours = path_neighbours(mesh, path_edge, on_path);
  std::vector<char> is_path(mesh.points.size(), 0);
  for (int v : on_path) {
    is_path[v] = 1;
    if (fixed_vertex[v] || mesh.border_vertex[v]) continue;
    const PathVertex pull = pull_of(mesh, v, neighbours[v]);
    if (pull.paths > 0) region.on_path.push_back(pull);
  }
  add_around(mesh, on_path, fixed_vertex, is_path, region.around);
  std::sort(region.around.begin(), region.around.end());
  region.movable = region.around;
  for (const PathVertex& p : region.on_path) region.movable.push_back(p.vertex);
  std::sort(region.movable.begin(), region.movable.end());
  region.slot.assign(mesh.points.size(), -1);
  for (std::size_t i = 0; i < region.movable.size(); ++i) {
    region.slot[region.movable[i]] = static_cast<int>(i);
    region.start.push_back(mesh.points[region.movable[i]]);
  }
  add_faces(mesh, region);
  return region;
}

// Part `damping` of the way to `target`, in the tangent plane.
Vector3 tangential_step(const SurfaceMesh& mesh, const Region& region, int v, const Vector3& target,
                        double damping) {
  const Vector3& n = region.normal[region.slot[v]];
  const Vector3 way = target - mesh.points[v];
  return mesh.points[v] + damping * (way - n * n.dot(way));
}

// The middle of the two neighbours. At a crossing each path moves the vertex across itself only: if it also
// pulled along itself, it would hold the other one back and leave a kink.
Vector3 target_of(const SurfaceMesh& mesh, const PathVertex& p) {
  const Vector3& at = mesh.points[p.vertex];
  const auto middle = [&](int i) {
    return Vector3((mesh.points[p.neighbour[i]] + mesh.points[p.neighbour[i + 1]]) / 2);
  };
  if (p.paths == 1) return middle(0);
  Vector3 target = at;
  for (int i : {0, 2}) {
    const Vector3 along = (mesh.points[p.neighbour[i + 1]] - mesh.points[p.neighbour[i]]).normalized();
    const Vector3 way = middle(i) - at;
    target += way - along * along.dot(way);
  }
  return target;
}

void step_paths(SurfaceMesh& mesh, const Region& region, double damping) {
  std::vector<Vector3> moved;
  moved.reserve(region.on_path.size());
  for (const PathVertex& p : region.on_path) {
    moved.push_back(tangential_step(mesh, region, p.vertex, target_of(mesh, p), damping));
  }
  for (std::size_t i = 0; i < moved.size(); ++i) mesh.points[region.on_path[i].vertex] = moved[i];
}

void step_around(SurfaceMesh& mesh, const Region& region, double damping) {
  for (int v : region.around) {  // in place: converges twice as fast, and the order is fixed
    Vector3 sum = Vector3::Zero();
    for (const int* e = mesh.ring_begin_of(v); e != mesh.ring_end_of(v); ++e)
      sum += mesh.points[mesh.edges[*e].other(v)];
    const auto count = static_cast<double>(mesh.ring_end_of(v) - mesh.ring_begin_of(v));
    mesh.points[v] = tangential_step(mesh, region, v, sum / count, damping);
  }
}

// Back onto the surface. The reach keeps a vertex from jumping to the other side of a thin part.
void project(SurfaceMesh& mesh, const Region& region, const ClosestPointTree& surface, double reach) {
  for (int v : region.movable) {
    const ClosestPoint hit = surface.closest(mesh.points[v], reach * reach);
    mesh.points[v] = hit.face >= 0 ? hit.point : region.start[region.slot[v]];
  }
}

bool is_bad(const SurfaceMesh& mesh, const Region& region, std::size_t i, double min_quality) {
  const int f = region.faces[i];
  if (mesh.face_normal_raw(f).dot(region.face_normal[i]) <= 0 && region.quality[i] > 0) return true;
  return quality_of(mesh, f) < std::min(min_quality, region.quality[i]);
}

// Moves the vertices of bad faces back, half of the way a time and wholly the third time, until no face is
// bad. Ends: every round takes at least one vertex back, and all vertices where they were is a good state.
void repair(SurfaceMesh& mesh, const Region& region, const ClosestPointTree& surface, double reach,
            double min_quality) {
  constexpr int kHalvings = 2;
  std::vector<int> level(region.movable.size(), 0);
  for (bool changed = true; changed;) {
    changed = false;
    std::vector<char> back(region.movable.size(), 0);
    for (std::size_t i = 0; i < region.faces.size(); ++i) {
      if (!is_bad(mesh, region, i, min_quality)) continue;
      for (int v : mesh.faces[region.faces[i]])
        if (region.slot[v] >= 0) back[region.slot[v]] = 1;
    }
    for (std::size_t s = 0; s < back.size(); ++s) {
      if (!back[s] || level[s] > kHalvings) continue;
      changed = true;
      Vector3& p = mesh.points[region.movable[s]];
      if (++level[s] > kHalvings) {
        p = region.start[s];
        continue;
      }
      const ClosestPoint hit = surface.closest((p + region.start[s]) / 2, reach * reach);
      p = hit.face >= 0 ? hit.point : region.start[s];
    }
  }
}

// Mean length of the edges at movable vertices.
double local_edge_length(const SurfaceMesh& mesh, const Region& region) {
  double sum = 0;
  int count = 0;
  for (int v : region.movable)
    for (const int* e = mesh.ring_begin_of(v); e != mesh.ring_end_of(v); ++e)
      sum += mesh.edge_length(*e), ++count;
  return count > 0 ? sum / count : 0;
}

}  // namespace

double radius_ratio(const Vector3& a, const Vector3& b, const Vector3& c) {
  // r_in = area / s, R_circ = abc / (4 area): the ratio is 8 area^2 / (s abc).
  const double x = (b - c).norm(), y = (c - a).norm(), z = (a - b).norm();
  const double twice_area = (b - a).cross(c - a).norm(), product = (x + y + z) / 2 * x * y * z;
  return product > 0 ? 2 * twice_area * twice_area / product : 0;
}

std::vector<int> smooth_paths(SurfaceMesh& mesh, const std::vector<char>& path_edge,
                              const std::vector<char>& fixed_vertex, const ClosestPointTree& surface,
                              const SmoothParams& params, RunContext& context) {
  const Region region = find_region(mesh, path_edge, fixed_vertex);
  if (region.on_path.empty()) return {};
  const double reach = 0.75 * local_edge_length(mesh, region);
  for (int round = 0; round < params.rounds; ++round) {
    context.checkpoint();
    for (int i = 0; i < params.path_steps; ++i) step_paths(mesh, region, params.damping);
    for (int i = 0; i < params.relax_steps; ++i) step_around(mesh, region, params.damping);
    project(mesh, region, surface, reach);
  }
  repair(mesh, region, surface, reach, params.min_quality);
  std::vector<int> moved;
  for (std::size_t i = 0; i < region.movable.size(); ++i)
    if (mesh.points[region.movable[i]] != region.start[i]) moved.push_back(region.movable[i]);
  return moved;
}

}  // namespace sheetform
