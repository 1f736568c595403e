// Inputs as people have them: unwelded, turned over, non-manifold, tiny, one-sided.
#include <algorithm>
#include <cmath>

#include "pipeline/run.h"

namespace sheetform {
namespace {

TEST(BrokenInput, TrianglesWithoutSharedPointsAreWelded) {
  const TriangleSoup ball = shapes::cylinder(32, 8);
  TriangleSoup soup;
  for (const auto& f : ball.faces) {
    const int n = static_cast<int>(soup.points.size());
    for (int v : f) soup.points.push_back(ball.points[v]);
    soup.faces.push_back({n, n + 1, n + 2});
  }
  const Decomposition d = run(soup);
  expect_sound(soup, d);
  EXPECT_EQ(d.strips.patches.size(), 1u);
}

TEST(BrokenInput, TurnedDuplicateAndDegenerateFacesAreMended) {
  TriangleSoup soup = shapes::cylinder(32, 8);
  std::swap(soup.faces[10][0], soup.faces[10][1]);
  std::swap(soup.faces[99][0], soup.faces[99][1]);
  soup.faces.push_back(soup.faces[5]);
  soup.faces.push_back({3, 3, 4});
  soup.points.push_back({100, 100, 100});  // used by nobody
  const Decomposition d = run(soup);
  EXPECT_TRUE(d.certificate.strict());
  EXPECT_TRUE(d.report.e_max_met);
  EXPECT_LT(d.bbox_diagonal, 4);
  EXPECT_FALSE(d.audit.findings.empty());
  EXPECT_GE(d.report.notes.size(), d.audit.findings.size()) << "every repair is told";
}

TEST(BrokenInput, InwardSurfaceStaysInward) {
  TriangleSoup soup = shapes::sphere(10);
  for (auto& f : soup.faces) std::swap(f[0], f[1]);
  const Decomposition d = run(soup, with_e_max(0.05), 2);
  expect_sound(soup, d);
  double volume = 0;
  for (const auto& p : d.strips.patches)
    for (const auto& t : p.triangles)
      volume += d.strips.points[t.v[0]].dot(d.strips.points[t.v[1]].cross(d.strips.points[t.v[2]])) / 6;
  EXPECT_LT(volume, -3);
}

TEST(BrokenInput, EdgesOfThreeFacesAreCutOpen) {
  // A book of three pages.
  TriangleSoup soup;
  const int n = 12;
  for (int i = 0; i <= n; ++i) soup.points.emplace_back(0, 0, double(i) / n);
  for (int page = 0; page < 3; ++page) {
    const double a = page * 2 * shapes::kPi / 3;
    std::vector<int> last(n + 1);
    for (int i = 0; i <= n; ++i) last[i] = i;
    for (int j = 1; j <= n; ++j) {
      std::vector<int> now;
      for (int i = 0; i <= n; ++i)
        now.push_back(static_cast<int>(soup.points.size())),
            soup.points.emplace_back(std::cos(a) * j / n, std::sin(a) * j / n, double(i) / n);
      for (int i = 0; i < n; ++i) {
        soup.faces.push_back({last[i], now[i], now[i + 1]});
        soup.faces.push_back({last[i], now[i + 1], last[i + 1]});
      }
      last = now;
    }
  }
  const Decomposition d = run(soup);
  EXPECT_TRUE(d.certificate.strict());
  EXPECT_TRUE(d.report.e_max_met);
  EXPECT_GE(d.strips.patches.size(), 2u);
}

TEST(BrokenInput, MoebiusStripIsCutOpen) {
  TriangleSoup soup;
  const int n = 60, m = 6;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= m; ++j) {
      const double a = 2 * shapes::kPi * i / n, s = 0.4 * (double(j) / m - 0.5);
      const double r = 1 + s * std::cos(a / 2);
      soup.points.emplace_back(r * std::cos(a), r * std::sin(a), s * std::sin(a / 2));
    }
  const auto id = [&](int i, int j) { return i < n ? i * (m + 1) + j : m - j; };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      soup.faces.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
      soup.faces.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
    }
  const Decomposition d = run(soup);
  EXPECT_TRUE(d.certificate.strict());
  EXPECT_TRUE(d.report.e_max_met);
}

TEST(BrokenInput, FewestTriangles) {
  const TriangleSoup one{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const Decomposition single = run(one);
  expect_sound(one, single);
  EXPECT_EQ(single.strips.patches.size(), 1u);
  const TriangleSoup four{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                          {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
  const Decomposition tetrahedron = run(four);
  expect_sound(four, tetrahedron);
  EXPECT_TRUE(tetrahedron.report.e_max_met);
  EXPECT_EQ(tetrahedron.strips.patches.size(), 4u);
}

TEST(BrokenInput, VeryUnevenTrianglesArePrepared) {
  // A cylinder as CAD programs write it: triangles as long as the wall, fans as caps.
  const int n = 48;
  TriangleSoup soup;
  for (double z : {0.0, 4.0})
    for (int i = 0; i < n; ++i)
      soup.points.emplace_back(std::cos(2 * shapes::kPi * i / n), std::sin(2 * shapes::kPi * i / n), z);
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    soup.faces.push_back({i, j, n + j}), soup.faces.push_back({i, n + j, n + i});
    if (i > 0 && i + 1 < n) soup.faces.push_back({0, i + 1, i}), soup.faces.push_back({n, n + i, n + i + 1});
  }
  const Decomposition d = run(soup);
  expect_sound(soup, d);
  EXPECT_TRUE(d.report.e_max_met);
  EXPECT_EQ(d.strips.patches.size(), 3u);
}

TEST(BrokenInput, NothingToDecomposeIsRefused) {
  for (const TriangleSoup& soup :
       {TriangleSoup{}, TriangleSoup{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}},
        TriangleSoup{{{0, 0, 0}}, {{0, 0, 0}}}}) {
    try {
      run(soup);
      ADD_FAILURE() << "accepted";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::kUnsupportedMesh);
    }
  }
}

// Boxes at opposite corners of one point, as checkerboards and lattices have them.
TEST(BrokenInput, SolidsThatTouchInACornerStayApart) {
  TriangleSoup soup = shapes::box(2, {1, 1, 1});
  const std::size_t points = soup.points.size(), faces = soup.faces.size();
  for (std::size_t i = 0; i < points; ++i) soup.points.push_back(soup.points[i] + Vector3(1, 1, 1));
  for (std::size_t f = 0; f < faces; ++f) {
    const auto t = soup.faces[f];
    const int n = static_cast<int>(points);
    soup.faces.push_back({t[0] + n, t[1] + n, t[2] + n});
  }
  const Decomposition d = run(soup);
  EXPECT_TRUE(d.certificate.strict());
  EXPECT_TRUE(d.report.e_max_met);
  EXPECT_EQ(std::count_if(d.audit.findings.begin(), d.audit.findings.end(),
                          [](const AuditFinding& f) { return f.kind == "bow-tie-vertex"; }),
            1);
}

// Two sides and nothing between them, as leaves, wings and curtains are modelled.
TEST(BrokenInput, SheetsWithTwoSidesAreTakenAsTheyAre) {
  TriangleSoup soup = shapes::box(4, {1, 1, 1});
  const std::vector<Vector3> leaf{{2, 0, 0}, {3, 0, 0.2}, {3, 1, 0.2}, {2, 1, 0}};
  const int n = static_cast<int>(soup.points.size());
  soup.points.insert(soup.points.end(), leaf.begin(), leaf.end());
  for (const std::array<int, 3>& t :
       {std::array{0, 1, 2}, std::array{0, 2, 3}, std::array{1, 0, 3}, std::array{1, 3, 2}})
    soup.faces.push_back({n + t[0], n + t[1], n + t[2]});
  const Decomposition d = run(soup);
  EXPECT_TRUE(d.certificate.strict());
  EXPECT_TRUE(d.report.e_max_met);
  EXPECT_EQ(d.strips.patches.size(), 8u);
}

}  // namespace
}  // namespace sheetform
