// Smooth cuts: moves the vertices of paths over the surface until the staircase of the mesh is gone
// (method.md 6).
#pragma once
#include <functional>
#include <limits>
#include <vector>

#include "sheetform/base/run_context.h"
#include "sheetform/mesh/closest_point.h"
#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

struct SmoothParams {
  /// Where all vertices of the mesh were before any path was smoothed; null: where they are now. With it the
  /// result is a function of these places and the paths alone: vertices go back when their path is gone, and
  /// calling again changes nothing. Without it loops shrink a little with every call.
  const std::vector<Vector3>* rest = nullptr;
  /// Waves along a path of this many edges are halved, shorter ones go, longer ones stay.
  double cutoff_edges = 24;
  /// Where a path vertex may go: (from, wanted) -> allowed, near the surface. Null: anywhere.
  std::function<Vector3(const Vector3&, const Vector3&)> allowed;
  int rounds = 4;            ///< the way is gone in this many parts, vertices around follow in each
  int relax_steps = 2;       ///< tangential Laplacian steps of the vertices around, in a round
  double min_quality = 0.1;  ///< 2 r_in / R_circ that no touched face may fall below
  double min_move = 0.03;    ///< in edges: path vertices nearer to their goal stay at rest
  double min_change = 0.01;  ///< in edges, with `rest`: what would change less does not change
  /// A vertex that stands out from those around by more than this leaves its place no farther than this from
  /// the mesh: with it a tip would go, or a ridge.
  double most_left = std::numeric_limits<double>::infinity();
};

/// Moves path vertices to where the paths bend least over the surface (path_fairing.h), and the other
/// vertices within two rings of moving ones by tangential relaxation; all are put back on `surface`. At
/// crossings both paths are straightened, T-junctions stay on their straight bar. Border vertices,
/// `fixed_vertex` and loose ends stay. Guarantee: no face ends up turned over (against its normal at rest) or
/// with quality below min_quality, except one that was so at rest, which does not get worse, and places
/// are left as most_left says; vertices go back towards where they were until that holds. Returns the
/// vertices that moved, ascending. Cost: about 1 ms for each 100 path vertices.
std::vector<int> smooth_paths(SurfaceMesh& mesh, const std::vector<char>& path_edge,
                              const std::vector<char>& fixed_vertex, const ClosestPointTree& surface,
                              const SmoothParams& params, RunContext& context);

/// 2 r_in / R_circ: 1 for an equilateral triangle, 0 for a degenerate one.
double radius_ratio(const Vector3& a, const Vector3& b, const Vector3& c);

}  // namespace sheetform
