#include <algorithm>
#include <functional>
#include <utility>

#include "sheetform/tracing/tracing.h"

namespace sheetform {

NodeDistance::NodeDistance(const TracingGraph& graph, double cap)
    : graph_(&graph), distance_(graph.node_count(), cap) {}

void NodeDistance::add(const Path& path) {
  std::vector<int> nodes;
  for (std::size_t i = 0; i < path.vertices.size(); ++i) {
    const int node = TracingGraph::node(path.vertices[i], path.dirs[i]);
    nodes.push_back(node);
    nodes.push_back(TracingGraph::opposite(node));
  }
  add_nodes(nodes);
}

void NodeDistance::add_nodes(const std::vector<int>& nodes) {
  std::vector<std::pair<double, int>> heap;
  auto lower = [&](int node, double d) {
    if (d >= distance_[node]) return;
    distance_[node] = d;
    heap.emplace_back(d, node);
    std::push_heap(heap.begin(), heap.end(), std::greater<>());
  };
  for (int node : nodes) lower(node, 0);
  while (!heap.empty()) {
    const auto [d, node] = heap.front();
    std::pop_heap(heap.begin(), heap.end(), std::greater<>());
    heap.pop_back();
    if (d > distance_[node]) continue;
    // Ways do not lead across borders and creases, but they may begin there.
    if (d > 0 && graph_->terminal[TracingGraph::vertex(node)]) continue;
    for (int a = graph_->arc_begin[node]; a < graph_->arc_begin[node + 1]; ++a)
      lower(graph_->arcs[a].to, d + graph_->arcs[a].length);
  }
}

double NodeDistance::mean(const Path& path) const {
  double sum = 0;
  for (std::size_t i = 0; i < path.vertices.size(); ++i)
    sum += distance_[TracingGraph::node(path.vertices[i], path.dirs[i])];
  return path.vertices.empty() ? 0 : sum / static_cast<double>(path.vertices.size());
}

}  // namespace sheetform
