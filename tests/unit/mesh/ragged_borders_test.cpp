#include "sheetform/mesh/ragged_borders.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "sheetform/mesh/working_mesh.h"
#include "support/shapes.h"

namespace sheetform {
namespace {

SurfaceMesh build(TriangleSoup s) { return build_surface_mesh(std::move(s.points), std::move(s.faces)); }

std::optional<SurfaceMesh> smoothed(const SurfaceMesh& mesh, double most) {
  return without_ragged_borders(mesh, ClosestPointTree(mesh.points, mesh.faces), most);
}

// Rows of equilateral triangles in the square of size 1, without every second one of the lowest row: a border
// of teeth. `lift` bends the sheet.
TriangleSoup saw(int teeth, double lift = 0) {
  const double edge = 1.0 / teeth, height = edge * std::sqrt(0.75);
  const int rows = static_cast<int>(1 / height);
  TriangleSoup soup;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= teeth; ++i) {
      const double x = edge * (i + 0.5 * (j % 2)), y = height * j;
      soup.points.emplace_back(x, y, lift * y * y);
    }
  const auto id = [&](int i, int j) { return j * (teeth + 1) + i; };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < teeth; ++i) {
      const bool even = j % 2 == 0;
      const std::array<int, 3> below = even ? std::array<int, 3>{id(i, j), id(i + 1, j), id(i, j + 1)}
                                            : std::array<int, 3>{id(i, j), id(i + 1, j), id(i + 1, j + 1)};
      const std::array<int, 3> above = even ? std::array<int, 3>{id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)}
                                            : std::array<int, 3>{id(i, j), id(i + 1, j + 1), id(i, j + 1)};
      if (j > 0) soup.faces.push_back(below);
      soup.faces.push_back(above);
    }
  // The lowest row has lost a vertex at its start.
  std::vector<int> id_of(soup.points.size(), -1);
  TriangleSoup used;
  for (auto& f : soup.faces)
    for (int& v : f) {
      if (id_of[v] < 0)
        id_of[v] = static_cast<int>(used.points.size()), used.points.push_back(soup.points[v]);
      v = id_of[v];
    }
  used.faces = soup.faces;
  return used;
}

bool is_in_middle(const Vector3& p) { return std::abs(p.x() - 0.5) < 0.3; }

// Degrees by which the border below turns in all, away from its ends.
double turning(const SurfaceMesh& mesh) {
  double sum = 0;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    if (!mesh.border_vertex[v] || mesh.points[v].y() > 0.5 || !is_in_middle(mesh.points[v])) continue;
    const Vector3& p = mesh.points[v];
    const Vector3 out = mesh.points[mesh.edges[*mesh.ring_begin_of(v)].other(v)] - p,
                  in = p - mesh.points[mesh.edges[*(mesh.ring_end_of(v) - 1)].other(v)];
    sum += angle_between(in, out) * 180 / shapes::kPi;
  }
  return sum;
}

TEST(RaggedBorders, TeethBecomeALine) {
  for (double lift : {0.0, 0.3}) {
    const SurfaceMesh rough = build(saw(30, lift));
    const double before = turning(rough), most = 0.02;  // teeth are 0.029 high
    const std::optional<SurfaceMesh> even = smoothed(rough, most);
    ASSERT_TRUE(even);
    EXPECT_GT(before, 17 * 2 * 110.0) << "120 degrees at every tip and between";
    EXPECT_LT(turning(*even), 0.2 * before);
    ASSERT_EQ(even->faces, rough.faces);
    const ClosestPointTree tree(rough.points, rough.faces);
    for (int v = 0; v < rough.vertex_count(); ++v) {
      EXPECT_LE((even->points[v] - rough.points[v]).norm(),
                rough.border_vertex[v] ? most + 1e-12 : 1.5 * most);
      if (std::abs(rough.points[v].y() - 0.6) < 0.1 && is_in_middle(rough.points[v])) {
        EXPECT_EQ(even->points[v], rough.points[v]) << "the rest stays";
      }
      if (!rough.border_vertex[v]) {
        EXPECT_LT(tree.closest(even->points[v]).squared_distance, 1e-12);
      }
    }
    for (int f = 0; f < rough.face_count(); ++f)
      EXPECT_GT(even->face_normal_raw(f).dot(rough.face_normal_raw(f)), 0) << "no triangle turns over";
  }
}

TEST(RaggedBorders, TeethLargerThanAllowedBecomeLower) {
  const SurfaceMesh rough = build(saw(12));  // 0.072 high
  const auto lowest_and_highest = [](const SurfaceMesh& m, double below) {
    std::pair<double, double> range{1, 0};
    for (int v = 0; v < m.vertex_count(); ++v)
      if (m.border_vertex[v] && m.points[v].y() < below && is_in_middle(m.points[v]))
        range = {std::min(range.first, m.points[v].y()), std::max(range.second, m.points[v].y())};
    return range.second - range.first;
  };
  const std::optional<SurfaceMesh> even = smoothed(rough, 0.01);
  ASSERT_TRUE(even);
  EXPECT_NEAR(lowest_and_highest(*even, 0.1), lowest_and_highest(rough, 0.1) - 0.02, 1e-3);
}

TEST(RaggedBorders, CleanOnesStayAsTheyAre) {
  for (const TriangleSoup& soup :
       {shapes::plane(12), shapes::cylinder(12, 6), shapes::cylinder(40, 10), shapes::saddle(16),
        shapes::helicoid(20, 20), shapes::sphere(6), shapes::comb(32, 4)})
    EXPECT_FALSE(smoothed(build(soup), 0.05));
}

TEST(RaggedBorders, AreLinesOfTheWorkingMesh) {
  SurfaceMesh rough = build(saw(30));
  const ClosestPointTree tree(rough.points, rough.faces);
  WorkingMeshParams params;
  params.e_max = 0.04;
  const PreparedMesh prepared = working_mesh(rough, tree, params, {});
  EXPECT_TRUE(prepared.remeshed) << "thin triangles are not left to the search";
  EXPECT_TRUE(uniform_enough(prepared.mesh));
  EXPECT_LT(turning(prepared.mesh), 0.2 * turning(rough));
}

}  // namespace
}  // namespace sheetform
