#include "sheetform/strip/mirror.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "sheetform/strip/certificate.h"
#include "sheetform/strip/mirror_distance.h"
#include "support/shapes.h"
#include "support/strip_shapes.h"

namespace sheetform {
namespace {

// A half of a curved sheet, x in [0, 1], whose first side lies on the plane; one patch of n quads.
StripMesh half_sheet(int n) {
  std::vector<Vector3> points;
  std::vector<int> inner, outer;
  for (int i = 0; i <= n; ++i) {
    const double y = 2.0 * i / n, z = 0.3 * std::sin(y);
    inner.push_back(static_cast<int>(points.size())), points.emplace_back(0, y, z);
    outer.push_back(static_cast<int>(points.size())), points.emplace_back(1, y, z);
  }
  shapes::StripBuilder builder(points);
  builder.add_strip(inner, outer, {inner.front(), inner.back(), outer.front(), outer.back()});
  StripMesh half = builder.finish();
  for (StripMesh::Arch& a : half.arches) {
    a.on_plane = true;
    for (int v : a.vertices) a.on_plane &= half.points[v].x() == 0;
  }
  return half;
}

TEST(Mirror, HalvesBecomeOneSurfaceWithASeamOnThePlane) {
  const StripMesh half = half_sheet(7), whole = with_mirror_image(half);
  EXPECT_EQ(half.points.size(), 16u);
  EXPECT_EQ(whole.points.size(), 24u) << "eight are shared";
  ASSERT_EQ(whole.patches.size(), 2u);
  EXPECT_EQ(whole.patches[0].mirror_of, 1);
  EXPECT_EQ(whole.patches[1].mirror_of, 0);
  EXPECT_EQ(whole.patches[1].component, whole.patches[0].component);
  double isometry = 1;
  EXPECT_TRUE(check_structure(whole, nullptr, 4, 3, &isometry).empty());
  EXPECT_LT(isometry, 1e-12);
  int seams = 0;
  for (const StripMesh::Arch& a : whole.arches)
    if (a.patches[1] >= 0) {
      ++seams;
      EXPECT_TRUE(a.on_plane);
      EXPECT_EQ(a.patches, (std::array{0, 1}));
      EXPECT_EQ(a.vertices.size(), 8u);
    }
  EXPECT_EQ(seams, 1);
}

TEST(Mirror, EveryPlaceOfAnOutlineHasItsImage) {
  const StripMesh whole = with_mirror_image(half_sheet(5));
  const StripMesh::Patch &a = whole.patches[0], &b = whole.patches[1];
  const std::size_t n = a.boundary.size();
  ASSERT_EQ(b.boundary.size(), n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = (n - i) % n;
    EXPECT_EQ(whole.points[b.boundary[j]], whole.points[a.boundary[i]].cwiseProduct(Vector3(-1, 1, 1)));
    EXPECT_EQ(whole.uvs[b.boundary_vt[j]], whole.uvs[a.boundary_vt[i]].cwiseProduct(Vector2(-1, 1)));
  }
  ASSERT_EQ(a.rulings.size(), b.rulings.size());
}

// A half whose only contact with the plane is one straight segment; it bends on the way to x = 1.
StripMesh half_roof(int n, double slope) {
  std::vector<Vector3> points;
  std::vector<int> front, back;
  for (int i = 0; i <= n; ++i) {
    const double x = 1.0 * i / n, z = -slope * x * x;
    front.push_back(static_cast<int>(points.size())), points.emplace_back(x, 0, z);
    back.push_back(static_cast<int>(points.size())), points.emplace_back(x, 1 + 0.2 * x, z);
  }
  shapes::StripBuilder builder(points);
  builder.add_strip(back, front, {front.front(), back.front(), front.back(), back.back()});
  StripMesh half = builder.finish();
  for (StripMesh::Arch& a : half.arches)
    a.on_plane =
        a.vertices.size() == 2 && half.points[a.vertices[0]].x() == 0 && half.points[a.vertices[1]].x() == 0;
  return half;
}

TEST(JoinImages, AStraightSeamOnThePlaneBecomesARuling) {
  const StripMesh whole = with_mirror_image(half_roof(6, 0.4));
  const StripMesh joined = join_images(whole, {4});
  ASSERT_EQ(whole.patches.size(), 2u);
  ASSERT_EQ(joined.patches.size(), 1u);
  const StripMesh::Patch& p = joined.patches[0];
  EXPECT_EQ(p.mirror_of, -1) << "its own image";
  EXPECT_EQ(p.corners.size(), 4u) << "none where the outline crosses the plane at 11 degrees";
  EXPECT_EQ(p.triangles.size(), 24u);
  EXPECT_EQ(p.rulings.size(), 11u) << "five of each half, and the seam";
  EXPECT_EQ(joined.points.size(), whole.points.size());
  EXPECT_EQ(joined.uvs.size(), p.boundary.size()) << "none left over";
  EXPECT_EQ(joined.arches.size() + 1, whole.arches.size());
  double isometry = 1;
  EXPECT_TRUE(check_structure(joined, nullptr, 4, 3, &isometry).empty());
  EXPECT_LT(isometry, 1e-12);
}

TEST(JoinImages, HalfATubeBecomesOneSheetGluedToItself) {
  // Half a tube along z from (0, 1) to (0, -1): both long sides lie on the plane.
  std::vector<Vector3> points;
  std::vector<int> low, high;
  constexpr int kSteps = 9;
  for (int i = 0; i <= kSteps; ++i) {
    const double angle = shapes::kPi * i / kSteps, x = i == kSteps ? 0 : std::sin(angle);
    low.push_back(static_cast<int>(points.size())), points.emplace_back(x, std::cos(angle), 0);
    high.push_back(static_cast<int>(points.size())), points.emplace_back(x, std::cos(angle), 2);
  }
  shapes::StripBuilder builder(points);
  builder.add_strip(low, high, {low.front(), low.back(), high.front(), high.back()});
  StripMesh half = builder.finish();
  for (StripMesh::Arch& a : half.arches) a.on_plane = a.vertices.size() == 2;
  const StripMesh joined = join_images(with_mirror_image(half), {6});
  ASSERT_EQ(joined.patches.size(), 1u);
  int seams = 0;
  for (const StripMesh::Arch& a : joined.arches) seams += a.patches == std::array{0, 0};
  EXPECT_EQ(seams, 1);
  EXPECT_TRUE(check_structure(joined, nullptr, 6, 3).empty());
  EXPECT_EQ(join_images(with_mirror_image(half), {6, false, false}).patches.size(), 2u) << "no self-seams";
}

TEST(JoinImages, NothingIsJoinedAgainstTheRules) {
  const StripMesh whole = with_mirror_image(half_roof(6, 0.4));
  EXPECT_EQ(join_images(whole, {3}).patches.size(), 2u) << "it would have four sides";
  EXPECT_EQ(join_images(whole, {5, true}).patches.size(), 2u) << "six with every node a corner";
  EXPECT_EQ(join_images(whole, {6, true}).patches.size(), 1u);
  EXPECT_EQ(join_images(with_mirror_image(half_sheet(5)), {6}).patches.size(), 2u) << "a bent seam stays";
}

// A cone of `n` sides whose rim has one edge on the plane, or two on both sides of the point where its seam
// with itself begins.
StripMesh cone_at_plane(int n, bool at_seam) {
  StripMesh cone = shapes::cone(n);
  std::vector<Vector3> points = cone.points;
  const std::vector<int> on_plane =
      at_seam ? std::vector<int>{n, 1, 2} : std::vector<int>{n / 2 + 1, n / 2 + 2};
  const double turned = at_seam ? -1 : 1, low = turned * points[on_plane.back()].x();
  for (Vector3& p : points) p = Vector3(turned * p.x() - low, turned * p.y(), p.z());
  for (int v : on_plane) points[v].x() = 0;
  std::vector<std::array<int, 3>> chain;
  std::vector<std::array<int, 2>> rulings;
  for (int i = 0; i < n; ++i) {
    chain.push_back({0, 1 + i, 1 + (i + 1) % n});
    if (i > 0) rulings.push_back({0, 1 + i});
  }
  std::vector<int> corners = on_plane;
  corners.insert(corners.end(), {0, 1});
  shapes::StripBuilder builder(points);
  builder.add(chain, corners, rulings);
  StripMesh half = builder.finish();
  for (StripMesh::Arch& a : half.arches) {
    a.on_plane = true;
    for (int v : a.vertices) a.on_plane &= half.points[v].x() == 0;
  }
  return half;
}

TEST(JoinImages, APartWithADartStaysOneOfTwo) {
  for (const bool at_seam : {false, true}) {
    const StripMesh half = cone_at_plane(23, at_seam);
    EXPECT_EQ(std::count_if(half.arches.begin(), half.arches.end(),
                            [](const StripMesh::Arch& a) { return a.on_plane && a.vertices.size() == 2; }),
              at_seam ? 2 : 1);
    const StripMesh whole = with_mirror_image(half), joined = join_images(whole, {20});
    EXPECT_EQ(joined.patches.size(), 2u);
    EXPECT_EQ(joined.arches.size(), whole.arches.size());
    EXPECT_TRUE(check_structure(joined, nullptr, 20, 4).empty());
  }
}

// Both sides of half_sheet(n), its image raised by `lift` where it is farthest from the plane.
struct LiftedImage {
  StripMesh half;
  TriangleSoup input;
  ClosestPointTree tree;
  LiftedImage(int n, double lift) : half(half_sheet(n)), input(shapes::soup_of(with_mirror_image(half))) {
    for (Vector3& p : input.points)
      if (p.x() == -1) p.z() += lift;
    tree = ClosestPointTree(input.points, input.faces);
  }
};

TEST(MirrorDistance, WhatIsFarOnTheSideOfTheImageIsToldOfTheHalf) {
  const LiftedImage lifted(7, 0.1);
  RunContext context;
  const HeightBound over(lifted.input.points, lifted.input.faces, lifted.tree.diagonal());
  const DistanceReport near =
      find_far_with_image(lifted.input, lifted.tree, over, lifted.half, 0.11, context);
  EXPECT_TRUE(near.far.empty());
  const DistanceReport d = find_far_with_image(lifted.input, lifted.tree, over, lifted.half, 0.02, context);
  ASSERT_EQ(d.patch_error.size(), 1u);
  EXPECT_NEAR(d.patch_error[0], 0.1, 0.01);
  EXPECT_LT(d.worst_place.x(), 0) << "where it is";
  EXPECT_GE(d.far.size(), 14u) << "each way half of the triangles at least";
  const auto points = static_cast<int>(lifted.half.points.size());
  for (const FarPlace& place : d.far) {
    Vector3 at = Vector3::Zero();
    for (int k = 0; k < 3; ++k) {
      ASSERT_LT(place.triangle[k], points);
      at += place.barycentric[k] * lifted.half.points[place.triangle[k]];
    }
    EXPECT_GT(place.on_input.x(), 0);
    EXPECT_NEAR((place.on_input - at).norm(), place.distance, 1e-9);
    EXPECT_GT(place.on_input.z(), at.z()) << "up, as the other side is";
  }
}

TEST(MirrorDistance, TiltsOfTheImageCountForThePatch) {
  const LiftedImage lifted(7, 0.5);
  RunContext context;
  const NormalReport n = measure_normals_with_image(lifted.input, lifted.tree, lifted.half, 4000, context);
  ASSERT_EQ(n.patch_quantile.size(), 1u);
  EXPECT_GT(n.patch_quantile[0], 20) << "half of 1 over 1";
}

TEST(Mirror, SurfacesOffThePlaneBecomeTwo) {
  StripMesh half = shapes::tube(12);
  for (Vector3& p : half.points) p.x() += 5;
  const StripMesh whole = with_mirror_image(half);
  EXPECT_EQ(whole.points.size(), 2 * half.points.size());
  EXPECT_NE(whole.patches[0].component, whole.patches[1].component);
  EXPECT_TRUE(check_structure(whole, nullptr, 6, 12).empty());
}

}  // namespace
}  // namespace sheetform
