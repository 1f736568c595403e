#include "sheetform/search/stroke_ends.h"

#include <functional>
#include <queue>
#include <unordered_map>
#include <unordered_set>

#include "sheetform/tracing/path_search.h"

namespace sheetform {
namespace {

bool is_drawn(const PathNetwork& network, int e) {
  return network.used(e) && network.kinds[network.edge_path[e]] == PathKind::kDrawn;
}

class Extender {
 public:
  Extender(const SurfaceMesh& mesh, const TracingGraph& graph, const CrossField& field, PathNetwork& network)
      : mesh_(mesh),
        field_(field),
        network_(network),
        search_(mesh, graph, field, TraceParams().drift_weight,
                TraceParams().max_cost * bounding_box_diagonal(mesh.points)) {}

  void run(RunContext& context) {
    for (int v = 0; v < mesh_.vertex_count(); ++v) {
      const int e = loose_end(v);
      if (e < 0) continue;
      context.checkpoint();
      std::vector<int> edges = along_field(v, e);
      if (edges.empty()) edges = shortest(v);
      if (edges.empty()) continue;
      const int path = network_.add_path(PathKind::kCut);
      for (int f : edges) network_.edge_path[f] = path;
    }
  }

 private:
  // The only edge at the vertex when that is the end of a drawn seam, else -1.
  int loose_end(int v) const {
    if (network_degree(mesh_, network_, v) != 1) return -1;
    for (const int* e = mesh_.ring_begin_of(v); e != mesh_.ring_end_of(v); ++e)
      if (is_drawn(network_, *e)) return *e;
    return -1;
  }

  // Up to the first vertex of the network; empty when the way there would share an edge with it.
  std::vector<int> along_field(int v, int e) {
    const Vector3 ahead = mesh_.points[v] - mesh_.points[mesh_.edges[e].other(v)];
    const Path path = search_.from_terminal(TracingGraph::node(v, closest_direction(field_, v, ahead)));
    std::vector<int> edges;
    for (std::size_t i = 0; i + 1 < path.vertices.size(); ++i) {
      const int next = mesh_.find_edge(path.vertices[i], path.vertices[i + 1]);
      if (next < 0 || network_.used(next)) return {};
      edges.push_back(next);
      if (network_degree(mesh_, network_, path.vertices[i + 1]) > 0) break;
    }
    return edges;
  }

  std::unordered_set<int> own_vertices(int v) const {
    std::unordered_set<int> own{v};
    std::vector<int> open{v};
    while (!open.empty()) {
      const int at = open.back();
      open.pop_back();
      for (const int* e = mesh_.ring_begin_of(at); e != mesh_.ring_end_of(at); ++e)
        if (is_drawn(network_, *e) && own.insert(mesh_.edges[*e].other(at)).second)
          open.push_back(mesh_.edges[*e].other(at));
    }
    return own;
  }

  // To the nearest vertex of the network that does not hang together with this seam.
  std::vector<int> shortest(int v) const {
    const std::unordered_set<int> own = own_vertices(v);
    std::unordered_map<int, std::pair<double, int>> known{{v, {0, -1}}};
    using Item = std::pair<double, int>;
    std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
    queue.emplace(0, v);
    while (!queue.empty()) {
      const auto [d, at] = queue.top();
      queue.pop();
      if (d > known[at].first) continue;
      if (at != v && network_degree(mesh_, network_, at) > 0) {
        std::vector<int> edges;
        for (int w = at; known[w].second >= 0; w = mesh_.edges[known[w].second].other(w))
          edges.push_back(known[w].second);
        return edges;
      }
      for (const int* e = mesh_.ring_begin_of(at); e != mesh_.ring_end_of(at); ++e) {
        const int w = mesh_.edges[*e].other(at);
        if (network_.used(*e) || own.count(w)) continue;
        const double next = d + mesh_.edge_length(*e);
        const auto it = known.find(w);
        if (it != known.end() && it->second.first <= next) continue;
        known[w] = {next, *e};
        queue.emplace(next, w);
      }
    }
    return {};
  }

  const SurfaceMesh& mesh_;
  const CrossField& field_;
  PathNetwork& network_;
  PathSearch search_;
};

}  // namespace

void extend_drawn_ends(const SurfaceMesh& mesh, const TracingGraph& graph, const CrossField& field,
                       PathNetwork& network, RunContext& context) {
  Extender(mesh, graph, field, network).run(context);
}

}  // namespace sheetform
