#include <gtest/gtest.h>

#include <cmath>

#include "support/one_patch.h"

namespace sheetform {
namespace {

using shapes::OnePatch;

TEST(SurfaceGuide, FollowsTheAxisOfACylinder) {
  const OnePatch o(shapes::cylinder_patch(32, 20));
  const SurfaceGuide guide = o.guide();
  for (int f = 0; f < o.mesh.face_count(); ++f) {
    EXPECT_GT(std::abs(guide.ruling_direction[f].z()), 0.999);
    EXPECT_GT(guide.strength[f], 0.95);
    EXPECT_NEAR(guide.normal[f].dot(guide.ruling_direction[f]), 0, 1e-9);
    EXPECT_GT(guide.normal[f].head<2>().dot(o.mesh.points[o.mesh.faces[f][0]].head<2>()), 0.9);
  }
}

TEST(SurfaceGuide, FollowsTheGeneratorsOfACone) {
  const OnePatch o(shapes::cone_sector(40, 24, 1.4, 0.5));
  const SurfaceGuide guide = o.guide();
  double sum = 0;
  int count = 0;
  for (int f = 0; f < o.mesh.face_count(); ++f) {
    const auto& t = o.mesh.faces[f];
    const Vector3 middle = (o.mesh.points[t[0]] + o.mesh.points[t[1]] + o.mesh.points[t[2]]) / 3;
    if (middle.norm() < 0.25) continue;  // around the apex the fit sees the tip
    const double cosine = std::abs(guide.ruling_direction[f].dot(middle.normalized()));
    EXPECT_GT(cosine, 0.95) << "also at the borders, where the fit is one-sided";
    sum += cosine, ++count;
  }
  EXPECT_GT(sum / count, 0.997);
}

TEST(SurfaceGuide, SaysNothingWhereNoDirectionIsPreferred) {
  for (const TriangleSoup& soup : {shapes::plane(12), shapes::saddle(16, 0.5)}) {
    const SurfaceGuide guide = OnePatch(soup).guide();
    for (double s : guide.strength) EXPECT_LT(s, 0.05);
  }
  const TriangleSoup ball = shapes::sphere(12);
  const SurfaceMesh mesh = build_surface_mesh(ball.points, ball.faces);
  RunContext context;
  const SurfaceGuide guide =
      surface_guide(mesh, principal_curvature(mesh, std::vector<char>(mesh.edges.size(), 0), {}, context));
  for (double s : guide.strength) EXPECT_LT(s, 0.05);
}

TEST(SurfaceGuide, DoesNotDependOnTheUnit) {
  TriangleSoup big = shapes::cylinder_patch(20, 12);
  const SurfaceGuide a = OnePatch(big).guide();
  for (Vector3& p : big.points) p *= 1e6;
  const SurfaceGuide b = OnePatch(big).guide();
  for (std::size_t f = 0; f < a.strength.size(); ++f) EXPECT_NEAR(a.strength[f], b.strength[f], 1e-6);
}

}  // namespace
}  // namespace sheetform
