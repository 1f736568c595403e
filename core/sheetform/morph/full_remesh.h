// One patch, cut along its rulings. Part of full_morph.
#pragma once
#include <vector>

#include "sheetform/morph/full_morph.h"
#include "sheetform/morph/full_walk.h"

namespace sheetform {

/// The places along one arch that become outline vertices of all its copies: mesh vertices, samples and ends
/// of rulings; ascending, each a little more than CutChart::kMerge edges from the next.
class ArchStops {
 public:
  ArchStops() = default;
  /// at: edge index + fraction, in any order; places near a mesh vertex or another place are moved to it.
  ArchStops(int edges, std::vector<double> at);
  int count() const { return static_cast<int>(at_.size()); }
  double at(int stop) const { return at_[stop]; }
  /// The stop that a place was moved to.
  int nearest(double at) const;

 private:
  std::vector<double> at_;
};

/// The patch's own vertices and chains, numbered from 0.
struct CutPatch {
  std::vector<Vector3> rest;
  std::vector<Vector2> uv;
  std::vector<double> isotropy;
  std::vector<std::array<int, 3>> triangles;
  std::vector<RuledMesh::Ruling> rulings;
  std::vector<std::vector<int>> sides;  ///< per stretch of the outline, in the arch's direction
  int dropped = 0;
};

/// isotropy: per mesh vertex, or empty.
CutPatch cut_patch(const SurfaceMesh& mesh, const Patch& patch, const RuledPatch& ruled,
                   const std::vector<ArchStops>& stops, const std::vector<double>& isotropy);

/// Triangulates a convex polygon that may have straight corners; the flattest triangle is as fat as can be.
/// Counter-clockwise or clockwise. O(n^3) for n corners.
void triangulate_convex(const std::vector<int>& polygon, const std::vector<Vector2>& uv,
                        std::vector<std::array<int, 3>>& triangles);

}  // namespace sheetform
