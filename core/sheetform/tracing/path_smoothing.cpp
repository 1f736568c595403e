#include "sheetform/tracing/path_smoothing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "sheetform/base/parallel_groups.h"
#include "sheetform/mesh/faces_at.h"
#include "sheetform/tracing/path_fairing.h"

namespace sheetform {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kGroup = 250;  // points that are worth a thread

using Points = std::vector<Vector3>;

double quality_of(const SurfaceMesh& mesh, int f) {
  const auto& t = mesh.faces[f];
  return radius_ratio(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]);
}

// Vertices that move, with what is needed to take them back. The mesh is at rest when they are added.
struct Region {
  explicit Region(const SurfaceMesh& mesh) : slot(mesh.points.size(), -1) {}
  void add(const SurfaceMesh& mesh, int v) {
    slot[v] = static_cast<int>(movable.size());
    movable.push_back(v);
    start.push_back(mesh.points[v]);
    Vector3 sum = Vector3::Zero();
    visit_faces_at(mesh, v, [&](int f) { sum += mesh.face_normal_raw(f); });
    normal.push_back(sum.normalized());
  }
  std::vector<int> movable;  // mesh vertices
  std::vector<int> slot;     // per mesh vertex: index into movable, -1 for the others
  Points start;              // of `movable`
  Points normal;             // of `movable`, unit
};

// How a face is at rest: it must not get turned over nor thin.
struct FaceState {
  int face;
  Vector3 normal;
  double quality;
};

std::vector<std::vector<int>> path_neighbours(const SurfaceMesh& mesh, const std::vector<char>& path_edge) {
  std::vector<std::vector<int>> neighbours(mesh.points.size());
  for (int e = 0; e < mesh.edge_count(); ++e) {
    if (!path_edge[e]) continue;
    neighbours[mesh.edges[e].v0].push_back(mesh.edges[e].v1);
    neighbours[mesh.edges[e].v1].push_back(mesh.edges[e].v0);
  }
  return neighbours;
}

// Cosine between the ways from v to a and to b: -1 when v lies straight between them.
double bend(const Points& points, int v, int a, int b) {
  return (points[a] - points[v]).normalized().dot((points[b] - points[v]).normalized());
}

// The two of three path neighbours that lie most nearly opposite each other: the bar of a T.
PathStencil bar_of(const Points& points, int v, const std::vector<int>& n) {
  std::pair best(n[0], n[1]);
  for (const auto& pair : {std::pair(n[1], n[2]), std::pair(n[2], n[0])})
    if (bend(points, v, pair.first, pair.second) < bend(points, v, best.first, best.second)) best = pair;
  return {best.first, v, best.second, false};
}

// Two paths through v: the straightest way to pair four neighbours.
void add_crossing(const Points& points, int v, const std::vector<int>& n, std::vector<PathStencil>& out) {
  std::tuple best(1, 2, 3);
  double straightest = 3;
  for (const auto& [mate, a, b] : {std::tuple(1, 2, 3), std::tuple(2, 1, 3), std::tuple(3, 1, 2)}) {
    const double sum = bend(points, v, n[0], n[mate]) + bend(points, v, n[a], n[b]);
    if (sum < straightest) straightest = sum, best = {mate, a, b};
  }
  const auto [mate, a, b] = best;
  out.push_back({n[0], v, n[mate], true});
  out.push_back({n[a], v, n[b], true});
}

// What straightens the paths at v; nothing for loose ends and where more than two paths meet: they stay.
void add_stencils(const Points& points, int v, const std::vector<int>& n, std::vector<PathStencil>& out) {
  if (n.size() == 2) out.push_back({n[0], v, n[1], false});
  if (n.size() == 3) out.push_back(bar_of(points, v, n));
  if (n.size() == 4) add_crossing(points, v, n, out);
}

// Tangential relaxation of the vertices from `first` on, in place: the order is fixed and it converges fast.
void relax(SurfaceMesh& mesh, const Region& region, std::size_t first) {
  for (std::size_t i = first; i < region.movable.size(); ++i) {
    const int v = region.movable[i];
    Vector3 sum = Vector3::Zero();
    for (const int* e = mesh.ring_begin_of(v); e != mesh.ring_end_of(v); ++e)
      sum += mesh.points[mesh.edges[*e].other(v)];
    const Vector3 way =
        sum / static_cast<double>(mesh.ring_end_of(v) - mesh.ring_begin_of(v)) - mesh.points[v];
    mesh.points[v] += (way - region.normal[i] * region.normal[i].dot(way)) / 2;
  }
}

// One call of smooth_paths, on a mesh that is at rest.
class Smoother {
 public:
  Smoother(SurfaceMesh& mesh, const std::vector<char>& path_edge, const std::vector<char>& fixed_vertex,
           const ClosestPointTree& surface, const SmoothParams& params)
      : mesh_(mesh),
        neighbours_(path_neighbours(mesh, path_edge)),
        fixed_(fixed_vertex),
        surface_(surface),
        params_(params),
        edge_(mean_edge_length(mesh)),
        region_(mesh) {}

  void run(const RunContext& context) {
    find_goals(context);
    if (goals_.empty()) return;
    add_around();
    remember_faces();
    remember_heights();
    move(context);
    make_room(context);
    repair();
  }

  // Where the result is as good as at `previous`, keeps that: a new path far away then moves nothing here.
  void keep_close(const Points& previous) {
    const double close = params_.min_change * edge_;
    const Points result = mesh_.points;
    for (std::size_t v = 0; v < result.size(); ++v)
      if ((result[v] - previous[v]).norm() < close) mesh_.points[v] = previous[v];
    for (bool changed = true; changed;) {  // a mixture may be worse than either: then the result counts
      changed = false;
      for (const FaceState& state : before_) {
        if (!is_bad(state)) continue;
        for (int v : mesh_.faces[state.face])
          if (mesh_.points[v] != result[v]) mesh_.points[v] = result[v], changed = true;
      }
    }
  }

 private:
  bool is_free(int v) const { return !fixed_[v] && !mesh_.border_vertex[v]; }

  // The nearest point of the surface. The reach keeps a vertex from jumping to the other side of a thin part.
  Vector3 projected(const Vector3& p, const Vector3& otherwise) const {
    const double reach = 0.75 * edge_;
    const ClosestPoint hit = surface_.closest(p, reach * reach);
    return hit.face >= 0 ? hit.point : otherwise;
  }

  // Where path vertices should go, on the surface. Those that are near enough at rest are left out.
  void find_goals(const RunContext& context) {
    Region all(mesh_);
    std::vector<PathStencil> stencils;
    for (int v = 0; v < mesh_.vertex_count(); ++v) {
      const std::size_t before = stencils.size();
      if (is_free(v)) add_stencils(mesh_.points, v, neighbours_[v], stencils);
      if (stencils.size() > before) all.add(mesh_, v);
    }
    if (stencils.empty()) return;
    const double anchor = std::pow(1 - std::cos(2 * kPi / params_.cutoff_edges), 2);
    const Points places = fair_paths(mesh_.points, all.movable, all.slot, all.normal, stencils, anchor);
    Points goals(places.size());
    parallel_in_groups(context, static_cast<int>(places.size()), kGroup, [&](int i) {
      goals[i] =
          projected(params_.allowed ? params_.allowed(all.start[i], places[i]) : places[i], all.start[i]);
    });
    for (std::size_t i = 0; i < goals.size(); ++i) {
      if ((goals[i] - all.start[i]).norm() < params_.min_move * edge_) continue;
      region_.add(mesh_, all.movable[i]);
      goals_.push_back(goals[i]);
    }
  }

  // Free vertices within two rings of the moving ones that are on no path.
  void add_around() {
    std::vector<int> ring = region_.movable;
    for (int step = 0; step < 2; ++step) {
      std::vector<int> next;
      for (int v : ring)
        for (const int* e = mesh_.ring_begin_of(v); e != mesh_.ring_end_of(v); ++e) {
          const int w = mesh_.edges[*e].other(v);
          if (region_.slot[w] >= 0 || !neighbours_[w].empty() || !is_free(w)) continue;
          region_.add(mesh_, w);
          next.push_back(w);
        }
      ring = std::move(next);
    }
  }

  // Vertices that stand out so far from those around that their place could be left.
  void remember_heights() {
    high_.assign(region_.movable.size(), 0);
    for (std::size_t i = 0; i < high_.size(); ++i) {
      const int v = region_.movable[i];
      double height = 0;
      for (const int* e = mesh_.ring_begin_of(v); e != mesh_.ring_end_of(v); ++e)
        height = std::max(height, std::abs(region_.normal[i].dot(mesh_.points[mesh_.edges[*e].other(v)] -
                                                                 mesh_.points[v])));
      high_[i] = height > params_.most_left;
    }
  }

  bool is_left(std::size_t i) const {
    const Vector3& place = region_.start[i];
    const int v = region_.movable[i];
    if (mesh_.points[v] == place) return false;
    const int beside = mesh_.edges[*mesh_.ring_begin_of(v)].f0;
    return closest_from(mesh_, beside, place).squared_distance > params_.most_left * params_.most_left;
  }

  void remember_faces() {
    std::vector<int> faces;
    for (int v : region_.movable) visit_faces_at(mesh_, v, [&](int f) { faces.push_back(f); });
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    for (int f : faces) before_.push_back({f, mesh_.face_normal_raw(f), quality_of(mesh_, f)});
  }

  // Takes the path vertices to their goals in equal parts; the vertices around follow.
  void move(const RunContext& context) {
    for (int round = 1; round <= params_.rounds; ++round) {
      context.checkpoint();
      const double part = static_cast<double>(round) / params_.rounds;
      for (std::size_t i = 0; i < goals_.size(); ++i)
        mesh_.points[region_.movable[i]] = region_.start[i] + part * (goals_[i] - region_.start[i]);
      for (int i = 0; i < params_.relax_steps; ++i) relax(mesh_, region_, goals_.size());
    }
    project_around(context);
  }

  void project_around(const RunContext& context) {
    const std::size_t first = goals_.size();
    parallel_in_groups(context, static_cast<int>(region_.movable.size() - first), kGroup, [&](int i) {
      Vector3& p = mesh_.points[region_.movable[first + i]];
      p = projected(p, region_.start[first + i]);
    });
  }

  // Bad faces often only need more room: the vertices around give way once more before path vertices go back.
  void make_room(const RunContext& context) {
    constexpr int kSteps = 10;
    if (std::none_of(before_.begin(), before_.end(), [&](const FaceState& s) { return is_bad(s); })) return;
    for (int i = 0; i < kSteps; ++i) relax(mesh_, region_, goals_.size());
    project_around(context);
  }

  bool is_bad(const FaceState& state) const {
    if (state.quality > 0 && mesh_.face_normal_raw(state.face).dot(state.normal) <= 0) return true;
    return quality_of(mesh_, state.face) < std::min(params_.min_quality, state.quality);
  }

  // Takes the vertices of bad faces back, half of the way a time and wholly the third time, until no face is
  // bad. Ends: every round takes at least one vertex back, and all vertices where they were is a good state.
  void repair() {
    constexpr int kHalvings = 2;
    std::vector<int> level(region_.movable.size(), 0);
    for (bool changed = true; changed;) {
      changed = false;
      std::vector<char> back(region_.movable.size(), 0);
      for (const FaceState& state : before_) {
        if (!is_bad(state)) continue;
        for (int v : mesh_.faces[state.face])
          if (region_.slot[v] >= 0) back[region_.slot[v]] = 1;
      }
      for (std::size_t i = 0; i < back.size(); ++i)
        if (high_[i] && !back[i] && is_left(i)) back[i] = 1;
      for (std::size_t i = 0; i < back.size(); ++i) {
        if (!back[i] || level[i] > kHalvings) continue;
        changed = true;
        Vector3& p = mesh_.points[region_.movable[i]];
        const bool wholly = ++level[i] > kHalvings;
        p = wholly ? region_.start[i] : projected((p + region_.start[i]) / 2, region_.start[i]);
      }
    }
  }

  SurfaceMesh& mesh_;
  const std::vector<std::vector<int>> neighbours_;
  const std::vector<char>& fixed_;
  const ClosestPointTree& surface_;
  const SmoothParams& params_;
  const double edge_;
  Region region_;  // the path vertices first, one for each goal
  Points goals_;
  std::vector<FaceState> before_;
  std::vector<char> high_;  // per movable vertex
};

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
  const Points previous = mesh.points;
  if (params.rest != nullptr) mesh.points = *params.rest;
  Smoother smoother(mesh, path_edge, fixed_vertex, surface, params);
  smoother.run(context);
  if (params.rest != nullptr) smoother.keep_close(previous);
  std::vector<int> moved;
  for (int v = 0; v < mesh.vertex_count(); ++v)
    if (mesh.points[v] != previous[v]) moved.push_back(v);
  return moved;
}

}  // namespace sheetform
