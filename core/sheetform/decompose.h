// The facade: a mesh and parameters go in, a certified decomposition comes out.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sheetform/base/error.h"
#include "sheetform/base/run_context.h"
#include "sheetform/bending.h"
#include "sheetform/mesh/guides.h"
#include "sheetform/mesh/mesh_audit.h"
#include "sheetform/mesh/surface_mesh.h"
#include "sheetform/morph/morph.h"
#include "sheetform/search/evaluation_counts.h"
#include "sheetform/strip/certificate.h"
#include "sheetform/strip/strip_mesh.h"
#include "sheetform/symmetric.h"

namespace sheetform {

enum class Effort { kDraft, kNormal, kThorough };
enum class SymmetryMode { kOff, kAuto, kPlane };

/// Every parameter of a decomposition. Defaults are held to proto/schemas/parameters.schema.json by a test.
struct DecomposeParams {
  double e_max = 0.02;             ///< tolerance as a fraction of the input's bounding-box diagonal, (0, 0.5]
  std::optional<double> e_max_mm;  ///< tolerance in millimetres instead; wins over e_max
  bool t_junctions = true;
  SymmetryMode symmetry = SymmetryMode::kOff;
  Plane plane;                                                   ///< used with SymmetryMode::kPlane
  int max_sides = 6;                                             ///< n of the paper, 3..6
  std::optional<double> crease_angle = 40;                       ///< degrees; none = creases off
  bool self_seams = true;                                        ///< a patch may be glued to itself
  std::optional<double> ruling_spacing_min, ruling_spacing_max;  ///< mm between ends of rulings on outlines
  std::optional<double> min_bend_radius;   ///< mm; sharper bends are reported, nothing else
  std::optional<double> normal_deviation;  ///< degrees; optional viability criterion
  Effort effort = Effort::kNormal;
  MorphKind morph = MorphKind::kReduced;
  double scale = 1;                   ///< millimetres for one unit of the mesh; target_size wins
  std::optional<double> target_size;  ///< longest side of the bounding box in millimetres
  std::uint64_t seed = 0;
  std::optional<std::string> material, up;  ///< recorded for who shows or exports the result, nothing else
};

/// A cross direction for each face or vertex given by the user (zero = free).
struct UserField {
  std::vector<Vector3> per_vertex;  ///< in the order of the file's vertices; empty when per_face is used
  std::vector<Vector3> per_face;
};

/// The uploaded mesh, as read.
struct InputMesh {
  TriangleSoup soup;
  std::string format;  ///< "obj", "stl", "ply", "off"
  std::string name;    ///< display name, may be empty
};

/// The progress message with which the certificate begins.
constexpr const char* kCertifying = "every promise is measured again";

/// What was measured of the run; lengths are fractions of the input's bounding-box diagonal.
struct Report {
  int patches = 0;
  double hausdorff = 0, mean_distance = 0, cut_length = 0, border_length = 0;
  double hausdorff_at_most = 0;  ///< proven: the true distance is not above it
  bool e_max_met = false;
  double isometry_error = 0;
  Vector3 worst_place = Vector3::Zero();         ///< units of the mesh
  double normal_mean = 0;                        ///< degrees between the normals of input and sheets
  double normal_deviation = 0;                   ///< degrees; 95 % of the area keep to it
  bool normal_deviation_met = true;              ///< also true where no limit was asked for
  Vector3 normal_worst_place = Vector3::Zero();  ///< units of the mesh
  BendReport bending;
  bool min_bend_radius_met = true;  ///< also true where none was asked for
  SpacingReport spacing;
  std::map<std::string, double> timings;  ///< seconds by stage name
  EvaluationCounts counts;                ///< of the search, all components and tries together
  std::vector<std::string> notes;         ///< for people: repairs, unmet tolerance and where, fallbacks used
};

struct Decomposition {
  StripMesh strips;
  DecomposeParams params;             ///< as in force: scale and e_max resolved
  UserGuides guides;                  ///< as given
  double bbox_diagonal = 0;           ///< of the input, units of the mesh
  std::optional<Plane> mirror_plane;  ///< of symmetric results: every point has its exact image
  int input_vertices = 0, input_faces = 0;
  MeshAudit audit;  ///< what was wrong with the input and what was repaired
  Certificate certificate;
  Report report;
};

/// Throws Error kInvalidParameter for values out of range (what, where = name, fix).
void validate(const DecomposeParams& params);

/// The whole pipeline. Every result has passed its own certificate. Same input, params, seed: same bytes.
/// `field`, `guides`: of the user, in the units of the mesh; may be null.
Decomposition decompose(const InputMesh& input, const DecomposeParams& params, const UserField* field,
                        RunContext& context, const UserGuides* guides = nullptr);

}  // namespace sheetform
