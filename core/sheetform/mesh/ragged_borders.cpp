#include "sheetform/mesh/ragged_borders.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "sheetform/mesh/mesh_repair.h"

namespace sheetform {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kReach = 5;                   // vertices to both sides over which raggedness is a mean
constexpr double kRagged = 25 * kPi / 180;  // mean turn at a vertex from which a border may be ragged
// Turns of neighbours add up to less than this share of their sizes where they go to and fro.
constexpr double kToAndFro = 0.7;
constexpr int kLeastVertices = 8;  // of a loop
// Taubin 1995: shrinks and grows in turn, so that waves longer than about ten edges keep their height.
constexpr int kSmoothings = 60;
constexpr double kShrink = 0.5, kGrow = -0.53;
constexpr int kRings = 4, kFollowings = 30;  // of vertices inside that follow, and rounds of averaging
// Share of the area that a triangle keeps, seen along its normal; what has less holds its vertices back.
constexpr double kLeastArea = 0.02;
constexpr int kMostHoldings = 60;
constexpr double kHold = 0.95;

using Loop = std::vector<int>;

// Axis times angle.
Vector3 turn(const Vector3& before, const Vector3& at, const Vector3& after) {
  const Vector3 in = at - before, out = after - at, axis = in.cross(out);
  const double length = axis.norm();
  return length > 0 ? Vector3(axis * (std::atan2(length, in.dot(out)) / length)) : Vector3(Vector3::Zero());
}

// Per vertex of the loop 0 to 1: how much of it is ragged around.
std::vector<double> raggedness(const SurfaceMesh& mesh, const Loop& loop) {
  const int n = static_cast<int>(loop.size());
  if (n < kLeastVertices) return std::vector<double>(n, 0);
  const auto point = [&](int i) -> const Vector3& { return mesh.points[loop[(i + n) % n]]; };
  std::vector<Vector3> turns(n);
  for (int i = 0; i < n; ++i) turns[i] = turn(point(i - 1), point(i), point(i + 1));
  std::vector<char> ragged(n);
  for (int i = 0; i < n; ++i) {
    double size = 0, together = 0;
    for (int k = -kReach; k <= kReach; ++k) {
      const Vector3 &here = turns[(i + k + n) % n], &next = turns[(i + k + 1 + n) % n];
      size += here.norm(), together += (here + next).norm() / 2;
    }
    ragged[i] = size > (2 * kReach + 1) * kRagged && together < kToAndFro * size;
  }
  std::vector<double> share(n, 0);
  for (int i = 0; i < n; ++i)
    for (int k = -kReach; k <= kReach; ++k) share[i] += ragged[(i + k + n) % n] / (2.0 * kReach + 1);
  return share;
}

// Where the vertices of the loop go.
std::vector<Vector3> smoothed(const SurfaceMesh& mesh, const Loop& loop, const std::vector<double>& share,
                              double most) {
  const int n = static_cast<int>(loop.size());
  std::vector<Vector3> now(n), next(n);
  for (int i = 0; i < n; ++i) now[i] = mesh.points[loop[i]];
  const auto step = [&](double factor) {
    for (int i = 0; i < n; ++i)
      next[i] = now[i] + share[i] * factor * ((now[(i + n - 1) % n] + now[(i + 1) % n]) / 2 - now[i]);
    now.swap(next);
  };
  for (int k = 0; k < kSmoothings; ++k) {
    step(kShrink), step(kGrow);
    for (int i = 0; i < n; ++i) {
      const Vector3 &home = mesh.points[loop[i]], shift = now[i] - home;
      if (shift.norm() > most) now[i] = home + shift * (most / shift.norm());
    }
  }
  return now;
}

// Vertices inside at most kRings edges from one that moves.
std::vector<int> followers(const SurfaceMesh& mesh, const std::vector<int>& moving) {
  std::vector<int> all, front = moving;
  std::vector<char> seen(mesh.points.size(), 0);
  for (int ring = 0; ring < kRings; ++ring) {
    std::vector<int> next;
    for (int v : front)
      for (const int* e = mesh.ring_begin_of(v); e != mesh.ring_end_of(v); ++e) {
        const int w = mesh.edges[*e].other(v);
        if (mesh.border_vertex[w] || seen[w]) continue;
        seen[w] = 1;
        next.push_back(w);
      }
    all.insert(all.end(), next.begin(), next.end());
    front.swap(next);
  }
  std::sort(all.begin(), all.end());
  return all;
}

// Vertices inside shift by the mean of those around, less and less away from the border.
void follow(const SurfaceMesh& mesh, const std::vector<int>& inside, std::vector<Vector3>& shift) {
  std::vector<Vector3> next(inside.size());
  for (int round = 0; round < kFollowings; ++round) {
    for (std::size_t i = 0; i < inside.size(); ++i) {
      const int v = inside[i];
      Vector3 sum = Vector3::Zero();
      for (const int* e = mesh.ring_begin_of(v); e != mesh.ring_end_of(v); ++e)
        sum += shift[mesh.edges[*e].other(v)];
      next[i] = sum / static_cast<double>(mesh.ring_end_of(v) - mesh.ring_begin_of(v));
    }
    for (std::size_t i = 0; i < inside.size(); ++i) shift[inside[i]] = next[i];
  }
}

// Shortens the shifts at triangles that would turn over or vanish, until there are none.
void hold_back(const SurfaceMesh& mesh, std::vector<Vector3>& shift, const RunContext& context) {
  std::vector<int> faces;
  const auto moves = [&](int f) {
    return std::any_of(mesh.faces[f].begin(), mesh.faces[f].end(),
                       [&](int v) { return !shift[v].isZero(0); });
  };
  for (int f = 0; f < mesh.face_count(); ++f)
    if (moves(f)) faces.push_back(f);
  for (int round = 0;; ++round) {
    context.checkpoint();
    std::vector<int> held;
    for (int f : faces) {
      const auto& t = mesh.faces[f];
      const auto place = [&](int k) { return Vector3(mesh.points[t[k]] + shift[t[k]]); };
      const Vector3 before = mesh.face_normal_raw(f),
                    after = (place(1) - place(0)).cross(place(2) - place(0));
      if (after.dot(before) < kLeastArea * before.squaredNorm()) held.insert(held.end(), t.begin(), t.end());
    }
    if (held.empty()) return;
    std::sort(held.begin(), held.end());
    held.erase(std::unique(held.begin(), held.end()), held.end());
    bool moved = false;
    for (int v : held) {
      moved |= !shift[v].isZero(0);
      shift[v] *= round < kMostHoldings ? kHold : 0;
    }
    if (!moved) return;  // what is thin as it was
  }
}

}  // namespace

std::optional<SurfaceMesh> without_ragged_borders(const SurfaceMesh& mesh, const ClosestPointTree& tree,
                                                  double most, const RunContext& context) {
  std::vector<Vector3> shift(mesh.points.size(), Vector3::Zero());
  std::vector<int> moving;
  for (const Loop& loop : border_loops(mesh)) {
    const std::vector<double> share = raggedness(mesh, loop);
    if (std::none_of(share.begin(), share.end(), [](double s) { return s > 0; })) continue;
    const std::vector<Vector3> places = smoothed(mesh, loop, share, most);
    for (std::size_t i = 0; i < loop.size(); ++i) {
      if (share[i] <= 0) continue;
      shift[loop[i]] = places[i] - mesh.points[loop[i]];
      moving.push_back(loop[i]);
    }
  }
  if (moving.empty()) return std::nullopt;
  const std::vector<int> inside = followers(mesh, moving);
  follow(mesh, inside, shift);
  for (int v : inside) shift[v] = tree.closest(mesh.points[v] + shift[v]).point - mesh.points[v];
  hold_back(mesh, shift, context);
  SurfaceMesh even = mesh;
  for (std::size_t v = 0; v < shift.size(); ++v) even.points[v] += shift[v];
  return even;
}

}  // namespace sheetform
