#include "pipeline/run.h"

#include "sheetform/mesh/mesh_repair.h"

namespace sheetform {
namespace {

std::string text_of(const std::vector<Defect>& defects) {
  std::string text;
  for (const Defect& d : defects)
    text += d.check + " patch " + std::to_string(d.patch) + ": " + d.text + "\n";
  return text;
}

double length_of(const StripMesh& strips, bool border) {
  double sum = 0;
  for (const StripMesh::Arch& a : strips.arches)
    for (std::size_t i = 0; (a.patches[1] < 0) == border && i + 1 < a.vertices.size(); ++i)
      sum += (strips.points[a.vertices[i + 1]] - strips.points[a.vertices[i]]).norm();
  return sum;
}

}  // namespace

void expect_sound(const TriangleSoup& soup, const Decomposition& result) {
  const RepairResult repaired = repair(soup);
  const double diagonal = bounding_box_diagonal(repaired.mesh.points);
  EXPECT_NEAR(result.bbox_diagonal, diagonal, 1e-9 * diagonal);
  EXPECT_EQ(result.input_vertices, static_cast<int>(soup.points.size()));
  EXPECT_EQ(result.input_faces, static_cast<int>(soup.faces.size()));
  double isometry = 0;
  const auto defects =
      check_structure(result.strips, &repaired.mesh, result.params.max_sides, diagonal, &isometry);
  EXPECT_TRUE(defects.empty()) << text_of(defects);
  EXPECT_TRUE(result.certificate.strict());
  EXPECT_LT(isometry, 1e-9);
  EXPECT_NEAR(result.report.isometry_error, isometry, 1e-12);
  const Report& r = result.report;
  EXPECT_EQ(r.patches, static_cast<int>(result.strips.patches.size()));
  EXPECT_NEAR(r.cut_length, length_of(result.strips, false) / diagonal, 1e-9);
  EXPECT_NEAR(r.border_length, length_of(result.strips, true) / diagonal, 1e-9);
  EXPECT_EQ(r.e_max_met, r.hausdorff <= result.params.e_max);
  EXPECT_LE(r.mean_distance, r.hausdorff);
  // Other samples than the run's own may find a little more.
  RunContext context;
  const ClosestPointTree tree(soup.points, soup.faces);
  const double again = measure_distance(soup, tree, result.strips, 30011, context).hausdorff() / diagonal;
  EXPECT_NEAR(r.hausdorff, again, 0.02 * result.params.e_max + 1e-9);
  EXPECT_TRUE(r.e_max_met || !r.notes.empty()) << "an unmet tolerance is told";
  for (const char* stage : {"prepare", "field", "trace", "insert", "remove", "final", "certify"})
    EXPECT_TRUE(r.timings.count(stage)) << stage;
}

}  // namespace sheetform
