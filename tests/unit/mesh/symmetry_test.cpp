#include "sheetform/mesh/symmetry.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "sheetform/base/error.h"
#include "sheetform/mesh/creases.h"
#include "sheetform/mesh/mesh_repair.h"
#include "support/shapes.h"

namespace sheetform {
namespace {

SurfaceMesh build(TriangleSoup s) { return build_surface_mesh(std::move(s.points), std::move(s.faces)); }

std::vector<SymmetryPlane> detect(const SurfaceMesh& m) {
  return detect_symmetry(m, ClosestPointTree(m.points, m.faces), {});
}

bool found(const std::vector<SymmetryPlane>& planes, const Vector3& normal, double offset, double tolerance) {
  return std::any_of(planes.begin(), planes.end(), [&](const SymmetryPlane& p) {
    const double way = p.normal.dot(normal) < 0 ? -1 : 1;
    return (way * p.normal - normal).norm() < tolerance && std::abs(way * p.offset - offset) < tolerance;
  });
}

const Eigen::AngleAxisd kTurn(0.7, Vector3(1, 2, -0.5).normalized());

TEST(Symmetry, ABoxHasItsThreePlanesWhereverItLies) {
  TriangleSoup s = shapes::box(6, {2, 3, 5});
  for (Vector3& p : s.points) p = kTurn * p + Vector3(10, -20, 30);
  const std::vector<SymmetryPlane> planes = detect(build(std::move(s)));
  EXPECT_EQ(planes.size(), 3u);
  for (int k = 0; k < 3; ++k) {
    const Vector3 n = kTurn * Vector3::Unit(k);
    EXPECT_TRUE(found(planes, n, n.dot(Vector3(10, -20, 30)), 1e-6));
  }
}

TEST(Symmetry, SizeDoesNotMatter) {
  for (double scale : {1e-6, 1e6}) {
    TriangleSoup s = shapes::box(6, {2, 3, 5});
    for (Vector3& p : s.points) p = scale * (kTurn * p + Vector3(1, -2, 3));
    const std::vector<SymmetryPlane> planes = detect(build(std::move(s)));
    EXPECT_EQ(planes.size(), 3u);
    for (const SymmetryPlane& p : planes) EXPECT_LT(p.mean_distance, 1e-6);
  }
}

TEST(Symmetry, ASaddleMirrorsInItsDiagonalsOnly) {
  // z = k x y over a square: the planes x = y and x = -y; x = 0 turns z over.
  const std::vector<SymmetryPlane> planes = detect(build(shapes::saddle(24, 0.8)));
  EXPECT_EQ(planes.size(), 2u);
  EXPECT_TRUE(found(planes, Vector3(1, 1, 0).normalized(), 0, 1e-3));
  EXPECT_TRUE(found(planes, Vector3(1, -1, 0).normalized(), 0, 1e-3));
}

TEST(Symmetry, OneSidedShapesHaveNone) {
  EXPECT_TRUE(detect(build(shapes::helicoid(10, 40, 1, 2, 0.6))).empty());
  TriangleSoup s = shapes::torus(60, 30);
  for (Vector3& p : s.points)
    p +=
        0.15 * Vector3(std::sin(3 * p.y() + 1), std::sin(2 * p.z() + 2 * p.x()), std::sin(4 * p.x() + p.y()));
  EXPECT_TRUE(detect(build(std::move(s))).empty());
}

TEST(Symmetry, ADentOfOnePercentIsNoticed) {
  TriangleSoup s = shapes::sphere(20);
  for (Vector3& p : s.points) p = p.cwiseProduct(Vector3(1, 1.3, 1.7));
  EXPECT_EQ(detect(build(s)).size(), 3u);
  for (Vector3& p : s.points) p *= 1 - 0.2 * std::exp(-20 * (p - Vector3(1, 0, 0)).squaredNorm());
  const std::vector<SymmetryPlane> planes = detect(build(s));
  EXPECT_EQ(planes.size(), 2u);
  EXPECT_FALSE(found(planes, Vector3(1, 0, 0), 0, 0.1));
}

TEST(Symmetry, RoundShapesGiveSeveralPlanesBestFirst) {
  const std::vector<SymmetryPlane> planes = detect(build(shapes::torus(48, 24)));
  EXPECT_GE(planes.size(), 4u);
  EXPECT_LE(planes.size(), 8u);
  EXPECT_TRUE(found(planes, Vector3(0, 0, 1), 0, 1e-3));
  for (std::size_t i = 1; i < planes.size(); ++i)
    EXPECT_LE(planes[i - 1].mean_distance, planes[i].mean_distance);
}

TEST(Symmetry, AGivenPlaneIsMeasured) {
  const SurfaceMesh m = build(shapes::box(6, {2, 3, 5}));
  const ClosestPointTree tree(m.points, m.faces);
  EXPECT_LT(measure_symmetry(m, tree, Vector3(2, 0, 0), 0).p99_distance, 1e-12);
  // Mirrored in x = 0.1 everything on the two faces x = +-1 lies 0.2 off; they have 30 of 62 units of area.
  const SymmetryPlane off = measure_symmetry(m, tree, Vector3(1, 0, 0), 0.1);
  const double diagonal = std::sqrt(4.0 + 9 + 25);
  EXPECT_NEAR(off.p99_distance * diagonal, 0.2, 1e-9);
  EXPECT_NEAR(off.mean_distance * diagonal, (30 * 0.2 + 32 * 0.1 * 0.1) / 62, 0.01);
}

double on_plane_error(const HalfMesh& h, const Vector3& n, double offset) {
  double worst = 0;
  for (int v = 0; v < h.mesh.vertex_count(); ++v)
    if (h.on_plane[v]) worst = std::max(worst, std::abs(n.dot(h.mesh.points[v]) - offset));
  return worst;
}

TEST(CutHalf, KnownTopologyOfATorus) {
  const SurfaceMesh torus = build(shapes::torus(40, 20));
  const HalfMesh ring = cut_half(torus, {}, {0, 0, 1}, 0.013);
  EXPECT_EQ(count_border_loops(ring.mesh), 2);
  EXPECT_EQ(face_components(ring.mesh).second, 1);
  const Vector3 oblique = Vector3(1, 0.3, 0.1).normalized();
  const HalfMesh tube = cut_half(torus, {}, oblique, 0.02);
  EXPECT_EQ(count_border_loops(tube.mesh), 2);
  EXPECT_EQ(tube.mesh.vertex_count() - tube.mesh.edge_count() + tube.mesh.face_count(), 0);
  EXPECT_LT(on_plane_error(tube, oblique, 0.02), 1e-15);
  for (int v = 0; v < tube.mesh.vertex_count(); ++v)
    EXPECT_EQ(tube.mesh.border_vertex[v] != 0, tube.on_plane[v] != 0);
}

TEST(CutHalf, BothHalvesMakeTheWhole) {
  const SurfaceMesh box = build(shapes::box(5, {1, 2, 3}));
  const Vector3 n = Vector3(0.2, 1, -0.4).normalized();
  for (double snap : {0.0, 0.1}) {
    const double a = surface_area(cut_half(box, {}, n, 0.1, snap).mesh),
                 b = surface_area(cut_half(box, {}, -n, -0.1, snap).mesh);
    EXPECT_NEAR(a + b, 22, snap == 0 ? 1e-12 : 0.05);
  }
}

TEST(CutHalf, AHalfAndItsMirrorImageMakeTheWhole) {
  for (const TriangleSoup& soup :
       {shapes::torus(40, 20), shapes::cylinder(30, 7), shapes::box(5, {1, 2, 3})}) {
    const SurfaceMesh mesh = build(soup);
    SurfaceMesh half = cut_half(mesh, {}, Vector3::UnitX(), 0, 1e-3).mesh;
    const PlaneBorder plane = plane_border(half, 1e-12);
    for (int v = 0; v < half.vertex_count(); ++v) EXPECT_EQ(plane.vertex[v] != 0, half.points[v].x() == 0);
    const SurfaceMesh whole = with_mirror_image(half, plane);
    EXPECT_EQ(whole.vertex_count() - whole.edge_count() + whole.face_count(),
              mesh.vertex_count() - mesh.edge_count() + mesh.face_count());
    EXPECT_EQ(count_border_loops(whole), count_border_loops(mesh));
    EXPECT_NEAR(surface_area(whole), surface_area(mesh), 1e-9);
    for (int v = half.vertex_count(); v < whole.vertex_count(); ++v) EXPECT_LT(whole.points[v].x(), 0);
  }
}

TEST(CutHalf, BordersOffThePlaneAreNotOnIt) {
  SurfaceMesh half = cut_half(build(shapes::cylinder(30, 7)), {}, Vector3::UnitX(), 0, 1e-3).mesh;
  const PlaneBorder plane = plane_border(half, 1e-12);
  double on = 0, off = 0;
  for (int e = 0; e < half.edge_count(); ++e)
    if (half.edges[e].border()) (plane.edge[e] ? on : off) += half.edge_length(e);
  EXPECT_NEAR(on, 4, 1e-9) << "two lines of the tube's height";
  EXPECT_NEAR(off, 2 * shapes::kPi, 0.05) << "half of both rims";
}

TEST(CutHalf, CreasesAreKeptAndTheCutIsBorder) {
  const SurfaceMesh box = build(shapes::box(4, {1, 2, 3}));
  const std::vector<char> crease = detect_creases(box, 40);
  for (double x : {0.0, 0.1}) {  // through vertices, and between them
    const HalfMesh half = cut_half(box, crease, {1, 0, 0}, x);
    double creases = 0, border = 0;
    for (int e = 0; e < half.mesh.edge_count(); ++e) {
      if (half.crease_edge[e]) creases += half.mesh.edge_length(e);
      if (half.mesh.edges[e].border()) border += half.mesh.edge_length(e);
    }
    EXPECT_NEAR(creases, 10 + 4 * (0.5 - x), 1e-12);
    EXPECT_NEAR(border, 10, 1e-12);
  }
}

TEST(CutHalf, VerticesNearThePlaneMoveOntoIt) {
  const SurfaceMesh plane = build(shapes::plane(10));
  const HalfMesh half = cut_half(plane, {}, {1, 0, 0}, 0.495);
  EXPECT_EQ(half.mesh.vertex_count(), 66);
  EXPECT_EQ(std::count(half.on_plane.begin(), half.on_plane.end(), 1), 11);
}

TEST(CutHalf, FacesInThePlaneBelongToNoSide) {
  const SurfaceMesh box = build(shapes::box(2, {2, 2, 2}));
  const HalfMesh half = cut_half(box, {}, {1, 0, 0}, -1);
  EXPECT_NEAR(surface_area(half.mesh), 20, 1e-12);
  EXPECT_EQ(count_border_loops(half.mesh), 1);
}

TEST(CutHalf, PartsThatTouchInAPointOfThePlane) {
  TriangleSoup s{{{0, 0, 0}, {1, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {-1, -1, 0}},
                 {{0, 1, 2}, {0, 3, 1}, {0, 2, 4}, {0, 4, 3}}};
  const HalfMesh half = cut_half(build(std::move(s)), {}, {0, 1, 0}, 0);
  EXPECT_EQ(count_border_loops(half.mesh), 1);
  EXPECT_NEAR(surface_area(half.mesh), 2, 1e-12);
}

TEST(CutHalf, APlaneBesideTheMeshIsAnError) {
  EXPECT_THROW(cut_half(build(shapes::sphere(4)), {}, {1, 0, 0}, 2), Error);
}

}  // namespace
}  // namespace sheetform
