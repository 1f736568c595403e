// The single checks behind certificate.h. Tolerances are a little stricter than the judge's, so that rounding
// between the two never decides; `bbox_diagonal` is the input's, lengths are in units of the uploaded mesh.
#pragma once
#include "sheetform/strip/certificate.h"
#include "sheetform/strip/patch_shape.h"

namespace sheetform::certificate {

constexpr double kIsometry = 0.9e-6;     ///< S6: of the patch's size
constexpr double kContact = 1.1e-9;      ///< S7: of the outline's diagonal
constexpr double kFullTurn = 1.1e-9;     ///< S7: radians that must be missing to a full turn
constexpr double kArea = 0.9e-6;         ///< S7: of the patch's area
constexpr double kPlanar = 0.9e-4;       ///< S8: of the patch's size
constexpr double kDegenerate = 1.01e-7;  ///< S9: of the input's diagonal

/// "S1": an index out of range, a number that is not finite. Nothing else may be asked of such a result.
std::vector<Defect> check_indices(const StripMesh& result);
std::vector<Defect> check_patch_indices(const StripMesh& result, int patch);

/// What one patch says about itself.
std::vector<Defect> check_disk(const StripMesh& result, int patch, const PatchShape& shape);  // S3
std::vector<Defect> check_isometry(const StripMesh& result, int patch, double* worst);        // S6
std::vector<Defect> check_flat(const StripMesh& result, int patch, const PatchShape& shape,
                               double diagonal);                                                 // S7
std::vector<Defect> check_rulings(const StripMesh& result, int patch, const PatchShape& shape);  // S8
std::vector<Defect> check_triangles(const StripMesh& result, int patch, double diagonal);        // S9

/// The whole result with what its connectivity says; built once.
struct Whole {
  const StripMesh& result;
  std::vector<PatchShape> shapes;
  std::vector<Triple> faces;  ///< of all patches in their order, by point
  std::vector<int> patch_of;  ///< of each face
  EdgeTable table;            ///< of faces
  Topology topology;
  std::vector<char>
      patch_edge;            ///< per edge: on the border, between patches, on a seam of a disk with itself
  std::vector<int> valence;  ///< per point: patch edges there
  explicit Whole(const StripMesh& strips);
};
/// S2. input: may be null, `tree` is of its faces then of no account.
std::vector<Defect> check_surface(const Whole& whole, const SurfaceMesh* input, const ClosestPointTree& tree);
std::vector<Defect> check_boundaries(const Whole& whole, int max_sides);  // S4
std::vector<Defect> check_arches(const Whole& whole);                     // S5
std::vector<Defect> check_uv_owners(const Whole& whole);                  // S7, across patches
std::vector<Defect> check_doubled_points(const StripMesh& result, const std::vector<int>& points,
                                         double diagonal);  // S9

/// The strips of all patches in their order as one surface.
struct Strips {
  std::vector<Triple> faces;
  std::vector<int> patch_of;  ///< of each face
  explicit Strips(const StripMesh& result);
};

struct AreaSample {
  Vector3 point;
  int face;
};
/// One point in each of `n` equal shares of the area; the same each time.
std::vector<AreaSample> area_samples(const std::vector<Vector3>& points,
                                     const std::vector<std::array<int, 3>>& faces, int n);

/// Samples of both surfaces, and the closest face of the other one to each (of all patches in their order;
/// -1 for none).
struct SampleHits {
  std::vector<AreaSample> on_input, on_result;
  std::vector<int> to_result, to_input;
};
/// measure_distance() that tells what its samples hit.
DistanceReport measure_distance(const std::vector<Vector3>& points,
                                const std::vector<std::array<int, 3>>& faces, const ClosestPointTree& tree,
                                const StripMesh& result, int samples, RunContext& context, double promised,
                                SampleHits& hits);
/// measure_normals() from what is known of the samples.
NormalReport normals_at(const std::vector<Vector3>& points, const std::vector<std::array<int, 3>>& faces,
                        const StripMesh& result, const SampleHits& hits);

/// A point of the patch to show to people.
Vector3 place_of(const StripMesh& result, int patch);
void append(std::vector<Defect>& to, std::vector<Defect> more);

}  // namespace sheetform::certificate
