// Symmetric decompositions: the plane, and the half that is solved and mirrored (paper 3.6 "symmetry").
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "sheetform/base/run_context.h"
#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// A plane normal . x = offset, in the units of the mesh; normal is unit.
struct Plane {
  Vector3 normal = Vector3::UnitX();
  double offset = 0;
};

/// The rigid motion that brings a plane to x = 0; along an axis it only permutes coordinates.
struct PlaneFrame {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< rows: the normal and two directions in the plane
  double offset = 0;
  Vector3 in(const Vector3& p) const { return axes * p - offset * Vector3::UnitX(); }
  Vector3 out(const Vector3& p) const { return axes.transpose() * (p + offset * Vector3::UnitX()); }
};
PlaneFrame plane_frame(const Plane& plane);

/// Why a mesh is not symmetric.
struct Asymmetry {
  std::string text;
  std::optional<Vector3> place;  ///< of the mesh, where it deviates most
};

/// One side of a symmetric mesh, x >= 0 in its frame, cut exactly at the plane.
struct SymmetricHalf {
  Plane plane;
  PlaneFrame frame;
  SurfaceMesh mesh;
  double deviation = 0;  ///< distance between the mesh and the half with its mirror image, both ways
};

/// The half of `mesh` on the positive side of the plane; none when the half with its image is another
/// surface: other components, border loops or holes, or farther than `reach` from the mesh (`why`).
/// `detail`: vertices that near to the plane are moved onto it.
std::optional<SymmetricHalf> symmetric_half(const SurfaceMesh& mesh, const Plane& plane, double reach,
                                            double detail, Asymmetry& why);

/// By face of the whole: which component of a half (of `count`, see face_components) and its image stand for
/// it, a surface that goes through the plane or one on each side of it. Both meshes are in the plane's frame.
/// O(n), and a few queries for each component of the whole.
std::vector<int> halves_of_whole(const SurfaceMesh& whole, const SurfaceMesh& half,
                                 const std::vector<int>& component, int count);

/// The half for the best plane that detect_symmetry finds: the mesh deviates by half of e_max at most,
/// and of planes alike the one with the shortest cut. None when there is no such plane. Cost: that of
/// detect_symmetry, and a cut and two distance fields for each of at most four planes.
std::optional<SymmetricHalf> find_symmetric_half(const SurfaceMesh& mesh, double e_max,
                                                 const RunContext& context);

}  // namespace sheetform
