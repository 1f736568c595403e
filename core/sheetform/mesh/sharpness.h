// How much the surface turns at an edge, and how much of that its surroundings turn too. Internal to mesh/.
#pragma once
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// Dihedral angles and how much of the turning nearby they are. Holds a reference to the mesh. O(n) to make.
class Sharpness {
 public:
  explicit Sharpness(const SurfaceMesh& mesh);
  /// In degrees; 0 at the border. Slivers take the normals of their neighbours.
  double dihedral(int e) const;
  /// Dihedral angle / angle between the mean normals of both sides, at most 3; of two radii (one and two edge
  /// lengths) the one nearer to 1. The surroundings end at edges of `barrier` degrees.
  double share(int e, double barrier) const;

 private:
  Vector3 side_normal(int e, int face, double radius, double barrier) const;

  const SurfaceMesh& mesh_;
  double mean_edge_;
  std::vector<Vector3> normals_, middles_;
};

}  // namespace sheetform
