#include <algorithm>
#include <atomic>
#include <cmath>

#include "sheetform/tracing/path_search.h"
#include "sheetform/tracing/seeds.h"

namespace sheetform {
namespace {

// Mean squared angle (in units of 45 degrees) above which a path does not follow the field: 16 degrees.
constexpr double kMaxDrift = 0.12;
// Two paths that share more than this part of their M2 nodes count as one.
constexpr double kSamePath = 0.8;
constexpr int kLoops = 2;  // through each interior seed, one along each arm of the cross

int sheet_node(int v, int d) { return 2 * v + (d & 1); }

// Accepted paths and which of them use each M2 node.
class Pool {
 public:
  explicit Pool(const SurfaceMesh& mesh) : users_(2 * mesh.points.size()) {}

  bool is_used(int v, int d) const { return !users_[sheet_node(v, d)].empty(); }

  void offer(Path path) {
    if (path.vertices.empty() || path.drift > kMaxDrift || is_known(path)) return;
    const int id = static_cast<int>(paths_.size());
    for (std::size_t i = 0; i < path.vertices.size(); ++i)
      users_[sheet_node(path.vertices[i], path.dirs[i])].push_back(id);
    paths_.push_back(std::move(path));
  }

  std::vector<Path> take() { return std::move(paths_); }

 private:
  bool is_known(const Path& path) {
    shared_.assign(paths_.size(), 0);
    for (std::size_t i = 0; i < path.vertices.size(); ++i)
      for (int id : users_[sheet_node(path.vertices[i], path.dirs[i])]) ++shared_[id];
    for (std::size_t id = 0; id < shared_.size(); ++id) {
      const auto larger = std::max(path.vertices.size(), paths_[id].vertices.size());
      if (shared_[id] > kSamePath * static_cast<double>(larger)) return true;
    }
    return false;
  }
  std::vector<std::vector<int>> users_;
  std::vector<Path> paths_;
  std::vector<int> shared_;
};

// Traces nodes in rounds of fixed size, in parallel inside a round. A node that an accepted path runs through
// already would give that path again and is skipped; fixed rounds keep this independent of the number of
// threads.
template <typename Trace>
void trace_in_rounds(const std::vector<int>& nodes, Pool& pool, std::vector<PathSearch>& searches,
                     const RunContext& context, const Trace& trace) {
  constexpr int kRound = 32;
  std::size_t next = 0;
  while (next < nodes.size()) {
    std::vector<int> round;
    for (; next < nodes.size() && round.size() < kRound; ++next)
      if (!pool.is_used(TracingGraph::vertex(nodes[next]), nodes[next] & 3)) round.push_back(nodes[next]);
    std::vector<Path> found(round.size());
    const int workers = static_cast<int>(searches.size()), size = static_cast<int>(round.size());
    std::atomic<int> next_of_round{0};  // one call a worker: each has its own search arrays
    parallel_for(context, workers, [&](int worker) {
      for (int i = next_of_round++; i < size; i = next_of_round++) {
        context.checkpoint();
        found[i] = trace(searches[worker], round[i]);
      }
    });
    for (Path& path : found) pool.offer(std::move(path));
  }
}

std::vector<int> interior_nodes(const SurfaceMesh& mesh, const TracingGraph& graph, const CrossField& field,
                                int seeds) {
  std::vector<char> candidate(mesh.points.size());
  for (std::size_t v = 0; v < candidate.size(); ++v) candidate[v] = !graph.terminal[v];
  for (int f : field.singular_faces)
    for (int v : mesh.faces[f]) candidate[v] = 0;
  std::vector<int> nodes;
  for (int v : farthest_point_samples(mesh, candidate, graph.terminal, seeds))
    for (int d = 0; d < kLoops; ++d) nodes.push_back(TracingGraph::node(v, d));
  return nodes;
}

// Nodes that leave borders and creases; creases have them on both sides.
std::vector<int> terminal_nodes(const SurfaceMesh& mesh, const TracingGraph& graph, int seeds) {
  const std::vector<char> none(mesh.points.size(), 0);
  std::vector<int> nodes;
  for (int v : farthest_point_samples(mesh, graph.terminal, none, seeds))
    for (int d = 0; d < 4; ++d) {
      const int node = TracingGraph::node(v, d);
      if (graph.arc_begin[node] < graph.arc_begin[node + 1]) nodes.push_back(node);
    }
  return nodes;
}

}  // namespace

std::vector<Path> trace_candidates(const SurfaceMesh& mesh, const TracingGraph& graph,
                                   const CrossField& field, const TraceParams& params, RunContext& context) {
  const double max_cost = params.max_cost * bounding_box_diagonal(mesh.points);
  std::vector<PathSearch> searches;
  for (int t = 0; t < std::max(1, context.threads); ++t)
    searches.emplace_back(mesh, graph, field, params.drift_weight, max_cost);
  Pool pool(mesh);
  trace_in_rounds(terminal_nodes(mesh, graph, params.border_seeds), pool, searches, context,
                  [](PathSearch& search, int node) { return search.from_terminal(node); });
  trace_in_rounds(interior_nodes(mesh, graph, field, params.seeds), pool, searches, context,
                  [](PathSearch& search, int node) { return search.through(node); });
  return pool.take();
}

}  // namespace sheetform
