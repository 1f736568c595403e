#include "sheetform/strip/close_points.h"

#include <algorithm>
#include <map>
#include <utility>

#include "sheetform/strip/certificate_checks.h"
#include "sheetform/strip/unfold.h"

namespace sheetform {
namespace {

constexpr double kApart = 1e-6;                          // of the diagonal: between any two of them
constexpr double kClose = 3 * certificate::kDegenerate;  // what is farther apart is not moved

// By point, for these alone: from there to the middle of the triangles around it, on the plane of symmetry
// along that.
std::map<int, Vector3> ways_inside(const StripMesh& strips, const std::map<int, int>& points) {
  std::map<int, Vector3> ways;
  for (const auto& [v, lower] : points) ways[v].setZero();
  for (const StripMesh::Patch& patch : strips.patches)
    for (const StripMesh::Triangle& t : patch.triangles)
      for (int v : t.v)
        if (const auto way = ways.find(v); way != ways.end())
          for (int other : t.v) way->second += strips.points[other] - strips.points[v];
  for (const StripMesh::Arch& arch : strips.arches)
    if (arch.on_plane)
      for (int v : arch.vertices)
        if (const auto way = ways.find(v); way != ways.end()) way->second.x() = 0;
  return ways;
}

void unfold_anew(const StripMesh::Patch& patch, StripMesh& strips) {
  std::map<int, int> place;  // of a uv, in `points`
  std::vector<Vector3> points;
  std::vector<std::array<int, 3>> triangles;
  for (const StripMesh::Triangle& t : patch.triangles) {
    std::array<int, 3>& triangle = triangles.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const auto [at, fresh] = place.emplace(t.vt[k], static_cast<int>(points.size()));
      if (fresh) points.push_back(strips.points[t.v[k]]);
      triangle[k] = at->second;
    }
  }
  const std::vector<Vector2> flat = unfold(points, triangles);
  for (const auto& [vt, at] : place) strips.uvs[vt] = flat[at];
}

}  // namespace

std::vector<std::array<int, 2>> close_points(const std::vector<Vector3>& points, const std::vector<int>& ids,
                                             double distance) {
  std::vector<std::array<int, 2>> pairs;
  const Vector3 odd =
      Vector3(0.5301, 0.6247, 0.5733).normalized();  // no axis: grids have many points in one plane
  std::vector<std::pair<double, int>> order;
  for (int v : ids) order.emplace_back(points[v].dot(odd), v);
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size() && order[j].first - order[i].first <= distance; ++j) {
      const int a = order[i].second, b = order[j].second;
      if (a != b && (points[a] - points[b]).norm() <= distance) pairs.push_back({a, b});
    }
  return pairs;
}

void part_close_points(StripMesh& strips, double bbox_diagonal) {
  std::vector<int> ids;
  for (const StripMesh::Patch& patch : strips.patches)
    ids.insert(ids.end(), patch.boundary.begin(), patch.boundary.end());
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  std::map<int, int>
      close;  // and with how many lower ones: each goes farther than those, should all go one way
  for (const auto& [a, b] : close_points(strips.points, ids, kClose * bbox_diagonal))
    ++close[std::max(a, b)], close.emplace(std::min(a, b), 0);
  if (close.empty()) return;
  for (const auto& [v, way] : ways_inside(strips, close))
    if (way.norm() > 0) strips.points[v] += kApart * bbox_diagonal * (1 + close[v]) * way.normalized();
  for (const StripMesh::Patch& patch : strips.patches)
    if (std::any_of(patch.boundary.begin(), patch.boundary.end(), [&](int v) { return close.count(v) > 0; }))
      unfold_anew(patch, strips);
}

}  // namespace sheetform
