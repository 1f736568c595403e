#include "sheetform/mesh/weld.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <tuple>

namespace sheetform {
namespace {

// Renumbers roots in the order of first appearance.
std::vector<int> numbered(std::vector<int> root_of) {
  std::vector<int> id(root_of.size(), -1);
  int count = 0;
  for (int& r : root_of) {
    if (id[r] < 0) id[r] = count++;
    r = id[r];
  }
  return root_of;
}

int find_root(std::vector<int>& parent, int i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

// Two points of neighbouring cells that are nearer than one cell: so far apart can the first points of these
// cells be.
constexpr double kNearReach = 4.5;  // 1 + 2 sqrt(3), rounded up

struct Cell {
  std::int64_t x, y, z;
  int point;  // the first one in it
  bool same_place(const Cell& o) const { return x == o.x && y == o.y && z == o.z; }
  bool operator<(const Cell& o) const { return std::tie(x, y, z, point) < std::tie(o.x, o.y, o.z, o.point); }
};

// The cells of a grid that hold points, sorted; all points of a cell are joined to its first one.
std::vector<Cell> occupied_cells(const std::vector<Vector3>& points, double size, std::vector<int>& parent) {
  Vector3 low = points.front();
  for (const Vector3& p : points) low = low.cwiseMin(p);
  std::vector<Cell> cells;
  for (int i = 0; i < static_cast<int>(points.size()); ++i) {
    const Vector3 at = (points[i] - low) / size;
    cells.push_back({static_cast<std::int64_t>(at.x()), static_cast<std::int64_t>(at.y()),
                     static_cast<std::int64_t>(at.z()), i});
  }
  std::sort(cells.begin(), cells.end());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (kept > 0 && cells[i].same_place(cells[kept - 1]))
      parent[cells[i].point] = cells[kept - 1].point;
    else
      cells[kept++] = cells[i];
  }
  cells.resize(kept);
  return cells;
}

}  // namespace

std::vector<int> exact_classes(const std::vector<Vector3>& points) {
  struct Key {
    double x, y, z;
    int id;
  };
  std::vector<Key> keys;
  keys.reserve(points.size());
  for (int i = 0; i < static_cast<int>(points.size()); ++i)
    keys.push_back({points[i].x(), points[i].y(), points[i].z(), i});
  std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) {
    if (a.x != b.x) return a.x < b.x;
    if (a.y != b.y) return a.y < b.y;
    if (a.z != b.z) return a.z < b.z;
    return a.id < b.id;
  });
  std::vector<int> root(points.size());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const bool same =
        i > 0 && keys[i].x == keys[i - 1].x && keys[i].y == keys[i - 1].y && keys[i].z == keys[i - 1].z;
    root[keys[i].id] = same ? root[keys[i - 1].id] : keys[i].id;
  }
  return numbered(std::move(root));
}

std::vector<int> near_classes(const std::vector<Vector3>& points, double distance) {
  std::vector<int> parent(points.size());
  std::iota(parent.begin(), parent.end(), 0);
  if (points.empty() || !(distance > 0)) return parent;
  const std::vector<Cell> cells = occupied_cells(points, distance, parent);
  // Half of the 26 neighbours: the other half finds the pair from its side.
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (int k = 14; k < 27; ++k) {
      const Cell near{cells[c].x + k / 9 - 1, cells[c].y + k / 3 % 3 - 1, cells[c].z + k % 3 - 1, -1};
      const auto it = std::lower_bound(cells.begin() + static_cast<std::ptrdiff_t>(c), cells.end(), near);
      if (it == cells.end() || !it->same_place(near)) continue;
      if ((points[cells[c].point] - points[it->point]).norm() > kNearReach * distance) continue;
      const int a = find_root(parent, cells[c].point), b = find_root(parent, it->point);
      parent[std::max(a, b)] = std::min(a, b);
    }
  for (int i = 0; i < static_cast<int>(parent.size()); ++i) parent[i] = find_root(parent, i);
  return numbered(std::move(parent));
}

int merge_classes(const std::vector<int>& classes, std::vector<Vector3>& points,
                  std::vector<std::array<int, 3>>& faces) {
  int count = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (classes[i] == count) points[count++] = points[i];
  points.resize(count);
  for (auto& f : faces)
    for (int& v : f) v = classes[v];
  return count;
}

}  // namespace sheetform
