#include "sheetform/tracing/tracing.h"

namespace sheetform {
namespace {

bool runs_over(const SurfaceMesh& mesh, const TracingGraph& graph, int tail, const TracingGraph::Arc& arc,
               const std::vector<char>& edges) {
  int at = TracingGraph::vertex(tail);
  for (int i = arc.chain_begin; i <= arc.chain_end; ++i) {
    const int next = i < arc.chain_end ? graph.chain[i] : TracingGraph::vertex(arc.to);
    const int e = mesh.find_edge(at, next);
    if (e >= 0 && edges[e]) return true;
    at = next;
  }
  return false;
}

}  // namespace

TracingGraph without_edges(const SurfaceMesh& mesh, TracingGraph graph, const std::vector<char>& edges) {
  if (edges.empty()) return graph;
  int kept = 0, begin = 0;
  for (int node = 0; node < graph.node_count(); ++node) {
    const int end = graph.arc_begin[node + 1];
    for (int a = begin; a < end; ++a)
      if (!runs_over(mesh, graph, node, graph.arcs[a], edges)) graph.arcs[kept++] = graph.arcs[a];
    begin = end;
    graph.arc_begin[node + 1] = kept;
  }
  graph.arcs.resize(kept);
  return graph;
}

}  // namespace sheetform
