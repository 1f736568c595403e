#include "sheetform/mesh/prepare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "sheetform/base/error.h"
#include "sheetform/mesh/closest_point.h"
#include "sheetform/mesh/creases.h"
#include "sheetform/mesh/mesh_repair.h"
#include "support/shapes.h"

namespace sheetform {
namespace {

SurfaceMesh build(TriangleSoup s) { return build_surface_mesh(std::move(s.points), std::move(s.faces)); }
int euler(const SurfaceMesh& m) { return m.vertex_count() - m.edge_count() + m.face_count(); }

// Largest distance of vertices and face centres of a from b.
double distance(const SurfaceMesh& a, const SurfaceMesh& b) {
  const ClosestPointTree tree(b.points, b.faces);
  double worst = 0;
  for (const Vector3& p : a.points) worst = std::max(worst, tree.closest(p).squared_distance);
  for (const auto& f : a.faces)
    worst = std::max(worst,
                     tree.closest((a.points[f[0]] + a.points[f[1]] + a.points[f[2]]) / 3).squared_distance);
  return std::sqrt(worst);
}

double least_angle(const SurfaceMesh& m) {
  double least = 180;
  for (const auto& f : m.faces)
    for (int k = 0; k < 3; ++k) {
      const Vector3 a = m.points[f[(k + 1) % 3]] - m.points[f[k]],
                    b = m.points[f[(k + 2) % 3]] - m.points[f[k]];
      least = std::min(least, std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / shapes::kPi);
    }
  return least;
}

double length_of(const SurfaceMesh& m, const std::vector<char>& edges) {
  double sum = 0;
  for (int e = 0; e < m.edge_count(); ++e)
    if (edges[e]) sum += m.edge_length(e);
  return sum;
}

double border_length(const SurfaceMesh& m) {
  double sum = 0;
  for (int e = 0; e < m.edge_count(); ++e)
    if (m.edges[e].border()) sum += m.edge_length(e);
  return sum;
}

void expect_good(const SurfaceMesh& in, const PreparedMesh& out, double length, double tolerance) {
  EXPECT_TRUE(out.remeshed);
  EXPECT_EQ(euler(out.mesh), euler(in));
  EXPECT_EQ(count_border_loops(out.mesh), count_border_loops(in));
  EXPECT_EQ(face_components(out.mesh).second, face_components(in).second);
  EXPECT_TRUE(uniform_enough(out.mesh));
  EXPECT_GT(least_angle(out.mesh), 15);
  EXPECT_NEAR(mean_edge_length(out.mesh), length, 0.25 * length);
  EXPECT_LT(distance(in, out.mesh), tolerance);
  EXPECT_LT(distance(out.mesh, in), tolerance);
}

TEST(Prepare, SmoothShapesFinerAndCoarser) {
  for (double length : {0.08, 0.15, 0.3}) {
    const SurfaceMesh torus = build(shapes::torus(60, 30));
    expect_good(torus, prepare(torus, {}, length, {}), length, 0.5 * length * length + 0.01);
    const SurfaceMesh saddle = build(shapes::saddle(12, 0.7));
    expect_good(saddle, prepare(saddle, {}, length, {}), length, 0.5 * length * length + 0.01);
  }
}

TEST(Prepare, SizeDoesNotMatter) {
  const int faces = prepare(build(shapes::torus(60, 30)), {}, 0.1, {}).mesh.face_count();
  for (double scale : {1e-6, 1e6}) {
    TriangleSoup s = shapes::torus(60, 30);
    for (Vector3& p : s.points) p *= scale;
    const PreparedMesh out = prepare(build(std::move(s)), {}, 0.1 * scale, {});
    EXPECT_TRUE(out.remeshed);
    EXPECT_NEAR(out.mesh.face_count(), faces, 0.02 * faces);
  }
}

TEST(Prepare, BoxesKeepTheirEdgesAndCornersExactly) {
  for (int n : {1, 5, 40}) {
    const SurfaceMesh box = build(shapes::box(n, {1, 2, 3}));
    const PreparedMesh out = prepare(box, detect_creases(box, 40), 0.15, {});
    expect_good(box, out, 0.15, 1e-9);
    EXPECT_NEAR(length_of(out.mesh, out.crease_edge), 24, 1e-9);
    EXPECT_EQ(out.crease_edge, detect_creases(out.mesh, 40));
    for (double x : {-0.5, 0.5})
      for (double y : {-1.0, 1.0})
        for (double z : {-1.5, 1.5})
          EXPECT_EQ(std::count(out.mesh.points.begin(), out.mesh.points.end(), Vector3(x, y, z)), 1);
  }
}

TEST(Prepare, BordersStayOnBorders) {
  const SurfaceMesh tube = build(shapes::cylinder(64, 3, 1, 2));
  const PreparedMesh out = prepare(tube, {}, 0.1, {});
  expect_good(tube, out, 0.1, 0.01);
  EXPECT_NEAR(border_length(out.mesh), 4 * shapes::kPi, 0.02);
  for (int v = 0; v < out.mesh.vertex_count(); ++v) {
    const double z = out.mesh.points[v].z();
    EXPECT_TRUE(!out.mesh.border_vertex[v] || std::min(std::abs(z), std::abs(z - 2)) < 1e-12);
  }
}

TEST(Prepare, JaggedBordersDoNotKeepEveryJag) {
  TriangleSoup s = shapes::plane(80);
  for (Vector3& p : s.points)
    if (p.x() == 0) p.x() = std::fmod(p.y() * 40, 1.0) < 0.5 ? -0.01 : 0;  // saw teeth of one edge
  const SurfaceMesh plane = build(std::move(s));
  const PreparedMesh out = prepare(plane, {}, 0.1, {});
  EXPECT_TRUE(out.remeshed);
  EXPECT_LT(out.mesh.face_count(), 500);
}

// A plate of seven lobes as a volume gives it: along its rims creases go by steps, and part at small angles.
// Where the bend of one was removed, its edge must not be split there again, in line with the corner of
// another: faces lay flat between the two, and no strips have such a part.
TEST(Prepare, CreasesThatGoByStepsLeaveNoFlatFaces) {
  const SurfaceMesh plate = build(shapes::isosurface(
      [](const Vector3& p) {
        const double rim = 0.75 + 0.25 * std::cos(7 * std::atan2(p.y(), p.x()));
        return std::max(std::abs(p.z()) - 0.16, std::hypot(p.x(), p.y()) - rim);
      },
      {1.1, 1.1, 0.25}, {16, 16, 5}));
  const double diagonal = bounding_box_diagonal(plate.points);
  for (double length : {0.018, 0.02, 0.022, 0.025, 0.028}) {
    const PreparedMesh out = prepare(plate, detect_creases(plate, 40), length * diagonal, {});
    EXPECT_TRUE(out.remeshed);
    EXPECT_GT(least_angle(out.mesh), 0.5) << length;
  }
}

// Areas that the border loops enclose, the smallest first.
std::vector<double> loop_areas(const SurfaceMesh& m) {
  std::vector<double> areas;
  std::vector<char> seen(m.points.size(), 0);
  for (int start = 0; start < m.vertex_count(); ++start) {
    if (!m.border_vertex[start] || seen[start]) continue;
    Vector3 twice = Vector3::Zero();
    for (int v = start; !seen[v];) {
      seen[v] = 1;
      const int next = m.edges[*m.ring_begin_of(v)].other(v);
      twice += (m.points[v] - m.points[start]).cross(m.points[next] - m.points[start]);
      v = next;
    }
    areas.push_back(twice.norm() / 2);
  }
  std::sort(areas.begin(), areas.end());
  return areas;
}

// A hole of one triangle whose three border vertices came to lie on one of its sides had no width: the strips
// beside it met in a point, and no tolerance was fine enough to part them.
TEST(Prepare, SmallHolesStayOpen) {
  TriangleSoup soup = shapes::plane(60);
  std::vector<std::array<int, 3>> kept;
  for (std::size_t f = 0; f < soup.faces.size(); ++f)
    if (f % 211 != 100) kept.push_back(soup.faces[f]);
  soup.faces = kept;
  const SurfaceMesh in = repair(soup).mesh;
  for (double length : {0.02, 0.03, 0.05, 0.07}) {
    const PreparedMesh out = prepare(in, {}, length, {});
    ASSERT_TRUE(out.remeshed) << length;
    const std::vector<double> before = loop_areas(in), after = loop_areas(out.mesh);
    ASSERT_EQ(before.size(), after.size());
    EXPECT_GT(after.front(), 0.3 * before.front()) << length;
  }
}

TEST(Prepare, BordersAtTheSamePlaceStayApart) {
  // A tube that stands exactly in the hole of a plate, not joined to it.
  TriangleSoup s = shapes::cylinder(24, 4, 0.3, 1);
  const TriangleSoup plate = shapes::grid({24, 6, true, false}, [](double u, double v) {
    const double r = 0.3 + 0.7 * v, a = -2 * shapes::kPi * u;
    return Vector3(r * std::cos(a), r * std::sin(a), 0);
  });
  const int n = static_cast<int>(s.points.size());
  s.points.insert(s.points.end(), plate.points.begin(), plate.points.end());
  for (const auto& f : plate.faces) s.faces.push_back({f[0] + n, f[1] + n, f[2] + n});
  const SurfaceMesh both = build(std::move(s));
  const PreparedMesh out = prepare(both, {}, 0.15, {});
  EXPECT_TRUE(out.remeshed);
  EXPECT_EQ(count_border_loops(out.mesh), 4);
  EXPECT_NEAR(border_length(out.mesh), border_length(both), 0.2);
}

TEST(Prepare, SliversAndUselessDetailGo) {
  // Fans of needles around 200 rim points of a disc, as CAD systems write caps.
  TriangleSoup s;
  for (int i = 0; i < 200; ++i)
    s.points.emplace_back(std::cos(2 * shapes::kPi * i / 200), std::sin(2 * shapes::kPi * i / 200), 0);
  for (int i = 1; i + 1 < 200; ++i) s.faces.push_back({0, i, i + 1});
  const SurfaceMesh disc = build(std::move(s));
  EXPECT_FALSE(uniform_enough(disc));
  const PreparedMesh out = prepare(disc, {}, 0.1, {});
  expect_good(disc, out, 0.1, 0.005);
}

TEST(Prepare, TipsAreNotMelted) {
  const SurfaceMesh cone = build(shapes::grid({40, 40, true, false}, [](double u, double v) {
    const double r = 0.02 + 0.98 * v;
    return Vector3(r * std::cos(2 * shapes::kPi * u), r * std::sin(2 * shapes::kPi * u), 3 * (1 - v));
  }));
  const PreparedMesh out = prepare(cone, {}, 0.15, {});
  EXPECT_LT(distance(cone, out.mesh), 0.05);
}

TEST(Prepare, TopologyIsKeptWhereTrianglesAreFew) {
  for (const TriangleSoup& s :
       {shapes::box(1, {1, 1, 1}), shapes::torus(3, 3), shapes::cylinder(3, 1), shapes::plane(1)}) {
    const SurfaceMesh m = build(s);
    for (double length : {0.2, 1.0, 100.0}) {
      const PreparedMesh out = prepare(m, {}, length, {});
      EXPECT_EQ(euler(out.mesh), euler(m));
      EXPECT_EQ(count_border_loops(out.mesh), count_border_loops(m));
      EXPECT_EQ(out.crease_edge.size(), out.mesh.edges.size());
    }
  }
}

TEST(Prepare, SameInputSameBytes) {
  const SurfaceMesh m = build(shapes::torus(40, 20));
  const PreparedMesh a = prepare(m, {}, 0.1, {}), b = prepare(m, {}, 0.1, {});
  EXPECT_EQ(a.mesh.points, b.mesh.points);
  EXPECT_EQ(a.mesh.faces, b.mesh.faces);
}

TEST(Prepare, StopsWhenAsked) {
  const std::atomic<bool> cancelled{true};
  RunContext context;
  context.cancelled = &cancelled;
  const SurfaceMesh m = build(shapes::torus(100, 50));
  EXPECT_THROW(prepare(m, {}, 0.02, context), Error);
  EXPECT_THROW(without_slivers(m, 0.01, context), Error);
}

TEST(Prepare, UniformEnoughTellsGoodFromBad) {
  EXPECT_TRUE(uniform_enough(build(shapes::torus(60, 30))));
  EXPECT_TRUE(uniform_enough(build(shapes::sphere(10))));
  EXPECT_FALSE(uniform_enough(build(shapes::cylinder(60, 1, 1, 10))));
}

TEST(Prepare, EdgeLengthForGivesTheFaces) {
  const SurfaceMesh m = build(shapes::sphere(20));
  const PreparedMesh out = prepare(m, {}, edge_length_for(m, 3000), {});
  EXPECT_GT(out.mesh.face_count(), 2500);
  EXPECT_LT(out.mesh.face_count(), 4500);
}

// A box whose edge is a micro bevel of caps: triangles without height and without short sides.
SurfaceMesh micro_bevel() {
  TriangleSoup s = shapes::grid({2, 20}, [](double u, double v) {
    return u == 0.5 ? Vector3(1, v, 0) : u < 0.5 ? Vector3(0, v, 0) : Vector3(1, v, -1);
  });
  // Put the bevel in: the row on the edge is doubled, the copy staggered along the edge.
  const int n = static_cast<int>(s.points.size());
  for (int j = 0; j <= 20; ++j) s.points.emplace_back(1 + 1e-4, std::clamp((j + 0.5) / 20, 0.0, 1.0), -1e-4);
  s.points[n + 20] = Vector3(1 + 1e-4, 1, -1e-4);
  for (auto& f : s.faces)
    if (s.points[f[0]].z() + s.points[f[1]].z() + s.points[f[2]].z() < -0.5)
      for (int& v : f)
        if (v % 3 == 1) v = n + v / 3;
  for (int j = 0; j < 20; ++j) {
    s.faces.push_back({3 * j + 1, n + j, 3 * (j + 1) + 1});
    s.faces.push_back({n + j, n + j + 1, 3 * (j + 1) + 1});
  }
  return build(std::move(s));
}

TEST(Prepare, CreasesOfAMicroBevelComeOutOfTheSlivers) {
  const SurfaceMesh raw = micro_bevel();
  const SurfaceMesh clean = without_slivers(raw, 1e-3, {});
  EXPECT_LT(distance(raw, clean), 1e-3);
  EXPECT_EQ(euler(clean), euler(raw));
  const std::vector<char> crease = detect_creases(clean, 40);
  EXPECT_NEAR(length_of(clean, crease), 1, 0.06);
}

TEST(Prepare, WithoutSliversLeavesGoodMeshesAlone) {
  const SurfaceMesh m = build(shapes::torus(30, 15));
  EXPECT_EQ(without_slivers(m, 1e-3, {}).faces, m.faces);
}

// A scrap of a mesh without edges of a length that counts: as two faces back to back it would be no surface.
TEST(Prepare, NeedlesStayTetrahedra) {
  TriangleSoup needle;
  needle.points = {{0, 0, 0}, {3e-6, 0, 3e-3}, {3e-6, 1e-10, 0}, {1e-10, 0, 3e-3}};
  needle.faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  const SurfaceMesh clean = without_slivers(build(needle), 5e-4, {});
  EXPECT_GE(clean.face_count(), 4);
  EXPECT_GE(prepare(clean, {}, 2e-3, {}).mesh.face_count(), 4);
}

// Two large and narrow triangles: with the other diagonal there would be no ridge.
TEST(Prepare, BendsOfLargeTrianglesStay) {
  TriangleSoup roof;
  roof.points = {{0, 0, 0}, {4, 0, 0}, {2, 0.6, -0.18}, {2, -0.6, -0.18}};
  roof.faces = {{0, 1, 2}, {1, 0, 3}};
  const SurfaceMesh input = build(roof);
  const PreparedMesh even = prepare(input, {}, 0.05, {});
  EXPECT_TRUE(even.remeshed);
  EXPECT_LT(distance(input, even.mesh), 0.03);
  EXPECT_LT(distance(even.mesh, input), 0.03);
}

}  // namespace
}  // namespace sheetform
