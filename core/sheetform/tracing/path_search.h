// Best-first search on the tracing graph: one frontier, or two that meet (method.md 3.4, 3.5).
#pragma once
#include <utility>
#include <vector>

#include "sheetform/tracing/path_building.h"

namespace sheetform {

/// One Dijkstra front. Arrays are kept between searches and invalidated by a stamp.
class Frontier {
 public:
  explicit Frontier(const TracingGraph& graph);
  void clear();
  /// The source is expanded but gets no label, so that a search may come back to it.
  void start(int source, double drift_weight);
  /// Gives a node a label if it is better than what it has.
  bool push(int node, double cost, int father_node, int father_arc);
  /// Cost of the cheapest open node; infinity when none is left.
  double top();
  /// Settles the cheapest open node and returns it. top() must be finite.
  int pop();
  void expand(int node, double drift_weight);
  int source() const { return source_; }
  /// Label of a node, infinity if it has none.
  double cost(int node) const { return stamp_[node] == now_ ? cost_[node] : kFar; }
  /// The walk from the source to a labelled node.
  Walk walk_to(int node, const PathBuilder& builder) const;
  static constexpr double kFar = 1e300;

 private:
  const TracingGraph* graph_;
  std::vector<int> stamp_;
  std::vector<double> cost_;
  std::vector<int> father_node_, father_arc_;
  std::vector<std::pair<double, int>> heap_;
  int now_ = 0;
  int source_ = -1;
};

/// Finds paths through or from given nodes. One object per thread.
class PathSearch {
 public:
  PathSearch(const SurfaceMesh& mesh, const TracingGraph& graph, const CrossField& field, double drift_weight,
             double max_cost);
  /// The cheapest path through an interior node: a loop, or a path whose two ends are terminal. Searches from
  /// the node in both senses at once. Empty when there is none within max_cost, or when it touches itself.
  Path through(int node);
  /// The cheapest path from a terminal node to another terminal vertex. Empty when there is none within
  /// max_cost.
  Path from_terminal(int node);
  /// Cost of the walk that the last call of through() found, before cleaning; infinity (kFar) when it found
  /// none.
  double last_cost() const { return last_cost_; }

 private:
  struct Meeting {
    double loop_cost = Frontier::kFar;
    int loop_node = -1;     // of the forward side
    int end[2] = {-1, -1};  // terminal nodes reached, each in its own sense
    double end_cost[2] = {Frontier::kFar, Frontier::kFar};
    double best() const;
  };
  void step(int side, Meeting& meeting);
  PathBuilder builder_;
  double drift_weight_, max_cost_;
  double last_cost_ = Frontier::kFar;
  Frontier front_[2];
};

}  // namespace sheetform
