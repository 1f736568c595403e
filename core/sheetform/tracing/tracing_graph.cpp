#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <utility>

#include "sheetform/field/tangent_frame.h"
#include "sheetform/tracing/tracing.h"

namespace sheetform {
namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846;

// Everything that the arcs of one vertex depend on.
struct GraphInput {
  const SurfaceMesh& mesh;
  const CrossField& field;
  const std::vector<char>& feature_edge;  // border or crease
  const std::vector<char>& terminal;
  const std::vector<char>& blocked;  // per node: leaving there would run along a feature
  double radius;
  double max_angle;        // degrees, below 90
  double largest_tangent;  // a little above that of max_angle
};

// Arcs of a run of vertices, with chain positions counted from the run's own beginning.
struct ArcBlock {
  std::vector<int> count;  // per node
  std::vector<TracingGraph::Arc> arcs;
  std::vector<int> chain;
};

std::vector<char> feature_edges(const SurfaceMesh& mesh, const std::vector<char>& crease_edge) {
  std::vector<char> feature(mesh.edges.size(), 0);
  for (int e = 0; e < mesh.edge_count(); ++e)
    feature[e] = mesh.edges[e].border() || (!crease_edge.empty() && crease_edge[e]);
  return feature;
}

std::vector<char> ends_of(const SurfaceMesh& mesh, const std::vector<char>& edge_set) {
  std::vector<char> vertex(mesh.points.size(), 0);
  for (int e = 0; e < mesh.edge_count(); ++e)
    if (edge_set[e]) vertex[mesh.edges[e].v0] = vertex[mesh.edges[e].v1] = 1;
  return vertex;
}

// Nodes that leave along a border or crease edge. A path must leave features across, never along them.
std::vector<char> blocked_nodes(const SurfaceMesh& mesh, const CrossField& field,
                                const std::vector<char>& feature_edge) {
  std::vector<char> blocked(4 * mesh.points.size(), 0);
  for (int e = 0; e < mesh.edge_count(); ++e) {
    if (!feature_edge[e]) continue;
    for (int v : {mesh.edges[e].v0, mesh.edges[e].v1}) {
      const Vector3 along = mesh.points[mesh.edges[e].other(v)] - mesh.points[v];
      blocked[TracingGraph::node(v, closest_direction(field, v, along))] = 1;
    }
  }
  return blocked;
}

// Shortest edge chains from one vertex to all within the radius, not through terminal vertices nor along
// features.
class LocalChains {
 public:
  explicit LocalChains(int vertices) : stamp_(vertices, 0), length_(vertices), father_(vertices) {}

  const std::vector<int>& run(const GraphInput& in, int source) {
    ++now_;
    reached_.clear();
    heap_.clear();
    set(source, 0, -1);
    while (!heap_.empty()) {
      const auto [length, v] = heap_.front();
      std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
      heap_.pop_back();
      if (length > length_[v]) continue;
      if (v != source) reached_.push_back(v);
      if (v == source || !in.terminal[v]) relax(in, v);
    }
    return reached_;
  }
  double length(int v) const { return length_[v]; }
  int father(int v) const { return father_[v]; }

 private:
  void set(int v, double length, int father) {
    stamp_[v] = now_;
    length_[v] = length;
    father_[v] = father;
    heap_.emplace_back(length, v);
    std::push_heap(heap_.begin(), heap_.end(), std::greater<>());
  }
  void relax(const GraphInput& in, int v) {
    for (const int* e = in.mesh.ring_begin_of(v); e != in.mesh.ring_end_of(v); ++e) {
      if (in.feature_edge[*e]) continue;
      const int w = in.mesh.edges[*e].other(v);
      const double length = length_[v] + in.mesh.edge_length(*e);
      if (length > in.radius || (stamp_[w] == now_ && length_[w] <= length)) continue;
      set(w, length, v);
    }
  }
  std::vector<int> stamp_;
  std::vector<double> length_;
  std::vector<int> father_, reached_;
  std::vector<std::pair<double, int>> heap_;
  int now_ = 0;
};

// Signed angle in degrees from direction d of v to w, seen against the normal, where it is not above the
// largest one allowed; most that are, a tangent tells.
std::optional<double> deviation(const GraphInput& in, int v, int d, const Vector3& w) {
  const Vector3 along = in.field.direction(v, d);
  const double x = along.dot(w), y = in.field.normal[v].cross(along).dot(w);
  if (std::abs(y) > in.largest_tangent * x) return std::nullopt;
  const double angle = std::atan2(y, x) * kDegrees;
  return std::abs(angle) > in.max_angle ? std::nullopt : std::optional(angle);
}

void append_chain(const LocalChains& chains, int source, int target, ArcBlock& out) {
  const auto begin = out.chain.size();
  for (int v = chains.father(target); v != source; v = chains.father(v)) out.chain.push_back(v);
  std::reverse(out.chain.begin() + static_cast<std::ptrdiff_t>(begin), out.chain.end());
}

// The arc from direction d of v to w, when the straight way there fits the field at both ends.
void try_arc(const GraphInput& in, const LocalChains& chains, int v, int d, int w, ArcBlock& out) {
  const Vector3 way = in.mesh.points[w] - in.mesh.points[v];
  const auto leaving = deviation(in, v, d, way);
  if (!leaving) return;
  const Vector3 carried = transport(in.field.direction(v, d), in.field.normal[v], in.field.normal[w]);
  const int target = TracingGraph::node(w, closest_direction(in.field, w, carried));
  // An arrival is a departure of the opposite node, turned round.
  if (in.blocked[TracingGraph::opposite(target)]) return;
  const auto arriving = deviation(in, w, target & 3, way);
  if (!arriving) return;
  TracingGraph::Arc arc{};
  arc.to = target;
  arc.length = static_cast<float>(chains.length(w));
  arc.drift = static_cast<float>(std::abs(*leaving + *arriving) / 2);
  arc.chain_begin = static_cast<int>(out.chain.size());
  append_chain(chains, v, w, out);
  arc.chain_end = static_cast<int>(out.chain.size());
  out.arcs.push_back(arc);
}

void add_arcs(const GraphInput& in, int v, LocalChains& chains, ArcBlock& out) {
  const std::vector<int>& reached = chains.run(in, v);
  for (int d = 0; d < 4; ++d) {
    const auto before = static_cast<std::ptrdiff_t>(out.arcs.size());
    if (!in.blocked[TracingGraph::node(v, d)])
      for (int w : reached) try_arc(in, chains, v, d, w, out);
    std::sort(out.arcs.begin() + before, out.arcs.end(),
              [](const TracingGraph::Arc& a, const TracingGraph::Arc& b) {
                return std::pair(a.drift, a.to) < std::pair(b.drift, b.to);
              });
    out.count.push_back(static_cast<int>(out.arcs.size() - before));
  }
}

void append_block(const ArcBlock& block, TracingGraph& graph) {
  const int offset = static_cast<int>(graph.chain.size());
  for (int count : block.count) graph.arc_begin.push_back(graph.arc_begin.back() + count);
  for (TracingGraph::Arc arc : block.arcs) {
    arc.chain_begin += offset;
    arc.chain_end += offset;
    graph.arcs.push_back(arc);
  }
  graph.chain.insert(graph.chain.end(), block.chain.begin(), block.chain.end());
}

}  // namespace

TracingGraph tracing_graph(const SurfaceMesh& mesh, const std::vector<char>& crease_edge,
                           const CrossField& field, const GraphParams& params, RunContext& context) {
  const std::vector<char> feature = feature_edges(mesh, crease_edge);
  const std::vector<char> blocked = blocked_nodes(mesh, field, feature);
  TracingGraph graph;
  graph.terminal = ends_of(mesh, feature);
  const GraphInput input{mesh,
                         field,
                         feature,
                         graph.terminal,
                         blocked,
                         params.radius_edges * mean_edge_length(mesh),
                         params.max_angle,
                         1.001 * std::tan(params.max_angle / kDegrees)};
  const int n = mesh.vertex_count(), block_size = 512, blocks = (n + block_size - 1) / block_size;
  std::vector<ArcBlock> parts(blocks);
  parallel_for(context, blocks, [&](int b) {
    context.checkpoint();
    LocalChains chains(n);
    for (int v = b * block_size; v < std::min(n, (b + 1) * block_size); ++v)
      add_arcs(input, v, chains, parts[b]);
  });
  graph.arc_begin.assign(1, 0);
  for (const ArcBlock& part : parts) append_block(part, graph);
  return graph;
}

}  // namespace sheetform
