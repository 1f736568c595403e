#include "sheetform/strip/certificate.h"

#include <algorithm>

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

// Of the input's faces, so that unused vertices do not count.
double diagonal_of(const TriangleSoup& soup) {
  Eigen::AlignedBox3d box;
  for (const auto& f : soup.faces)
    for (int i : f) box.extend(soup.points[i]);
  return box.isEmpty() ? 0.0 : box.diagonal().norm();
}

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
                                    double bbox_diagonal, double* isometry_error) {
  if (isometry_error) *isometry_error = 0;
  std::vector<Defect> out = check_indices(result);
  if (!out.empty()) return out;
  const Whole whole(result);
  append(out, check_surface(whole, input));
  append(out, check_boundaries(whole, max_sides));
  append(out, check_arches(whole));
  append(out, check_uv_owners(whole));
  for (std::size_t p = 0; p < whole.shapes.size(); ++p)
    append(out, check_alone(result, static_cast<int>(p), whole.shapes[p], bbox_diagonal, isometry_error));
  std::vector<int> rim;
  for (std::size_t v = 0; v < whole.valence.size(); ++v)
    if (whole.valence[v] > 0) rim.push_back(static_cast<int>(v));
  append(out, check_doubled_points(result, rim, bbox_diagonal));
  return out;
}

Certificate certify(const TriangleSoup& input, const SurfaceMesh* repaired, const StripMesh& result,
                    int max_sides, int samples, RunContext& context) {
  Certificate c;
  context.checkpoint();
  c.defects = check_structure(result, repaired, max_sides, diagonal_of(input), &c.isometry_error);
  if (std::any_of(c.defects.begin(), c.defects.end(), [](const Defect& d) { return d.check == "S1"; }))
    return c;
  const ClosestPointTree tree(input.points, input.faces, context);
  c.distance = measure_distance(input, tree, result, samples, context);
  c.normals = repaired ? measure_normals(repaired->points, repaired->faces, result, samples, context)
                       : measure_normals(input.points, input.faces, result, samples, context);
  return c;
}

}  // namespace sheetform
