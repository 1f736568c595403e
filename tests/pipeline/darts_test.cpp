// Darts: a sheet raised to a hill is one part with a slit that closes when it is bent, where two parts were
// needed without.
#include <algorithm>
#include <cmath>

#include "pipeline/run.h"

namespace sheetform {
namespace {

// A square sheet raised to a cone with a rounded tip.
TriangleSoup hill(double height) {
  return shapes::grid({24, 24}, [=](double u, double v) {
    double x = 2 * u - 1, y = 2 * v - 1;
    const double r = std::hypot(x, y), k = r > 0 ? std::max(std::abs(x), std::abs(y)) / r : 0;
    x *= k, y *= k;
    return Vector3(x, y, height * (1 - std::sqrt(x * x + y * y + 0.01)));
  });
}

struct Tip {
  int arch, vertex;
};

// Ends of arches at which nothing else ends.
std::vector<Tip> tips(const StripMesh& strips) {
  const std::map<int, int> valence = valences(strips);
  std::vector<Tip> found;
  for (int a = 0; a < static_cast<int>(strips.arches.size()); ++a)
    for (int v : {strips.arches[a].vertices.front(), strips.arches[a].vertices.back()})
      if (valence.at(v) == 1) found.push_back({a, v});
  return found;
}

// One place of the outline and one point of the sheet, where its two sides begin.
void expect_tip(const StripMesh& strips, const Tip& tip) {
  const StripMesh::Arch& arch = strips.arches[tip.arch];
  const int p = arch.patches[0];
  EXPECT_EQ(arch.patches[1], p);
  const StripMesh::Patch& patch = strips.patches[p];
  EXPECT_EQ(std::count(patch.boundary.begin(), patch.boundary.end(), tip.vertex), 1);
  EXPECT_EQ(std::count(patch.arches.begin(), patch.arches.end(), tip.arch), 2);
  std::set<int> uvs;
  for (const StripMesh::Triangle& t : patch.triangles)
    for (int k = 0; k < 3; ++k)
      if (t.v[k] == tip.vertex) uvs.insert(t.vt[k]);
  EXPECT_EQ(uvs.size(), 1u);
  const int base = arch.vertices.front() == tip.vertex ? arch.vertices.back() : arch.vertices.front();
  EXPECT_GE(std::count(patch.boundary.begin(), patch.boundary.end(), base), 2) << "the slit is open there";
}

struct Case {
  double height, e_max;
};
const Case kCases[] = {{0.5, 0.02}, {0.8, 0.015}, {0.8, 0.03}};

TEST(Darts, KeepEveryPromiseOfTheResult) {
  int found = 0, parts = 0, without = 0;
  for (const Case& c : kCases) {
    const TriangleSoup soup = hill(c.height);
    const Decomposition d = run(soup, with_e_max(c.e_max), 2);
    expect_sound(soup, d);
    EXPECT_TRUE(d.report.e_max_met);
    for (const Tip& tip : tips(d.strips)) expect_tip(d.strips, tip), ++found;
    parts += d.report.patches;
    DecomposeParams none = with_e_max(c.e_max);
    none.self_seams = false;
    without += run(soup, none, 2).report.patches;
  }
  EXPECT_GT(found, 0);
  EXPECT_LT(parts, without);
}

TEST(Darts, AreForbiddenWithSeamsOfAPartWithItselfAndWithTJunctions) {
  for (const bool self_seams : {true, false})
    for (const Case& c : kCases) {
      const TriangleSoup soup = hill(c.height);
      DecomposeParams params = with_e_max(c.e_max);
      params.self_seams = self_seams, params.t_junctions = !self_seams;
      const Decomposition d = run(soup, params, 2);
      expect_sound(soup, d);
      EXPECT_TRUE(tips(d.strips).empty());
    }
}

// The half and its mirror image are joined where they touch along a line, never where a dart would become a
// slit inside.
TEST(Darts, OfASymmetricResultHaveTheirImages) {
  for (const Case& c : kCases)
    for (const Vector3& normal : {Vector3(1, 0, 0), Vector3(1, -1, 0)}) {
      const TriangleSoup soup = hill(c.height);
      DecomposeParams params = with_e_max(c.e_max);
      params.symmetry = SymmetryMode::kPlane;
      params.plane = {normal.normalized(), 0};
      const Decomposition d = run(soup, params, 2);
      expect_sound(soup, d);
      ASSERT_TRUE(d.mirror_plane.has_value());
      std::vector<Vector3> ends;
      for (const Tip& tip : tips(d.strips)) {
        expect_tip(d.strips, tip);
        ends.push_back(d.strips.points[tip.vertex]);
      }
      for (const Vector3& p : ends) {
        const Vector3 image = p - 2 * d.mirror_plane->normal.dot(p) * d.mirror_plane->normal;
        EXPECT_TRUE(std::any_of(ends.begin(), ends.end(),
                                [&](const Vector3& q) { return (q - image).norm() < 1e-9; }));
      }
    }
}

}  // namespace
}  // namespace sheetform
