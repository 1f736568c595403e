// Symmetric decompositions: every point, part and seam has its exact mirror image.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "pipeline/run.h"
#include "sheetform/base/error.h"

namespace sheetform {
namespace {

DecomposeParams symmetric(double e_max = 0.03) {
  DecomposeParams params = with_e_max(e_max);
  params.symmetry = SymmetryMode::kAuto;
  return params;
}

DecomposeParams in_plane(const Vector3& normal, double offset) {
  DecomposeParams params = with_e_max(0.03);
  params.symmetry = SymmetryMode::kPlane;
  params.plane = {normal.normalized(), offset};
  return params;
}

// An ellipsoid of three lengths: three planes, none of them favoured by its triangles.
TriangleSoup egg(const Vector3& centre) {
  TriangleSoup soup = shapes::sphere(14);
  for (Vector3& p : soup.points) p = p.cwiseProduct(Vector3(1, 1.4, 2)) + centre;
  return soup;
}

// The number of the point at the mirrored place of each point; -1 where there is none.
std::vector<int> images(const StripMesh& strips, const Plane& plane, double tolerance) {
  std::vector<int> image;
  for (const Vector3& p : strips.points) {
    const Vector3 q = p - 2 * (plane.normal.dot(p) - plane.offset) * plane.normal;
    int found = -1;
    for (int i = 0; i < static_cast<int>(strips.points.size()) && found < 0; ++i)
      if ((strips.points[i] - q).norm() <= tolerance) found = i;
    image.push_back(found);
  }
  return image;
}

std::vector<int> sorted_images(const std::vector<int>& points, const std::vector<int>& image) {
  std::vector<int> out;
  for (int v : points) out.push_back(image[v]);
  std::sort(out.begin(), out.end());
  return out;
}

void expect_symmetric(const Decomposition& d) {
  ASSERT_TRUE(d.mirror_plane.has_value());
  const std::vector<int> image = images(d.strips, *d.mirror_plane, 1e-12 * d.bbox_diagonal);
  EXPECT_EQ(std::count(image.begin(), image.end(), -1), 0) << "a point without image";
  for (int p = 0; p < static_cast<int>(d.strips.patches.size()); ++p) {
    const StripMesh::Patch& patch = d.strips.patches[p];
    // A part without a partner is its own image: the seam on the plane has gone.
    const int other = patch.mirror_of < 0 ? p : patch.mirror_of;
    EXPECT_TRUE(other == p || d.strips.patches[other].mirror_of == p);
    std::vector<int> outline = d.strips.patches[other].boundary;
    std::sort(outline.begin(), outline.end());
    EXPECT_EQ(sorted_images(patch.boundary, image), outline) << "part " << p;
  }
}

TEST(SymmetricResult, AnEggOfAnyPlaceIsMirroredExactly) {
  const TriangleSoup soup = egg(Vector3(30, -7, 11));
  const Decomposition d = run(soup, symmetric(), 2);
  expect_sound(soup, d);
  expect_symmetric(d);
  EXPECT_TRUE(d.report.e_max_met);
}

TEST(SymmetricResult, ATurnedOneToo) {
  TriangleSoup soup = egg(Vector3::Zero());
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.8, Vector3(1, 2, -0.7).normalized()).toRotationMatrix();
  for (Vector3& p : soup.points) p = turn * p;
  const Decomposition d = run(soup, symmetric(), 2);
  expect_sound(soup, d);
  expect_symmetric(d);
  EXPECT_TRUE(d.report.e_max_met);
}

TEST(SymmetricResult, TheGivenPlaneIsTaken) {
  const TriangleSoup soup = egg(Vector3(0, 0, 2));
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 normal = Vector3::Unit(axis);
    const Decomposition d = run(soup, in_plane(normal, normal.z() * 2), 2);
    expect_sound(soup, d);
    expect_symmetric(d);
    EXPECT_EQ(d.mirror_plane->normal, normal);
    EXPECT_NEAR(d.mirror_plane->offset, normal.z() * 2, 1e-12);
  }
}

TEST(SymmetricResult, APairOfSurfacesOnBothSidesOfThePlane) {
  TriangleSoup soup = shapes::sphere(10);
  const int n = static_cast<int>(soup.points.size());
  const std::vector<std::array<int, 3>> faces = soup.faces;
  for (int i = 0; i < n; ++i) {
    soup.points[i] = Vector3(soup.points[i].x() * 0.7 + 3, soup.points[i].y(), 1.3 * soup.points[i].z());
    soup.points.push_back(soup.points[i].cwiseProduct(Vector3(-1, 1, 1)));
  }
  for (const auto& f : faces) soup.faces.push_back({f[0] + n, f[2] + n, f[1] + n});
  const Decomposition d = run(soup, in_plane(Vector3::UnitX(), 0), 2);
  expect_sound(soup, d);
  expect_symmetric(d);
  for (const StripMesh::Patch& p : d.strips.patches) EXPECT_GE(p.mirror_of, 0);
  EXPECT_EQ(d.strips.patches[0].component, 0);
  EXPECT_EQ(d.strips.patches.back().component, 1);
}

TEST(SymmetricResult, CreasesAndBordersMeetThePlane) {
  for (const TriangleSoup& soup : {shapes::closed_cylinder(40, 8), shapes::cylinder(40, 10)}) {
    const Decomposition d = run(soup, in_plane(Vector3::UnitX(), 0), 2);
    expect_sound(soup, d);
    expect_symmetric(d);
    EXPECT_TRUE(d.report.e_max_met);
  }
}

TEST(SymmetricResult, ASheetThatFoldsAlongThePlaneIsOnePart) {
  // Half a tube along z, cut lengthwise by x = y: one ruling lies on the plane.
  const TriangleSoup soup = shapes::cylinder_patch(30, 20, 1, 2);
  const Decomposition d = run(soup, in_plane(Vector3(1, -1, 0), 0), 2);
  expect_sound(soup, d);
  expect_symmetric(d);
  EXPECT_EQ(d.strips.patches.size(), 1u);
  EXPECT_EQ(d.strips.patches[0].mirror_of, -1);
  EXPECT_EQ(d.report.cut_length, 0);
}

TEST(SymmetricResult, StrictlyConformingToo) {
  DecomposeParams params = symmetric(0.05);
  params.t_junctions = false;
  const TriangleSoup soup = egg(Vector3::Zero());
  const Decomposition d = run(soup, params, 2);
  expect_sound(soup, d);
  expect_symmetric(d);
  EXPECT_EQ(t_junctions(d.strips), 0);
}

TEST(SymmetricResult, WithoutAPlaneTheWholeIsDecomposed) {
  const TriangleSoup soup = shapes::helicoid(10, 40, 1, 2, 0.6);
  const Decomposition d = run(soup, symmetric(), 2);
  expect_sound(soup, d);
  EXPECT_FALSE(d.mirror_plane.has_value());
  const auto& notes = d.report.notes;
  EXPECT_TRUE(std::any_of(notes.begin(), notes.end(), [](const std::string& note) {
    return note.find("no plane of symmetry") != std::string::npos;
  }));
}

TEST(SymmetricResult, AWrongPlaneIsRefused) {
  const TriangleSoup soup = egg(Vector3::Zero());
  for (const DecomposeParams& params :
       {in_plane(Vector3::UnitX(), 0.5), in_plane(Vector3(1, 1, 1), 0), in_plane(Vector3::UnitX(), 9)}) {
    try {
      run(soup, params);
      ADD_FAILURE() << "a wrong plane was taken";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::kUnsupportedMesh);
      EXPECT_EQ(e.where().rfind("symmetry", 0), 0u) << e.where();
      EXPECT_FALSE(e.fix().empty());
    }
  }
}

TEST(SymmetricResult, AWrongPlaneIsToldWithThePlaceThatDeviatesMost) {
  const Vector3 centre(5, -3, 40), bump = centre + Vector3(1, 0, 0);
  TriangleSoup soup = egg(centre);
  for (Vector3& p : soup.points) p.x() += 0.8 * std::exp(-9 * (p - bump).squaredNorm());
  try {
    run(soup, in_plane(Vector3::UnitX(), centre.x()));
    ADD_FAILURE() << "a wrong plane was taken";
  } catch (const Error& e) {
    double x = 0, y = 0, z = 0;
    ASSERT_EQ(std::sscanf(e.where().c_str(), "symmetry, at (%lf, %lf, %lf)", &x, &y, &z), 3) << e.where();
    EXPECT_LT((Vector3(std::abs(x - centre.x()), y - centre.y(), z - centre.z()) - Vector3(1, 0, 0)).norm(),
              0.9)
        << "the bump, or its image on the other side";
  }
}

TEST(SymmetricResult, ASmallDentIsEvenedOut) {
  TriangleSoup soup = egg(Vector3::Zero());
  for (Vector3& p : soup.points)
    if (p.x() > 0) p *= 1 - 0.03 * std::exp(-9 * (p - Vector3(1, 0, 0)).squaredNorm());
  const Decomposition d = run(soup, in_plane(Vector3::UnitX(), 0), 2);
  expect_sound(soup, d);
  expect_symmetric(d);
  EXPECT_TRUE(d.report.e_max_met) << "measured against the dented input";
  EXPECT_FALSE(d.report.notes.empty());
}

// A dent (or bump) as deep as a share of the distance from the centre, on none of the three planes.
TriangleSoup dented_egg(double depth, double narrow) {
  TriangleSoup soup = egg(Vector3::Zero());
  const Vector3 dent = Vector3(1, 1.4, 2) / std::sqrt(3.0);
  for (Vector3& p : soup.points) p *= 1 - depth * std::exp(-narrow * (p - dent).squaredNorm());
  return soup;
}

TEST(SymmetricResult, APlaneIsFoundWhereTheMeshFitsItToHalfOfTheTolerance) {
  const TriangleSoup soup = dented_egg(0.055, 9);  // 1.2 % of the diagonal
  const Decomposition d = run(soup, symmetric(), 2);
  expect_sound(soup, d);
  expect_symmetric(d);
  EXPECT_TRUE(d.report.e_max_met) << "measured against the dented input";
}

// With the plane x = 0 given; few = about so many parts as the same without a dent takes.
void expect_met_with_few_parts(const TriangleSoup& soup, double e_max, std::size_t few) {
  DecomposeParams params = in_plane(Vector3::UnitX(), 0);
  params.e_max = e_max;
  const Decomposition d = run(soup, params, 2);
  expect_sound(soup, d);
  expect_symmetric(d);
  EXPECT_TRUE(d.report.e_max_met) << d.report.hausdorff;
  EXPECT_LE(d.strips.patches.size(), few);
}

TEST(SymmetricResult, ABumpOnOneSideCostsHardlyAPart) {
  expect_met_with_few_parts(dented_egg(-0.06, 5), 0.02, 7);  // 1.5 % of the diagonal
  expect_met_with_few_parts(dented_egg(-0.1, 5), 0.03, 7);   // 2.6 %
}

TEST(SymmetricResult, ABumpHigherThanTheToleranceIsMetHalfWay) {
  expect_met_with_few_parts(dented_egg(-0.1, 5), 0.02, 9);  // 2.6 % of the diagonal
}

TEST(SymmetricResult, ADentThatIsOnlyOnTheOtherSideIsFollowedToo) {
  TriangleSoup soup = dented_egg(-0.06, 5);  // the half that is solved is the one with x > 0
  for (Vector3& p : soup.points) p.x() *= -1;
  for (auto& f : soup.faces) std::swap(f[1], f[2]);
  expect_met_with_few_parts(soup, 0.02, 7);
}

TEST(SymmetricResult, EverySurfaceIsMeasuredAgainstItsOwnTwoSides) {
  // A pair of eggs, one of them with a bump, and around them one that the plane goes through.
  TriangleSoup soup = dented_egg(-0.06, 5);
  const TriangleSoup plain = egg(Vector3::Zero()), bumpy = soup;
  for (Vector3& p : soup.points) p *= 3;
  for (double side : {1.0, -1.0}) {
    const int n = static_cast<int>(soup.points.size());
    for (const Vector3& p : (side > 0 ? plain : bumpy).points)
      soup.points.push_back(p * 0.7 + side * Vector3(1.2, 0, 0));
    for (const auto& f : plain.faces) soup.faces.push_back({f[0] + n, f[1] + n, f[2] + n});
  }
  expect_met_with_few_parts(soup, 0.02, 16);
}

TEST(SymmetricResult, NormalsAreMeasuredOnBothSides) {
  DecomposeParams params = in_plane(Vector3::UnitX(), 0);
  params.normal_deviation = 20;
  const TriangleSoup soup = dented_egg(-0.06, 5);
  const Decomposition d = run(soup, params, 2);
  expect_sound(soup, d);
  expect_symmetric(d);
  EXPECT_TRUE(d.report.normal_deviation_met) << d.report.normal_deviation;
}

}  // namespace
}  // namespace sheetform
