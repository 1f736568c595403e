#include "sheetform/mesh/mesh_repair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "sheetform/base/error.h"
#include "support/shapes.h"

namespace sheetform {
namespace {

int count_of(const RepairResult& r, const std::string& kind) {
  for (const AuditFinding& f : r.audit.findings)
    if (f.kind == kind) return f.count;
  return 0;
}

std::vector<Vector3> places_of(const RepairResult& r, const std::string& kind) {
  for (const AuditFinding& f : r.audit.findings)
    if (f.kind == kind) return f.places;
  return {};
}

void expect_topology(const RepairResult& r, int components, int loops, int euler) {
  EXPECT_EQ(r.audit.components, components);
  EXPECT_EQ(r.audit.border_loops, loops);
  EXPECT_EQ(r.audit.euler, euler);
}

// Appends b, moved; points stay apart.
void append(TriangleSoup& a, const TriangleSoup& b, const Vector3& shift) {
  const int n = static_cast<int>(a.points.size());
  for (const Vector3& p : b.points) a.points.push_back(p + shift);
  for (const auto& f : b.faces) a.faces.push_back({f[0] + n, f[1] + n, f[2] + n});
}

// Every face with its own three points.
TriangleSoup exploded(const TriangleSoup& s) {
  TriangleSoup t;
  for (const auto& f : s.faces) {
    const int n = static_cast<int>(t.points.size());
    for (int v : f) t.points.push_back(s.points[v]);
    t.faces.push_back({n, n + 1, n + 2});
  }
  return t;
}

void expect_no_twins(const SurfaceMesh& m) {
  const double least = 2e-7 * bounding_box_diagonal(m.points);
  for (int a = 0; a < m.vertex_count(); ++a)
    for (int b = 0; b < a; ++b) EXPECT_GT((m.points[a] - m.points[b]).norm(), least) << a << ' ' << b;
}

double volume(const SurfaceMesh& m) {
  double sum = 0;
  for (const auto& t : m.faces) sum += m.points[t[0]].dot(m.points[t[1]].cross(m.points[t[2]])) / 6;
  return sum;
}

TEST(MeshRepair, CleanMeshesComeBackAsTheyAre) {
  for (const TriangleSoup& s :
       {shapes::torus(9, 7), shapes::plane(4), shapes::cylinder(9, 3), shapes::sphere(4)}) {
    const RepairResult r = repair(s);
    EXPECT_EQ(r.mesh.faces, s.faces);
    EXPECT_EQ(r.mesh.points, s.points);
    EXPECT_TRUE(r.audit.findings.empty());
    for (int f = 0; f < r.mesh.face_count(); ++f) EXPECT_EQ(r.face_origin[f], f);
  }
}

TEST(MeshRepair, AuditCountsKnownTopology) {
  expect_topology(repair(shapes::torus(9, 7)), 1, 0, 0);
  expect_topology(repair(shapes::cylinder(9, 3)), 1, 2, 0);
  expect_topology(repair(shapes::plane(3)), 1, 1, 1);
  TriangleSoup two = shapes::sphere(3);
  append(two, shapes::plane(2), {5, 0, 0});
  expect_topology(repair(two), 2, 1, 3);
}

TEST(MeshRepair, EqualPointsAreWelded) {
  const TriangleSoup torus = shapes::torus(9, 7);
  const RepairResult r = repair(exploded(torus));
  expect_topology(r, 1, 0, 0);
  EXPECT_EQ(r.mesh.vertex_count(), static_cast<int>(torus.points.size()));
  EXPECT_EQ(count_of(r, "duplicate-vertex"), 3 * 126 - 63);
  EXPECT_EQ(r.audit.findings[0].text, "315 vertices at the place of another one were merged with it");
}

TEST(MeshRepair, NearPointsAreWeldedWhereThatIsNeeded) {
  // A third of all corners is off by rounding: no manifold by exact positions (faces touch in single
  // vertices).
  TriangleSoup s = exploded(shapes::torus(9, 7));
  for (std::size_t i = 0; i < s.points.size(); i += 3) s.points[i] += Vector3(1e-10, -1e-10, 1e-10);
  const RepairResult r = repair(s);
  expect_topology(r, 1, 0, 0);
  EXPECT_EQ(r.mesh.vertex_count(), 63);
}

TEST(MeshRepair, ManifoldsWithACrackKeepIt) {
  TriangleSoup s = shapes::plane(2);
  append(s, shapes::plane(2), {1 + 1e-12, 0, 0});
  expect_topology(repair(s), 2, 2, 2);
}

TEST(MeshRepair, UnusedPointsAndCollapsedFacesGo) {
  TriangleSoup s = shapes::sphere(3);
  s.points.insert(s.points.begin(), Vector3(9, 9, 9));
  for (auto& f : s.faces)
    for (int& v : f) ++v;
  s.faces.push_back({1, 1, 2});
  s.points.push_back(s.points[1]);
  s.faces.push_back({1, 2, static_cast<int>(s.points.size()) - 1});
  const RepairResult r = repair(s);
  expect_topology(r, 1, 0, 2);
  EXPECT_EQ(count_of(r, "unused-vertex"), 1);
  EXPECT_EQ(count_of(r, "degenerate-face"), 2);
  for (int v = 0; v < r.mesh.vertex_count(); ++v) EXPECT_EQ(s.points[r.vertex_origin[v]], r.mesh.points[v]);
}

// A pyramid whose top is parted by a needle, there twice, back to back: its long side lies along two faces.
TEST(MeshRepair, NeedlesThatArePartOfNothingGo) {
  TriangleSoup s;
  s.points = {{0, 0, 0}, {0, 4, 0}, {0, 2, 0}, {2, 2, 0}, {-2, 2, 0}, {0, 2, -4}};
  s.faces = {{0, 1, 2}, {2, 1, 0}, {3, 2, 0}, {3, 1, 2}, {1, 4, 2},
             {4, 0, 2}, {4, 5, 0}, {0, 5, 3}, {5, 4, 1}, {5, 1, 3}};
  const RepairResult r = repair(s);
  expect_topology(r, 1, 0, 2);
  EXPECT_EQ(r.mesh.face_count(), 8);
  EXPECT_EQ(count_of(r, "duplicate-face"), 1);
  EXPECT_EQ(count_of(r, "no-area"), 1);
  EXPECT_EQ(count_of(r, "zero-area-face"), 0);
}

TEST(MeshRepair, ComponentsWithoutAreaGo) {
  TriangleSoup s = shapes::sphere(3);
  const auto n = static_cast<int>(s.points.size());
  const std::size_t faces = s.faces.size();
  s.points.insert(s.points.end(), {{5, 0, 0}, {6, 0, 0}, {7, 0, 0}, {8, 0, 0}});
  s.faces.push_back({n, n + 2, n + 1}), s.faces.push_back({n + 1, n + 2, n + 3});
  const RepairResult r = repair(s);
  expect_topology(r, 1, 0, 2);
  EXPECT_EQ(static_cast<std::size_t>(r.mesh.face_count()), faces);
  EXPECT_EQ(count_of(r, "no-area"), 2);
}

TEST(MeshRepair, DoubledFacesGo) {
  TriangleSoup s = shapes::plane(3);
  const std::size_t n = s.faces.size();
  for (std::size_t f = 0; f < n; ++f) s.faces.push_back({s.faces[f][1], s.faces[f][0], s.faces[f][2]});
  const RepairResult r = repair(s);
  expect_topology(r, 1, 1, 1);
  EXPECT_EQ(count_of(r, "duplicate-face"), static_cast<int>(n));
  EXPECT_EQ(r.mesh.faces, shapes::plane(3).faces);
}

TEST(MeshRepair, CubesThatShareAnEdgeStaySolids) {
  TriangleSoup s = shapes::box(1, {2, 2, 2});
  append(s, shapes::box(1, {2, 2, 2}), {2, 2, 0});
  const RepairResult r = repair(s);
  expect_topology(r, 2, 0, 4);
  EXPECT_EQ(count_of(r, "non-manifold-edge"), 1);
  EXPECT_NEAR(volume(r.mesh), 16, 1e-3);
  expect_no_twins(r.mesh);
}

TEST(MeshRepair, CubesThatShareACornerAreSplit) {
  TriangleSoup s = shapes::box(2, {2, 2, 2});
  append(s, shapes::box(2, {2, 2, 2}), {2, 2, 2});
  const RepairResult r = repair(s);
  expect_topology(r, 2, 0, 4);
  EXPECT_EQ(count_of(r, "bow-tie-vertex"), 1);
  EXPECT_EQ(r.audit.findings.back().places, std::vector<Vector3>{Vector3(1, 1, 1)});
  expect_no_twins(r.mesh);
}

TEST(MeshRepair, AFinLeavesTheSheetWhole) {
  TriangleSoup s = shapes::plane(4);  // fin along x = 1/2, standing up
  append(s, shapes::grid({4, 1}, [](double u, double v) { return Vector3(0.5, u, v * 0.25); }), {0, 0, 0});
  const RepairResult r = repair(s);
  EXPECT_EQ(count_of(r, "non-manifold-edge"), 4);
  const std::vector<Vector3> places = places_of(r, "non-manifold-edge");
  ASSERT_EQ(places.size(), 4u);  // the middles of the four edges that the fin stands on
  for (const Vector3& p : places) {
    EXPECT_EQ(p.x(), 0.5);
    EXPECT_EQ(p.z(), 0);
  }
  expect_topology(r, 2, 2, 2);
}

TEST(MeshRepair, AnInnerWallGetsABorderOfItsOwn) {
  // Box with a wall through its middle: an eight-sided ring of edges with three faces each.
  TriangleSoup s = shapes::box(2, {2, 2, 2});
  append(s, shapes::grid({2, 2}, [](double u, double v) { return Vector3(2 * u - 1, 2 * v - 1, 0); }),
         {0, 0, 0});
  const RepairResult r = repair(s);
  EXPECT_EQ(count_of(r, "non-manifold-edge"), 8);
  expect_topology(r, 2, 1, 3);
  expect_no_twins(r.mesh);
}

TEST(MeshRepair, TheMinorityIsTurned) {
  TriangleSoup s = shapes::sphere(6);
  for (std::size_t f = 0; f < s.faces.size(); f += 3) std::swap(s.faces[f][0], s.faces[f][1]);
  RepairResult r = repair(s);
  expect_topology(r, 1, 0, 2);
  EXPECT_EQ(count_of(r, "opposite-orientation"), 144);
  EXPECT_GT(volume(r.mesh), 0);
  for (auto& f : s.faces) std::swap(f[0], f[1]);
  r = repair(s);
  EXPECT_LT(volume(r.mesh), 0) << "the majority points inward";
  EXPECT_EQ(count_of(r, "inside-out"), 1);
}

TEST(MeshRepair, InsideOutIsKeptAndTold) {
  TriangleSoup s = shapes::box(2, {1, 1, 1});
  for (auto& f : s.faces) std::swap(f[0], f[1]);
  const RepairResult r = repair(s);
  EXPECT_EQ(r.mesh.faces, s.faces);
  EXPECT_EQ(count_of(r, "inside-out"), 1);
}

TEST(MeshRepair, MoebiusStripIsCutToASheet) {
  const int n = 24;
  TriangleSoup s = shapes::grid({n, 3}, [](double u, double v) {
    const double a = 2 * shapes::kPi * u, w = v - 0.5;
    return Vector3((1 + w * std::cos(a / 2)) * std::cos(a), (1 + w * std::cos(a / 2)) * std::sin(a),
                   w * std::sin(a / 2));
  });
  // The last column is the first one upside down.
  for (auto& f : s.faces)
    for (int& v : f)
      if (v % (n + 1) == n) v = (3 - v / (n + 1)) * (n + 1);
  const RepairResult r = repair(s);
  EXPECT_EQ(count_of(r, "non-orientable"), 1);
  expect_topology(r, 1, 1, 1);
  expect_no_twins(r.mesh);
  EXPECT_EQ(r.mesh.face_count(), static_cast<int>(s.faces.size()));
}

TEST(MeshRepair, KleinBottleIsCutOpen) {
  const int n = 16, m = 12;
  TriangleSoup s = shapes::grid({n, m, false, true}, [](double u, double v) {
    const double a = 2 * shapes::kPi * u, b = 2 * shapes::kPi * v;
    const double r = 3 + std::cos(a / 2) * std::sin(b) - std::sin(a / 2) * std::sin(2 * b);
    return Vector3(r * std::cos(a), r * std::sin(a),
                   std::sin(a / 2) * std::sin(b) + std::cos(a / 2) * std::sin(2 * b));
  });
  for (auto& f : s.faces)
    for (int& v : f)
      if (v % (n + 1) == n) v = ((m - v / (n + 1)) % m) * (n + 1);
  const RepairResult r = repair(s);
  EXPECT_EQ(count_of(r, "non-orientable"), 1);
  EXPECT_EQ(r.audit.components, 1);
  EXPECT_GT(r.audit.border_loops, 0);
}

TEST(MeshRepair, NothingLeftIsAnError) {
  const std::vector<Vector3> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  for (const TriangleSoup& s :
       {TriangleSoup{}, TriangleSoup{line, {}}, TriangleSoup{line, {{0, 0, 1}}},
        TriangleSoup{line, {{0, 1, 2}}}, TriangleSoup{{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {{0, 1, 2}}}}) {
    try {
      repair(s);
      ADD_FAILURE() << "was accepted";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::kUnsupportedMesh);
    }
  }
}

TEST(MeshRepair, AMeshWithoutAreaIsToldWhereItRuns) {
  try {
    repair({{{-1, 2, 0}, {0, 1, 0.5}, {1, 0, 1}, {3, -2, 2}}, {{0, 1, 2}, {1, 2, 3}}});
    ADD_FAILURE() << "was accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.where(), "on a line from (-1, 2, 0) to (3, -2, 2)");
    EXPECT_FALSE(e.fix().empty());
  }
}

TEST(MeshRepair, UnsoundSoupsAreRefused) {
  const std::vector<Vector3> p{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {std::nan(""), 0, 0}};
  EXPECT_THROW(repair({p, {{0, 1, 4}}}), Error);
  EXPECT_THROW(repair({p, {{0, 1, -1}}}), Error);
  EXPECT_THROW(repair({p, {{0, 1, 3}}}), Error);
  EXPECT_EQ(repair({p, {{0, 1, 2}}}).mesh.face_count(), 1) << "an unused vertex may be anywhere";
}

// Random faces on few points break everything at once. build_surface_mesh, called by repair, is the oracle:
// it throws when the result is no oriented manifold. No area may appear from nowhere, and every face knows
// where it comes from.
TEST(MeshRepair, AnyTangleBecomesAManifold) {
  std::mt19937_64 rng(11);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int round = 0; round < 400; ++round) {
    TriangleSoup s;
    const int points = 4 + round % 9, faces = 1 + round % 40;
    for (int i = 0; i < points; ++i) s.points.emplace_back(u(rng), u(rng), u(rng));
    for (int i = 0; i < faces; ++i) {
      std::array<int, 3> f{};
      for (int& v : f) v = static_cast<int>(rng() % static_cast<unsigned>(points));
      s.faces.push_back(f);
    }
    RepairResult r;
    try {
      r = repair(s);
    } catch (const Error& e) {
      ASSERT_EQ(e.code(), ErrorCode::kUnsupportedMesh);
      ASSERT_TRUE(std::none_of(s.faces.begin(), s.faces.end(), [](const auto& f) {
        return f[0] != f[1] && f[1] != f[2] && f[2] != f[0];
      })) << e.what();
      continue;
    }
    std::vector<double> area(s.faces.size(), 0);
    for (int f = 0; f < r.mesh.face_count(); ++f)
      area[r.face_origin[f]] += r.mesh.face_normal_raw(f).norm() / 2;
    for (int f = 0; f < faces; ++f) {
      const auto& t = s.faces[f];
      const double before =
          (s.points[t[1]] - s.points[t[0]]).cross(s.points[t[2]] - s.points[t[0]]).norm() / 2;
      ASSERT_TRUE(area[f] == 0 || std::abs(area[f] - before) < 1e-3);
    }
    const RepairResult again = repair({r.mesh.points, r.mesh.faces});
    ASSERT_GE(again.mesh.face_count(), 1);
  }
}

TEST(MeshRepair, FaceOrderOfAStarWithManyFacesIsNoProblem) {
  TriangleSoup s{{{0, 0, 0}, {0, 0, 1}}, {}};
  for (int i = 0; i < 50000; ++i) {
    const double a = 2 * shapes::kPi * i / 50000;
    s.points.emplace_back(std::cos(a), std::sin(a), 0.5);
    s.faces.push_back({0, 1, 2 + i});
  }
  const RepairResult r = repair(s);
  EXPECT_EQ(r.audit.components, 50000);
  EXPECT_EQ(count_of(r, "non-manifold-edge"), 1);
}

}  // namespace
}  // namespace sheetform
