#include "sheetform/tracing/seeds.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

namespace sheetform {
namespace {

using Item = std::pair<double, int>;

// Lowers distances from the vertices in the heap on; never raises one.
void spread(const SurfaceMesh& mesh, std::vector<Item>& heap, std::vector<double>& distance) {
  while (!heap.empty()) {
    const auto [d, v] = heap.front();
    std::pop_heap(heap.begin(), heap.end(), std::greater<>());
    heap.pop_back();
    if (d > distance[v]) continue;
    for (const int* e = mesh.ring_begin_of(v); e != mesh.ring_end_of(v); ++e) {
      const int w = mesh.edges[*e].other(v);
      const double through = d + mesh.edge_length(*e);
      if (through >= distance[w]) continue;
      distance[w] = through;
      heap.emplace_back(through, w);
      std::push_heap(heap.begin(), heap.end(), std::greater<>());
    }
  }
}

// The candidate with the largest distance, taken off a heap of possibly outdated values; -1 when none is
// left.
int take_farthest(std::vector<Item>& far, const std::vector<double>& distance) {
  while (!far.empty()) {
    const auto [key, minus_v] = far.front();
    const int v = -minus_v;
    std::pop_heap(far.begin(), far.end());
    far.pop_back();
    if (distance[v] <= 0) continue;
    if (key <= distance[v]) return v;
    far.emplace_back(distance[v], minus_v);  // distances only shrink: look again when its turn comes
    std::push_heap(far.begin(), far.end());
  }
  return -1;
}

}  // namespace

std::vector<int> farthest_point_samples(const SurfaceMesh& mesh, const std::vector<char>& candidate,
                                        const std::vector<char>& start, int count) {
  std::vector<double> distance(mesh.points.size(), std::numeric_limits<double>::infinity());
  std::vector<Item> heap, far;
  for (int v = 0; v < mesh.vertex_count(); ++v)
    if (start[v]) distance[v] = 0, heap.emplace_back(0, v);
  spread(mesh, heap, distance);
  for (int v = 0; v < mesh.vertex_count(); ++v)
    if (candidate[v]) far.emplace_back(distance[v], -v);
  std::make_heap(far.begin(), far.end());
  std::vector<int> samples;
  while (static_cast<int>(samples.size()) < count) {
    const int v = take_farthest(far, distance);
    if (v < 0) break;
    samples.push_back(v);
    distance[v] = 0;
    heap.assign(1, {0, v});
    spread(mesh, heap, distance);
  }
  return samples;
}

}  // namespace sheetform
