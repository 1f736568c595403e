// Planes of mirror symmetry, and the half of a mesh on one side of a plane.
#pragma once
#include <vector>

#include "sheetform/base/run_context.h"
#include "sheetform/mesh/closest_point.h"
#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// The plane normal . x = offset, and how well the mesh's mirror image fits the mesh.
struct SymmetryPlane {
  Vector3 normal = Vector3::UnitX();  ///< unit; its largest component is positive
  double offset = 0;
  double mean_distance = 0;  ///< of mirrored samples to the mesh, as a fraction of the diagonal
  double p99_distance = 0;   ///< 99th percentile of the same
};

/// All planes found for which the mirror image is within 0.2 % of the diagonal in the mean and 1 % for 99 %
/// of the samples, best first, at most eight that differ by more than two degrees or half a percent (a sphere
/// has no end of them). Candidates: principal axes through the centre of area, and planes that many pairs of
/// samples vote for; each is refined by iterated closest points (method: mirrored samples, closest points,
/// best mirror plane of the pairs). `tree` is of `mesh`. About 0.2 s for 10 k faces; deterministic.
std::vector<SymmetryPlane> detect_symmetry(const SurfaceMesh& mesh, const ClosestPointTree& tree,
                                           const RunContext& context);

/// How well the mesh's mirror image in a given plane fits: the two distances filled in.
SymmetryPlane measure_symmetry(const SurfaceMesh& mesh, const ClosestPointTree& tree, const Vector3& normal,
                               double offset);

struct HalfMesh {
  SurfaceMesh mesh;
  std::vector<char> crease_edge;  ///< by edge of `mesh`; edges on the plane are border
  std::vector<char> on_plane;     ///< by vertex: exactly on the plane
};

/// The part with normal . x >= offset, cut exactly: vertices nearer to the plane than `snap` edge lengths
/// move onto it along the normal, other edges that cross it get a vertex there. Faces in the plane itself are
/// dropped. crease_edge: by edge, empty = none. Throws Error kInvalidParameter when nothing lies on that
/// side.
HalfMesh cut_half(const SurfaceMesh& mesh, const std::vector<char>& crease_edge, const Vector3& normal,
                  double offset, double snap = 0.1);

/// What of a half lies on its plane of symmetry x = 0, by edge and by vertex.
struct PlaneBorder {
  std::vector<char> edge, vertex;
};

/// The border edges whose ends are nearer than `reach` to x = 0, and these ends, which are moved onto it.
PlaneBorder plane_border(SurfaceMesh& half, double reach);

/// The half x >= 0 and its mirror image, glued along the plane x = 0: vertices of `half` first, in their
/// order.
SurfaceMesh with_mirror_image(const SurfaceMesh& half, const PlaneBorder& plane);

}  // namespace sheetform
