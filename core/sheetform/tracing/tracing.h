// Field-aligned paths: the graph of four nodes a vertex, loops and border-to-border paths (paper 3.4;
// method.md 3, 4).
#pragma once
#include <vector>

#include "sheetform/base/run_context.h"
#include "sheetform/field/cross_field.h"
#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// Node 4*v+d: at vertex v going along direction d of its cross. Opposite node: d+2. M2 sheet: d mod 2.
/// Arcs lead to vertices within `radius` mean edges; each keeps the mesh vertices it runs over.
/// Vertices marked as terminal (surface border, creases) are only first or last on a path, never passed.
struct TracingGraph {
  struct Arc {
    int to;           ///< node
    float length;     ///< along the mesh edges
    float drift;      ///< angle to the field in degrees, mean of the signed deviations at both ends, >= 0
    int chain_begin;  ///< inner vertices of the chain from tail to head: [chain_begin, chain_end) of `chain`
    int chain_end;
  };
  std::vector<int> arc_begin;  ///< CSR over nodes
  std::vector<Arc> arcs;       ///< sorted by drift for each node
  std::vector<int> chain;
  std::vector<char> terminal;  ///< per vertex
  int node_count() const { return static_cast<int>(arc_begin.size()) - 1; }
  static int node(int v, int d) { return 4 * v + (d & 3); }
  static int vertex(int node) { return node >> 2; }
  static int opposite(int node) { return (node & ~3) | ((node + 2) & 3); }
};

struct GraphParams {
  double radius_edges = 3.2;  ///< experiments.md Q2
  double max_angle = 40;      ///< degrees
};
TracingGraph tracing_graph(const SurfaceMesh& mesh, const std::vector<char>& crease_edge,
                           const CrossField& field, const GraphParams& params, RunContext& context);

/// The graph without the arcs that run over one of these edges (by edge; empty = none), so that no path does.
TracingGraph without_edges(const SurfaceMesh& mesh, TracingGraph graph, const std::vector<char>& edges);

/// A chain of mesh edges, simple (no vertex twice, apart from the closing one of a loop, which is not
/// repeated here).
struct Path {
  std::vector<int> vertices;
  std::vector<signed char>
      dirs;  ///< direction d of travel at each vertex (that of the graph node, or the closest)
  bool loop = false;
  double length = 0;
  double drift = 0;  ///< mean of the squared angle / 45 degrees, weighted by length
};

struct TraceParams {
  double drift_weight = 50;  ///< cost = length * (1 + drift_weight * (drift/45)^2)
  double max_cost = 12;      ///< in bounding-box diagonals; a search gives up beyond
  int seeds = 300;           ///< interior seeds, two loops each
  int border_seeds = 120;
};
/// Candidate paths: loops from well spread interior seeds, and border/crease-to-border/crease paths. No
/// duplicates (paths that share over 80 % of their M2 nodes), no self-touching ones. Deterministic.
std::vector<Path> trace_candidates(const SurfaceMesh& mesh, const TracingGraph& graph,
                                   const CrossField& field, const TraceParams& params, RunContext& context);

/// Distances on the M4 graph: per node, the length of the shortest way from any source node. Decrease-only
/// updates.
class NodeDistance {
 public:
  NodeDistance(const TracingGraph& graph, double cap);
  /// Makes the path's nodes and their opposites sources.
  void add(const Path& path);
  /// Makes nodes tangent to a fixed polyline (border, crease) sources.
  void add_nodes(const std::vector<int>& nodes);
  double at(int node) const { return distance_[node]; }
  /// Mean distance over the path's nodes: the priority of farthest-first insertion.
  double mean(const Path& path) const;

 private:
  const TracingGraph* graph_;
  std::vector<double> distance_;
};

/// The cheapest path inside a set of faces from one of `sources` (nodes) to one of `targets` (nodes), through
/// vertices with allowed[v] only (sources and targets always are). Empty when there is none.
Path trace_between(const SurfaceMesh& mesh, const TracingGraph& graph, const CrossField& field,
                   const std::vector<int>& sources, const std::vector<int>& targets,
                   const std::vector<char>& allowed, const TraceParams& params);

}  // namespace sheetform
