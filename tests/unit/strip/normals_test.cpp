// The normal deviation against closed forms: facets of a curved surface tilt evenly from 0 to half their
// angle.
#include <gtest/gtest.h>

#include "sheetform/strip/certificate.h"
#include "support/shapes.h"
#include "support/strip_shapes.h"

namespace sheetform {
namespace {

NormalReport normals(const TriangleSoup& input, const StripMesh& result, int threads = 1) {
  RunContext context;
  context.threads = threads;
  return measure_normals(input.points, input.faces, ClosestPointTree(input.points, input.faces), result,
                         20000, context);
}

TEST(Normals, AnExactResultDeviatesNowhere) {
  const StripMesh torus = shapes::torus_pieces(6, 4, 24);
  const NormalReport r = normals(shapes::soup_of(torus), torus);
  EXPECT_LT(r.mean, 1e-2);  // a point on an edge may be met on its other side
  EXPECT_LT(r.worst, 1e-3);
  EXPECT_EQ(r.patch_quantile.size(), torus.patches.size());
}

TEST(Normals, OfAPrismInACylinder) {
  for (int n : {8, 16, 32}) {
    const NormalReport r = normals(shapes::cylinder(1440, 2, 1, 2), shapes::tube(n));
    const double half = 180.0 / n;
    EXPECT_NEAR(r.mean, half / 2, 0.02 * half);
    EXPECT_NEAR(r.quantile, 0.95 * half, 0.03 * half);
    EXPECT_NEAR(r.worst, 0.95 * half, 0.03 * half);
    EXPECT_NEAR(r.worst_place.head<2>().norm(), 1, 0.1);
  }
}

// A sphere between 60 degrees south and north as bands of `degrees` each; the strips of a band are fine.
Vector3 on_sphere(double longitude, double latitude) {
  return {std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
          std::sin(latitude)};
}
StripMesh sphere_bands(int degrees) {
  constexpr int kAround = 360;
  const int bands = 120 / degrees;
  StripMesh mesh;
  for (int b = 0; b <= bands; ++b)
    for (int i = 0; i < kAround; ++i)
      mesh.points.push_back(on_sphere(2 * shapes::kPi * i / kAround, (b * degrees - 60) * shapes::kPi / 180));
  for (int b = 0; b < bands; ++b) {
    StripMesh::Patch patch;
    for (int i = 0; i < kAround; ++i) {
      const int a = b * kAround + i, c = b * kAround + (i + 1) % kAround;
      for (const std::array<int, 3>& v :
           {std::array{a, c, c + kAround}, std::array{a, c + kAround, a + kAround}})
        patch.triangles.emplace_back().v = v;
    }
    mesh.patches.push_back(patch);
  }
  return mesh;
}

TEST(Normals, OfBandsAroundASphere) {
  const TriangleSoup sphere = shapes::grid({720, 240, true, false}, [](double u, double v) {
    return on_sphere(2 * shapes::kPi * u, (120 * v - 60) * shapes::kPi / 180);
  });
  for (int degrees : {20, 40}) {
    const NormalReport r = normals(sphere, sphere_bands(degrees));
    EXPECT_NEAR(r.mean, degrees / 4.0, 0.03 * degrees);
    EXPECT_NEAR(r.quantile, 0.95 * degrees / 2.0, 0.03 * degrees);
    // The bands towards the poles have more of their area on the side of the equator.
    for (double q : r.patch_quantile) EXPECT_NEAR(q, 0.95 * degrees / 2.0, 0.05 * degrees);
  }
}

TEST(Normals, AFlippedPatchIsAHalfTurnAway) {
  StripMesh torus = shapes::torus_pieces(6, 4, 24);
  const TriangleSoup input = shapes::soup_of(torus);
  for (auto& t : torus.patches[3].triangles) std::swap(t.v[1], t.v[2]);
  const NormalReport r = normals(input, torus);
  EXPECT_GT(r.patch_quantile[3], 179);
  EXPECT_EQ(r.worst, r.patch_quantile[3]);
}

TEST(Normals, DoNotDependOnTheNumberOfThreads) {
  const TriangleSoup input = shapes::cylinder(60, 20);
  const NormalReport one = normals(input, shapes::tube(9), 1), three = normals(input, shapes::tube(9), 3);
  EXPECT_EQ(one.mean, three.mean);
  EXPECT_EQ(one.patch_quantile, three.patch_quantile);
  EXPECT_EQ(one.worst_place, three.worst_place);
}

}  // namespace
}  // namespace sheetform
