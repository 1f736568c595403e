#include <algorithm>

#include "sheetform/tracing/path_search.h"

namespace sheetform {
namespace {

// Relaxes the arcs of a node that stay inside the mask. An arc without inner vertices between two vertices
// outside the mask is left out: the edge may lie on the patch's boundary or beyond it.
void expand_masked(const TracingGraph& graph, int node, double cost, double drift_weight,
                   const std::vector<char>& allowed, const std::vector<char>& is_target, Frontier& front) {
  const bool inside = allowed[TracingGraph::vertex(node)];
  for (int a = graph.arc_begin[node]; a < graph.arc_begin[node + 1]; ++a) {
    const auto& arc = graph.arcs[a];
    const bool enters = allowed[TracingGraph::vertex(arc.to)];
    if (!enters && !is_target[arc.to]) continue;
    if (!inside && !enters && arc.chain_begin == arc.chain_end) continue;
    const auto chain = graph.chain.begin();
    if (std::all_of(chain + arc.chain_begin, chain + arc.chain_end, [&](int v) { return allowed[v] != 0; }))
      front.push(arc.to, cost + arc_cost(arc, drift_weight), node, a);
  }
}

}  // namespace

Path trace_between(const SurfaceMesh& mesh, const TracingGraph& graph, const CrossField& field,
                   const std::vector<int>& sources, const std::vector<int>& targets,
                   const std::vector<char>& allowed, const TraceParams& params) {
  const PathBuilder builder{mesh, graph, field};
  std::vector<char> is_target(graph.node_count(), 0), is_source(graph.node_count(), 0);
  for (int node : targets) is_target[node] = 1;
  for (int node : sources) is_source[node] = 1;
  Frontier front(graph);
  front.clear();
  for (int node : sources) front.push(node, 0, -1, -1);
  const double max_cost = params.max_cost * bounding_box_diagonal(mesh.points);
  while (front.top() <= max_cost) {
    const int node = front.pop();
    if (is_target[node] && !is_source[node]) {
      Path path = builder.finish(front.walk_to(node, builder), false);
      if (!path.vertices.empty()) return path;
      continue;  // it touched itself: the next target may do better
    }
    const int v = TracingGraph::vertex(node);
    if (is_source[node] || (allowed[v] && !graph.terminal[v]))
      expand_masked(graph, node, front.cost(node), params.drift_weight, allowed, is_target, front);
  }
  return {};
}

}  // namespace sheetform
