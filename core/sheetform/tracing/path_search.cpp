#include "sheetform/tracing/path_search.h"

#include <algorithm>
#include <functional>

namespace sheetform {

Frontier::Frontier(const TracingGraph& graph)
    : graph_(&graph),
      stamp_(graph.node_count(), 0),
      cost_(graph.node_count()),
      father_node_(graph.node_count()),
      father_arc_(graph.node_count()) {}

void Frontier::clear() {
  ++now_;
  source_ = -1;
  heap_.clear();
}

void Frontier::start(int source, double drift_weight) {
  clear();
  source_ = source;
  for (int a = graph_->arc_begin[source]; a < graph_->arc_begin[source + 1]; ++a)
    push(graph_->arcs[a].to, arc_cost(graph_->arcs[a], drift_weight), source, a);
}

bool Frontier::push(int node, double cost, int father_node, int father_arc) {
  if (this->cost(node) <= cost) return false;
  stamp_[node] = now_;
  cost_[node] = cost;
  father_node_[node] = father_node;
  father_arc_[node] = father_arc;
  heap_.emplace_back(cost, node);
  std::push_heap(heap_.begin(), heap_.end(), std::greater<>());
  return true;
}

double Frontier::top() {
  while (!heap_.empty() && heap_.front().first > cost_[heap_.front().second]) {
    std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
    heap_.pop_back();
  }
  return heap_.empty() ? kFar : heap_.front().first;
}

int Frontier::pop() {
  const int node = heap_.front().second;
  std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
  heap_.pop_back();
  return node;
}

void Frontier::expand(int node, double drift_weight) {
  const double base = cost(node);
  for (int a = graph_->arc_begin[node]; a < graph_->arc_begin[node + 1]; ++a)
    push(graph_->arcs[a].to, base + arc_cost(graph_->arcs[a], drift_weight), node, a);
}

Walk Frontier::walk_to(int node, const PathBuilder& builder) const {
  std::vector<int> arcs;
  int at = node;
  do {
    if (father_arc_[at] < 0) break;
    arcs.push_back(father_arc_[at]);
    at = father_node_[at];
  } while (at != source_);
  Walk walk;
  walk.steps.push_back({TracingGraph::vertex(at), static_cast<signed char>(at & 3)});
  for (auto it = arcs.rbegin(); it != arcs.rend(); ++it) builder.append(graph_->arcs[*it], walk);
  return walk;
}

namespace {

// `back` runs from the same start in the opposite sense. As a loop both end at the same place: that step and
// the start are kept once.
Walk joined(const Walk& forward, const Walk& back, bool loop) {
  Walk out = loop ? forward : reversed(back);
  const Walk rest = loop ? reversed(back) : forward;
  out.steps.insert(out.steps.end(), rest.steps.begin() + 1, rest.steps.end() - (loop ? 1 : 0));
  out.length += rest.length;
  out.drift_length += rest.drift_length;
  return out;
}

}  // namespace

PathSearch::PathSearch(const SurfaceMesh& mesh, const TracingGraph& graph, const CrossField& field,
                       double drift_weight, double max_cost)
    : builder_{mesh, graph, field},
      drift_weight_(drift_weight),
      max_cost_(max_cost),
      front_{Frontier(graph), Frontier(graph)} {}

double PathSearch::Meeting::best() const { return std::min(loop_cost, end_cost[0] + end_cost[1]); }

// Settles one node of a side. Both sides run over nodes in their own sense of travel: a node of one is the
// opposite node of the other.
void PathSearch::step(int side, Meeting& meeting) {
  Frontier &here = front_[side], &there = front_[1 - side];
  const int node = here.pop();
  if (builder_.graph.terminal[TracingGraph::vertex(node)]) {
    if (meeting.end[side] >= 0) return;
    meeting.end[side] = node;
    meeting.end_cost[side] = here.cost(node);
    return;
  }
  const double whole = here.cost(node) + there.cost(TracingGraph::opposite(node));
  if (whole < meeting.loop_cost) {
    meeting.loop_cost = whole;
    meeting.loop_node = side == 0 ? node : TracingGraph::opposite(node);
  }
  if (node != here.source()) here.expand(node, drift_weight_);
}

Path PathSearch::through(int node) {
  front_[0].start(node, drift_weight_);
  front_[1].start(TracingGraph::opposite(node), drift_weight_);
  Meeting meeting;
  for (;;) {
    const double top[2] = {front_[0].top(), front_[1].top()};
    // No path that is still to be found is cheaper than this.
    double bound = 0;
    for (int side : {0, 1}) bound += top[side] < Frontier::kFar ? top[side] : meeting.end_cost[side];
    if (bound >= std::min(meeting.best(), max_cost_)) break;
    step(top[0] <= top[1] ? 0 : 1, meeting);
  }
  last_cost_ = meeting.best() > max_cost_ ? Frontier::kFar : meeting.best();
  if (last_cost_ >= Frontier::kFar) return {};
  const bool loop = meeting.loop_cost <= meeting.best();
  const int tail = loop ? meeting.loop_node : meeting.end[0];
  const int head = loop ? TracingGraph::opposite(meeting.loop_node) : meeting.end[1];
  return builder_.finish(joined(front_[0].walk_to(tail, builder_), front_[1].walk_to(head, builder_), loop),
                         loop);
}

Path PathSearch::from_terminal(int node) {
  Frontier& front = front_[0];
  front.start(node, drift_weight_);
  while (front.top() <= max_cost_) {
    const int at = front.pop();
    const int v = TracingGraph::vertex(at);
    if (v == TracingGraph::vertex(node)) continue;
    if (builder_.graph.terminal[v]) return builder_.finish(front.walk_to(at, builder_), false);
    front.expand(at, drift_weight_);
  }
  return {};
}

}  // namespace sheetform
