// From graph arcs to simple chains of mesh edges (method.md 3.7).
#pragma once
#include <vector>

#include "sheetform/tracing/tracing.h"

namespace sheetform {

/// A walk over the mesh as it comes out of a search: may still hold spikes and ears.
struct Walk {
  struct Step {
    int vertex;
    signed char dir;  ///< direction of travel
  };
  std::vector<Step> steps;
  double length = 0;        ///< of the arcs
  double drift_length = 0;  ///< sum of length * (drift / 45 degrees)^2
};

/// What expanding and cleaning read.
struct PathBuilder {
  const SurfaceMesh& mesh;
  const TracingGraph& graph;
  const CrossField& field;

  /// Appends the arc's chain and head to a walk that ends at the arc's tail.
  void append(const TracingGraph::Arc& arc, Walk& walk) const;
  /// Removes spikes, short cycles and ears; empty path when what remains is not simple, passes a terminal
  /// vertex, or comes back next to itself. For a loop the first step must not be repeated at the end.
  Path finish(Walk walk, bool loop) const;
};

/// The same walk in the opposite sense.
Walk reversed(const Walk& walk);

/// Cost of an arc: length * (1 + weight * (drift / 45)^2).
inline double arc_cost(const TracingGraph::Arc& arc, double drift_weight) {
  const double d = arc.drift / 45.0;
  return arc.length * (1 + drift_weight * d * d);
}

}  // namespace sheetform
