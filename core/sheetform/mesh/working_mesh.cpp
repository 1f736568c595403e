#include "sheetform/mesh/working_mesh.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "sheetform/mesh/creases.h"
#include "sheetform/mesh/denoise.h"
#include "sheetform/mesh/far_vertices.h"
#include "sheetform/mesh/mesh_repair.h"
#include "sheetform/mesh/ragged_borders.h"

namespace sheetform {
namespace {

// Mean absolute curvature: the dihedral angles of the edges, weighted by length, over the area.
double mean_bending(const SurfaceMesh& mesh) {
  double sum = 0;
  for (int e = 0; e < mesh.edge_count(); ++e) {
    const auto& edge = mesh.edges[e];
    if (edge.border()) continue;
    sum += angle_between(mesh.face_normal_raw(edge.f0), mesh.face_normal_raw(edge.f1)) * mesh.edge_length(e);
  }
  return sum / std::max(surface_area(mesh), 1e-300);
}

constexpr int kMostFaces = 12000;

// Of a draft's working mesh. What facets leave of a tolerance goes with their squared edges, so with one over
// their number: with 3500 at 0.6 % eleven meshes took 4,800 parts and 188 s, as it is now 560 and 47.
int most_draft_faces(double e_max) { return std::clamp(static_cast<int>(70 / e_max), 3500, kMostFaces); }

// What is small beside the whole, and so beside the tolerance, needs fewer faces than a whole mesh at least:
// half of a diagonal, and a thirtieth of it for the tolerance.
constexpr double kSmall = 0.5, kFine = 0.03;
constexpr int kLeastFaces = 2500, kLeastOfDraft = 1200, kLeastOfSmall = 800;

// A draft is what is tried where all else ends without valid strips: it is to have another mesh.
int least_faces(const SurfaceMesh& mesh, const WorkingMeshParams& params) {
  if (params.draft) return kLeastOfDraft;
  const double size = bounding_box_diagonal(mesh.points);
  return size < kSmall && params.e_max > kFine * size ? kLeastOfSmall : kLeastFaces;
}

// Working edge length: coarse enough to be quick, fine enough that facets cost a small share of the
// tolerance. A sixth shorter, 33 meshes take as many parts at 2 % and 6 % more time.
double working_edge_length(const SurfaceMesh& mesh, const WorkingMeshParams& params) {
  const double e_max = params.e_max;
  const double smooth = 0.0264 * std::sqrt(e_max / 0.02),
               curved = std::sqrt(0.72 * e_max / std::max(mean_bending(mesh), 1e-9));
  const int most = params.draft ? most_draft_faces(e_max) : kMostFaces;
  return std::clamp(std::min(smooth, curved), edge_length_for(mesh, most),
                    edge_length_for(mesh, least_faces(mesh, params)));
}

// Whether a vertex of the input is farther than `limit` from the working mesh.
bool loses_detail(const SurfaceMesh& input, const ClosestPointTree& input_tree, const SurfaceMesh& working,
                  double limit, const RunContext& context) {
  const ClosestPointTree tree(working.points, working.faces, context);
  const std::vector<FarVertex> may_be_far = far_vertices(input.faces, input_tree, tree, limit, context);
  return std::any_of(may_be_far.begin(), may_be_far.end(), [&](const FarVertex& v) {
    return tree.closest(input.points[v.vertex], limit * limit, limit * limit).face < 0;
  });
}

// Height below which triangles say nothing about creases, and the size of meshes for which it is meant: on
// smaller ones it is less.
constexpr double kSliver = 5e-4, kSliverSize = 0.2;
// Width of a region between creases that no part needs to have of its own, in tolerances.
constexpr double kNarrow = 0.5;
// Degrees: remeshing keeps edges that are sharper, whatever is asked for as a crease; coarse triangles across
// them would cut them off.
constexpr double kSharp = 40;
// Multiples of the wanted edge length between which a mesh is made finer although remeshing loses detail:
// with 2.4 parts of single triangles missed 0.5 %. Above, the tolerance asks for the facets themselves, with
// vertices inside of them for paths to run along; an edge where two of them are so many tolerances from one
// straight sheet is a crease then.
constexpr double kTooCoarse = 2, kFacets = 4, kNoSheet = 5;
// In tolerances: of the input's points the working mesh misses none by more, or it is made anew.
constexpr double kMostLost = 0.3;
// What noise may take of a tolerance (all but the worst percent of it). Finer than that it is not smoothed
// away: the rest could not hold what was left out.
constexpr double kMostNoise = 0.7;

// The creases, and the edges of facets that no strip could cross.
std::vector<char> with_facets(const SurfaceMesh& mesh, std::vector<char> crease_edge, double e_max) {
  for (int e = 0; e < mesh.edge_count(); ++e) {
    const auto& edge = mesh.edges[e];
    if (edge.border()) continue;
    const Vector3 left = mesh.face_normal_raw(edge.f0), right = mesh.face_normal_raw(edge.f1);
    const double across = std::min(left.norm(), right.norm()) / mesh.edge_length(e);
    crease_edge[e] |= across * std::sin(angle_between(left, right) / 2) / 2 > kNoSheet * e_max;
  }
  return crease_edge;
}

// The mesh without its noise; nothing where it has none, or too much for the tolerance.
std::optional<SurfaceMesh> without_noise(const SurfaceMesh& input, double e_max, const RunContext& context) {
  if (!is_noisy(input)) return std::nullopt;
  SurfaceMesh calm = denoised(input, context);
  std::vector<double> moved;
  for (int v = 0; v < input.vertex_count(); ++v) moved.push_back((calm.points[v] - input.points[v]).norm());
  const auto large = moved.begin() + static_cast<std::ptrdiff_t>(moved.size() - 1 - moved.size() / 100);
  std::nth_element(moved.begin(), large, moved.end());
  if (*large > kMostNoise * e_max) return std::nullopt;
  return calm;
}

// may_stay: where it is even it needs no remeshing.
PreparedMesh working_mesh_of_calm(const SurfaceMesh& input, const ClosestPointTree& tree, bool may_stay,
                                  const WorkingMeshParams& params, const RunContext& context) {
  const double sliver = kSliver * std::min(1.0, bounding_box_diagonal(input.points) / kSliverSize);
  const SurfaceMesh mesh = uniform_enough(input) ? input : without_slivers(input, sliver, context);
  context.checkpoint();
  const std::vector<char> crease = without_narrow_regions(
      mesh, detect_creases(mesh, std::min(params.crease_angle.value_or(kSharp), kSharp), context),
      kNarrow * params.e_max);
  context.checkpoint();
  double wanted = working_edge_length(mesh, params);
  const double present = mean_edge_length(mesh);
  may_stay = may_stay && uniform_enough(mesh);
  if (may_stay && present > 0.75 * wanted && present < 1.4 * wanted) return {mesh, crease, false};
  const double finest = edge_length_for(mesh, 20000), coarseness = present / wanted;
  context.checkpoint();
  PreparedMesh prepared = prepare(mesh, crease, wanted, input, tree, context);
  const int attempts = params.draft ? 1 : 2;
  for (int attempt = 0; attempt < attempts && (attempt == 0 || wanted > finest) &&
                        loses_detail(input, tree, prepared.mesh, kMostLost * params.e_max, context);
       ++attempt) {
    if (may_stay && coarseness > kFacets)
      return with_short_edges(mesh, with_facets(mesh, crease, params.e_max), present / coarseness, context);
    wanted = std::max(0.65 * wanted, finest);
    if (may_stay && present > 0.75 * wanted && coarseness < kTooCoarse) return {mesh, crease, false};
    prepared = prepare(mesh, crease, wanted, input, tree, context, kMostLost * params.e_max);
  }
  return prepared;
}

// With the sharp edges as creases.
PreparedMesh with_sharp_edges(const SurfaceMesh& input, const ClosestPointTree& tree,
                              const WorkingMeshParams& params, const RunContext& context) {
  const auto even = without_ragged_borders(input, tree, kMostBorderShift * params.e_max, context);
  const auto calm = without_noise(even ? *even : input, params.e_max, context);
  if (!even && !calm) return working_mesh_of_calm(input, tree, true, params, context);
  const SurfaceMesh& mesh = calm ? *calm : *even;
  const ClosestPointTree own(mesh.points, mesh.faces, context);
  return working_mesh_of_calm(mesh, own, !even, params, context);
}

}  // namespace

PreparedMesh working_mesh(const SurfaceMesh& input, const ClosestPointTree& tree,
                          const WorkingMeshParams& params, const RunContext& context) {
  PreparedMesh prepared = with_sharp_edges(input, tree, params, context);
  std::vector<char>& crease = prepared.crease_edge;
  if (!params.crease_angle) {
    std::fill(crease.begin(), crease.end(), 0);
  } else if (*params.crease_angle > kSharp) {
    const std::vector<char> sharper = detect_creases(prepared.mesh, *params.crease_angle, context);
    for (std::size_t e = 0; e < crease.size(); ++e) crease[e] &= sharper[e];
  }
  return prepared;
}

}  // namespace sheetform
