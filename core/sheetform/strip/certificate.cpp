#include "sheetform/strip/certificate.h"

#include <algorithm>
#include <array>
#include <functional>

#include "sheetform/strip/certificate_checks.h"

namespace sheetform {

using namespace certificate;

namespace {

// Everything a patch says about itself but S1; `isometry` grows to the largest relative error.
std::vector<Defect> check_alone(const StripMesh& r, int patch, const PatchShape& shape, double diagonal,
                                double* isometry) {
  std::vector<Defect> out = check_disk(r, patch, shape);
  append(out, check_isometry(r, patch, isometry));
  append(out, check_flat(r, patch, shape, diagonal));
  append(out, check_rulings(r, patch, shape));
  append(out, check_triangles(r, patch, diagonal));
  return out;
}

std::vector<Defect> structure(const StripMesh& result, const SurfaceMesh* input, const ClosestPointTree& tree,
                              int max_sides, double bbox_diagonal, double* isometry_error,
                              const RunContext& context) {
  if (isometry_error) *isometry_error = 0;
  std::vector<Defect> out = check_indices(result);
  if (!out.empty()) return out;
  context.checkpoint();
  const Whole whole(result);
  append(out, check_surface(whole, input, tree));
  append(out, check_boundaries(whole, max_sides));
  append(out, check_arches(whole));
  append(out, check_uv_owners(whole));
  context.checkpoint();
  for (std::size_t p = 0; p < whole.shapes.size(); ++p)
    append(out, check_alone(result, static_cast<int>(p), whole.shapes[p], bbox_diagonal, isometry_error));
  context.checkpoint();
  std::vector<int> rim;
  for (std::size_t v = 0; v < whole.valence.size(); ++v)
    if (whole.valence[v] > 0) rim.push_back(static_cast<int>(v));
  append(out, check_doubled_points(result, rim, bbox_diagonal));
  return out;
}

// The same triangles one by one, however their corners are numbered.
bool same_triangles(const TriangleSoup& soup, const SurfaceMesh& mesh) {
  if (soup.faces.size() != mesh.faces.size()) return false;
  for (std::size_t f = 0; f < soup.faces.size(); ++f)
    for (int k = 0; k < 3; ++k)
      if (soup.points[soup.faces[f][k]] != mesh.points[mesh.faces[f][k]]) return false;
  return true;
}

// Of the input's faces, so that unused vertices do not count.
double diagonal_of(const TriangleSoup& soup) {
  Eigen::AlignedBox3d box;
  for (const auto& f : soup.faces)
    for (int i : f) box.extend(soup.points[i]);
  return box.isEmpty() ? 0.0 : box.diagonal().norm();
}

constexpr double kThin = 1e-4;  // of the diagonal of a component

}  // namespace

std::vector<Defect> check_patch(const StripMesh& result, int patch, double bbox_diagonal) {
  std::vector<Defect> out = check_patch_indices(result, patch);
  if (!out.empty()) return out;
  const PatchShape shape = shape_of(result.patches[patch]);
  out = check_alone(result, patch, shape, bbox_diagonal, nullptr);
  std::vector<int> rim;
  for (int i : shape.loop) rim.push_back(shape.vertices[i][0]);
  std::sort(rim.begin(), rim.end());
  rim.erase(std::unique(rim.begin(), rim.end()), rim.end());
  std::vector<Defect> doubled = check_doubled_points(result, rim, bbox_diagonal);
  for (Defect& d : doubled) d.patch = patch;
  append(out, std::move(doubled));
  return out;
}

std::vector<Defect> check_structure(const StripMesh& result, const SurfaceMesh* input, int max_sides,
                                    double bbox_diagonal, double* isometry_error, const RunContext& context) {
  const ClosestPointTree tree =
      input ? ClosestPointTree(input->points, input->faces, context) : ClosestPointTree();
  return structure(result, input, tree, max_sides, bbox_diagonal, isometry_error, context);
}

double facing(const StripMesh& result, const TriangleSoup& surface, const ClosestPointTree& tree) {
  double sum = 0, area = 0;
  for (const StripMesh::Patch& patch : result.patches)
    for (const StripMesh::Triangle& t : patch.triangles) {
      const Vector3 &a = result.points[t.v[0]], &b = result.points[t.v[1]], &c = result.points[t.v[2]];
      const Vector3 normal = (b - a).cross(c - a);
      const auto& near = surface.faces[tree.closest((a + b + c) / 3).face];
      const Vector3& p = surface.points[near[0]];
      sum += normal.dot((surface.points[near[1]] - p).cross(surface.points[near[2]] - p).stableNormalized());
      area += normal.norm();
    }
  return area > 0 ? sum / area : 0;
}

bool has_thickness(const TriangleSoup& surface) {
  if (surface.faces.empty()) return false;
  const Vector3 origin = surface.points[surface.faces[0][0]];
  Vector3 open = Vector3::Zero();  // of a closed surface the normals add up to nothing
  double area = 0, volume = 0;
  for (const auto& f : surface.faces) {
    const Vector3 a = surface.points[f[0]] - origin, b = surface.points[f[1]] - origin,
                  c = surface.points[f[2]] - origin;
    const Vector3 normal = (b - a).cross(c - a) / 2;
    open += normal, area += normal.norm(), volume += a.dot(normal) / 3;
  }
  return open.norm() > kThin * area || 2 * std::abs(volume) > kThin * area * diagonal_of(surface);
}

Certificate certify(const TriangleSoup& input, const SurfaceMesh* repaired, const StripMesh& result,
                    int max_sides, int samples, RunContext& context, double promised) {
  Certificate c;
  context.checkpoint();
  // Where repair only welded, one tree serves all, and no place is measured twice.
  const bool welded_only = repaired && same_triangles(input, *repaired);
  const std::vector<Vector3>& points = welded_only ? repaired->points : input.points;
  const std::vector<std::array<int, 3>>& faces = welded_only ? repaired->faces : input.faces;
  const ClosestPointTree tree(points, faces, context);
  const ClosestPointTree own = repaired && !welded_only
                                   ? ClosestPointTree(repaired->points, repaired->faces, context)
                                   : ClosestPointTree();
  const ClosestPointTree& repaired_tree = repaired && !welded_only ? own : tree;
  c.defects = check_indices(result);
  if (!c.defects.empty()) return c;  // nothing else may be asked
  SampleHits hits;
  const std::array<std::function<void()>, 3> parts{
      [&] { c.distance = measure_distance(points, faces, tree, result, samples, context, promised, hits); },
      [&] {
        c.defects = structure(result, repaired, repaired_tree, max_sides, diagonal_of(input),
                              &c.isometry_error, context);
      },
      [&] {
        if (&repaired_tree != &tree)
          c.normals =
              measure_normals(repaired->points, repaired->faces, repaired_tree, result, samples, context);
      }};
  parallel_for(context, static_cast<int>(parts.size()), [&](int i) { parts[i](); });
  if (&repaired_tree == &tree) c.normals = normals_at(points, faces, result, hits);
  return c;
}

}  // namespace sheetform
