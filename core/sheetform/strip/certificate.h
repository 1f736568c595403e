// The certificate of a result: every promise recomputed from the result itself (design.md section 2).
#pragma once
#include <string>
#include <vector>

#include "sheetform/base/run_context.h"
#include "sheetform/mesh/closest_point.h"
#include "sheetform/strip/height_bound.h"
#include "sheetform/strip/strip_mesh.h"

namespace sheetform {

/// One broken promise. `check` is the judge's name of it: "S2" topology, "S3" disks without inner vertices,
/// "S4" boundary, corners, sides, "S5" arches, "S6" isometry, "S7" injective layout, "S8" rulings, "S9" no
/// degeneracy.
struct Defect {
  std::string check;
  std::string text;
  int patch = -1;                   ///< -1: not of one patch
  Vector3 place = Vector3::Zero();  ///< in 3D, units of the uploaded mesh
};

/// A point of the strips and the point of the input that belongs to it, far apart.
struct FarPlace {
  std::array<int, 3> triangle;  ///< StripMesh points
  Vector3 barycentric;
  Vector3 on_input;
  double distance;
};

/// The distance between input and result, measured both ways; lengths in units of the uploaded mesh.
struct DistanceReport {
  double input_to_result = 0, result_to_input = 0;  ///< largest distance found each way
  double at_most = 0;                               ///< proven: no point of either is farther from the other
  double mean = 0;                                  ///< mean of the two area-weighted one-way means
  double hausdorff() const { return input_to_result > result_to_input ? input_to_result : result_to_input; }
  Vector3 worst_place =
      Vector3::Zero();  ///< where hausdorff() is attained (point on the side it starts from)
  std::vector<double>
      patch_error;            ///< per patch: the largest distance found from it, or to it from the input
  std::vector<FarPlace> far;  ///< per strip triangle and direction the worst place beyond a limit
};

/// Angles between the normals of input and result at closest points, in degrees; samples are area-uniform.
struct NormalReport {
  static constexpr double kShare = 0.95;  ///< of the area: what the quantiles leave out is the rest
  double mean = 0;                        ///< mean of the two one-way means
  double quantile = 0;                    ///< kShare of the area keep to it; the larger of both ways
  std::vector<double> patch_quantile;     ///< the same of each patch's own samples
  double worst = 0;                       ///< the largest of patch_quantile
  Vector3 worst_place = Vector3::Zero();  ///< where it is attained
};

struct Certificate {
  std::vector<Defect> defects;  ///< empty = all strict checks hold
  double isometry_error = 0;    ///< max | |uv edge| - |edge| | / patch size
  DistanceReport distance;
  NormalReport normals;
  bool strict() const { return defects.empty(); }
};

/// Defects of the structure and of the flat layout (S2 to S9). `input`: the welded input surface, its
/// topology is compared when `compare_topology`. max_sides: 2..6. Cost O(n log n).
std::vector<Defect> check_structure(const StripMesh& result, const SurfaceMesh* input, int max_sides,
                                    double bbox_diagonal, double* isometry_error = nullptr,
                                    const RunContext& context = {});

/// How far the strips of one component show their outside where the surface does: mean cosine between the
/// normals of both at nearest points, -1 to 1. `tree`: of the surface. Two walls that are nearer to each
/// other than the strips to either are told apart by chance: about 0. O(n log n).
double facing(const StripMesh& result, const TriangleSoup& surface, const ClosestPointTree& tree);

/// Whether the sides of a surface can be told apart by what is nearest: not where it is a sheet without
/// thickness (2 volume / area below 1e-4 of its diagonal) that is closed to have two sides. O(faces).
bool has_thickness(const TriangleSoup& surface);

/// Defects of one patch alone that only need its own triangles: S3, S6, S7, S8 and its part of S9.
/// Used inside the search before a patch is committed.
std::vector<Defect> check_patch(const StripMesh& result, int patch, double bbox_diagonal);

/// Samples each way for a certificate.
constexpr int kCertificateSamples = 10000;
/// Splits each way of the search for the largest distance: ten times what e_max 2 % takes, twice what 0.5 %
/// does.
constexpr int kCertificateSplits = 300000;

/// Two-sided distance. The mean is that of `samples` area-uniform points each way (deterministic), the
/// largest is found by branch and bound: at_most tells how far the search between vertices and samples was
/// brought. promised: once that is proven, fewer splits do.
/// tree: of the input's faces. Cost O(n + samples) queries and up to kCertificateSplits.
DistanceReport measure_distance(const std::vector<Vector3>& points,
                                const std::vector<std::array<int, 3>>& faces, const ClosestPointTree& tree,
                                const StripMesh& result, int samples, RunContext& context,
                                double promised = 0);
DistanceReport measure_distance(const TriangleSoup& input, const ClosestPointTree& tree,
                                const StripMesh& result, int samples, RunContext& context,
                                double promised = 0);

/// Where the two are farther apart than `limit`, quicker: what is nearer is only known to be so (distances
/// told are then too small). Where at_most is
/// not above the limit there is no such place. On large inputs most faces are never looked at. tree,
/// over_input: of the input's faces.
DistanceReport find_far(const TriangleSoup& input, const ClosestPointTree& tree,
                        const HeightBound& over_input, const StripMesh& result, double limit,
                        RunContext& context);

/// Two-sided normal deviation from `samples` each way (deterministic). The input must be oriented like the
/// result. tree: of the input's faces.
NormalReport measure_normals(const std::vector<Vector3>& points, const std::vector<std::array<int, 3>>& faces,
                             const ClosestPointTree& tree, const StripMesh& result, int samples,
                             RunContext& context);

/// All of it; promised as for measure_distance(). Normals are measured against `repaired` where there is one:
/// it is oriented.
Certificate certify(const TriangleSoup& input, const SurfaceMesh* repaired, const StripMesh& result,
                    int max_sides, int samples, RunContext& context, double promised = 0);

}  // namespace sheetform
