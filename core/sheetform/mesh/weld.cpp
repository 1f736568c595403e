#include "sheetform/mesh/weld.h"

#include <algorithm>
#include <cmath>
#include <numeric>

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
  std::vector<int> order(points.size()), parent(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::iota(parent.begin(), parent.end(), 0);
  // A sweep along an oblique direction: axis-parallel models have many points of the same x.
  const Vector3 sweep = Vector3(0.7548776662466927, 0.5698402909980532, 0.3247179572447460).normalized();
  std::vector<double> at(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) at[i] = sweep.dot(points[i]);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return at[a] < at[b] || (at[a] == at[b] && a < b); });
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size() && at[order[j]] - at[order[i]] <= distance; ++j) {
      if ((points[order[i]] - points[order[j]]).squaredNorm() > distance * distance) continue;
      const int a = find_root(parent, order[i]), b = find_root(parent, order[j]);
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
