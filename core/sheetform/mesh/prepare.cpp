#include "sheetform/mesh/prepare.h"

#include <algorithm>
#include <cmath>

#include "sheetform/base/error.h"
#include "sheetform/mesh/feature_lines.h"
#include "sheetform/mesh/mesh_repair.h"
#include "sheetform/mesh/remesher.h"
#include "sheetform/mesh/subdivide.h"

namespace sheetform {
namespace {

constexpr double kMostVariation = 0.35;  // standard deviation / mean of edge lengths
constexpr double kLeastAngle = 10;       // degrees: of all but the worst percent of triangles
constexpr double kMostLong = 4;          // longest edge / mean edge
constexpr double kBend = 0.5;            // of the wanted length: over this much a line's bends are judged
constexpr int kMostSweeps = 20, kMostVertices = 200'000;  // of with_short_edges

double least_angle(const SurfaceMesh& mesh, int f) {
  double least = 180;
  for (int k = 0; k < 3; ++k) {
    const Vector3& a = mesh.points[mesh.faces[f][k]];
    const Vector3 b = mesh.points[mesh.faces[f][(k + 1) % 3]] - a,
                  c = mesh.points[mesh.faces[f][(k + 2) % 3]] - a;
    least = std::min(least, angle_between(b, c) * 180 / M_PI);
  }
  return least;
}

int euler(const SurfaceMesh& m) { return m.vertex_count() - m.edge_count() + m.face_count(); }

bool same_topology(const SurfaceMesh& a, const SurfaceMesh& b) {
  return euler(a) == euler(b) && count_border_loops(a) == count_border_loops(b) &&
         face_components(a).second == face_components(b).second;
}

bool is_stop(const Error& e) {
  return e.code() == ErrorCode::kCancelled || e.code() == ErrorCode::kDeadlineExceeded;
}

}  // namespace

bool uniform_enough(const SurfaceMesh& mesh) {
  if (mesh.edges.empty()) return true;
  const double mean = mean_edge_length(mesh);
  double variance = 0, longest = 0;
  for (int e = 0; e < mesh.edge_count(); ++e) {
    const double length = mesh.edge_length(e);
    variance += (length - mean) * (length - mean) / mesh.edge_count();
    longest = std::max(longest, length);
  }
  int thin = 0;
  for (int f = 0; f < mesh.face_count(); ++f) thin += least_angle(mesh, f) < kLeastAngle;
  return std::sqrt(variance) <= kMostVariation * mean && longest <= kMostLong * mean &&
         100 * thin <= mesh.face_count();
}

double edge_length_for(const SurfaceMesh& mesh, int faces) {
  return std::sqrt(surface_area(mesh) / (std::max(1, faces) * std::sqrt(3.0) / 4));
}

SurfaceMesh without_slivers(const SurfaceMesh& input, double height, const RunContext& context) {
  try {
    const double length = height / 0.8;  // see Remesher::clean
    const FeatureLines borders = feature_lines(input, {}, length);
    Remesher remesher(input, borders, length, context);  // cleaning projects nothing
    remesher.clean();
    std::vector<char> creases;
    SurfaceMesh result = remesher.result(creases);
    if (same_topology(input, result)) return result;
  } catch (const Error& e) {
    if (is_stop(e)) throw;
  }
  return input;
}

PreparedMesh prepare(const SurfaceMesh& input, const std::vector<char>& crease_edge,
                     double target_edge_length, const RunContext& context) {
  return prepare(input, crease_edge, target_edge_length, input,
                 ClosestPointTree(input.points, input.faces, context), context);
}

PreparedMesh prepare(const SurfaceMesh& input, const std::vector<char>& crease_edge,
                     double target_edge_length, const SurfaceMesh& surface, const ClosestPointTree& tree,
                     const RunContext& context, double most_loss) {
  try {
    const FeatureLines lines = feature_lines(input, crease_edge, kBend * target_edge_length);
    Remesher remesher(input, lines, target_edge_length, context, most_loss);
    remesher.run(surface, tree);
    PreparedMesh result;
    result.mesh = remesher.result(result.crease_edge);
    result.remeshed = true;
    if (same_topology(input, result.mesh)) return result;
  } catch (const Error& e) {
    if (is_stop(e)) throw;  // all else: not built or not manifold, the fallback stands in
  }
  return with_short_edges(input, crease_edge, target_edge_length, context);
}

PreparedMesh with_short_edges(const SurfaceMesh& input, const std::vector<char>& crease_edge, double length,
                              const RunContext& context) {
  PreparedMesh result{input, crease_edge, false};
  result.crease_edge.resize(input.edges.size(), 0);
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    context.checkpoint();
    std::vector<EdgePoint> middles;
    for (int e = 0; e < result.mesh.edge_count(); ++e) {
      const auto& edge = result.mesh.edges[e];
      if (result.mesh.edge_length(e) > 1.5 * length)
        middles.push_back({e, (result.mesh.points[edge.v0] + result.mesh.points[edge.v1]) / 2});
    }
    if (middles.empty() || result.mesh.points.size() + middles.size() > kMostVertices) break;
    Subdivision finer = insert_vertices(result.mesh, result.crease_edge, middles);
    result.mesh = std::move(finer.mesh);
    result.crease_edge = std::move(finer.crease_edge);
  }
  return result;
}

}  // namespace sheetform
