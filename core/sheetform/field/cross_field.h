// Principal curvatures and the smooth curvature-aligned cross field (paper 4.1; method.md 1 and 2).
#pragma once
#include <complex>
#include <vector>

#include "sheetform/base/run_context.h"
#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// Per vertex. k_min is the curvature of smaller magnitude, k_max the larger; positive = convex seen from
/// outside.
struct CurvatureField {
  std::vector<Vector3> normal;            ///< unit
  std::vector<Vector3> dir_min, dir_max;  ///< unit, tangent, orthogonal; zero where no estimate exists
  std::vector<double> k_min, k_max;       ///< 1 / length
};

struct CurvatureParams {
  double radius_edges =
      4;  ///< neighbourhood: vertices within this many mean edge lengths (experiments.md Q1)
};
/// Quadric fit per vertex over a ball of connected vertices. Creases (edge ids) are not crossed.
CurvatureField principal_curvature(const SurfaceMesh& mesh, const std::vector<char>& crease_edge,
                                   const CurvatureParams& params, RunContext& context);

/// One cross per vertex: four unit tangent directions, direction(v, d) = dir[v] rotated by d * 90 degrees
/// about the normal (counter-clockwise seen from outside).
struct CrossField {
  std::vector<Vector3> normal;
  std::vector<Vector3> dir;         ///< direction 0
  std::vector<int> singular_faces;  ///< faces around which the cross does not close
  std::vector<int> singular_index;  ///< +1 or -1 (quarter turns) for each of them
  Vector3 direction(int v, int d) const {
    const Vector3 side = normal[v].cross(dir[v]);
    switch (d & 3) {
      case 0:
        return dir[v];
      case 1:
        return side;
      case 2:
        return -dir[v];
      default:
        return -side;
    }
  }
};

/// The direction 0..3 of the cross at v that is closest to the tangential part of w.
int closest_direction(const CrossField& field, int v, const Vector3& w);

struct FieldParams {
  double feature_length =
      0.1;  ///< Lf: alignment beats smoothness above this length, in bounding-box diagonals
  double curvature_scale = 5;  ///< anisotropy |k1-k2|*diagonal at which alignment reaches half its weight
  double border_weight = 10;
  int diffusion_rounds = 20;  ///< normalise-and-diffuse rounds
};
/// z^4 field on vertices with soft curvature alignment, hard at creases and borders. `guide`: optional
/// directions given by the user, one per vertex (zero = free); replaces the curvature alignment.
CrossField cross_field(const SurfaceMesh& mesh, const std::vector<char>& crease_edge,
                       const CurvatureField& curvature, const std::vector<Vector3>* guide,
                       const FieldParams& params, RunContext& context);

}  // namespace sheetform
