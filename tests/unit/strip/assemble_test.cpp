#include "sheetform/strip/assemble.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sheetform/strip/certificate.h"
#include "support/shapes.h"
#include "support/strip_shapes.h"

namespace sheetform {
namespace {

std::string text_of(const std::vector<Defect>& defects) {
  std::string text;
  for (const Defect& d : defects)
    text += d.check + " patch " + std::to_string(d.patch) + ": " + d.text + "\n";
  return text;
}

// Two leaves over a common arch: points 0..n below, n+1..2n+1 on the seam, then above.
StripSource two_leaves(int n) {
  StripSource source;
  for (int row = 0; row < 3; ++row)
    for (int i = 0; i <= n; ++i) {
      const double x = double(i) / n;
      source.points.emplace_back(2 * x, row < 2 ? row - 1.0 : 0.6, 0.3 * x * (1 - x) - (row == 2 ? 0.8 : 0));
    }
  const auto id = [&](int row, int i) { return row * (n + 1) + i; };
  for (int p = 0; p < 2; ++p) {
    StripSource::Patch patch;
    for (int i = 0; i <= n; ++i) patch.outline.push_back(id(p, i));
    for (int i = n; i >= 0; --i) patch.outline.push_back(id(p + 1, i));
    const auto low = [&](int i) { return i; };
    const auto high = [&](int i) { return 2 * n + 1 - i; };
    for (int i = 0; i < n; ++i) {
      if (i > 0) patch.rulings.push_back({low(i), high(i)});
      patch.triangles.push_back({low(i), low(i + 1), high(i + 1)});
      patch.triangles.push_back({low(i), high(i + 1), high(i)});
      patch.rulings.push_back({low(i), high(i + 1)});
    }
    patch.corners = {0, n, n + 1, 2 * n + 1};
    // In the order of the outline: lower arch, right end, upper arch, left end.
    patch.arches = p == 0 ? std::vector<int>{0, 1, 2, 3} : std::vector<int>{2, 4, 5, 6};
    source.patches.push_back(std::move(patch));
  }
  const auto along = [&](int row) {
    std::vector<int> line;
    for (int i = 0; i <= n; ++i) line.push_back(id(row, i));
    return line;
  };
  source.arches = {{along(0), {0, -1}},
                   {{id(0, n), id(1, n)}, {0, -1}},
                   {along(1), {0, 1}, true},
                   {{id(1, 0), id(0, 0)}, {0, -1}},
                   {{id(1, n), id(2, n)}, {1, -1}},
                   {along(2), {1, -1}},
                   {{id(2, 0), id(1, 0)}, {1, -1}}};
  return source;
}

TEST(AssembleStrips, GivesASoundResult) {
  const StripMesh strips = assemble_strips(two_leaves(12));
  TriangleSoup soup = shapes::soup_of(strips);
  const SurfaceMesh surface = build_surface_mesh(soup.points, soup.faces);
  double isometry = -1;
  const auto defects = check_structure(strips, &surface, 6, 3, &isometry);
  EXPECT_TRUE(defects.empty()) << text_of(defects);
  EXPECT_LT(isometry, 1e-12);
  ASSERT_EQ(strips.patches.size(), 2u);
  EXPECT_EQ(strips.points.size(), 39u);
  EXPECT_EQ(strips.uvs.size(), 2u * 26) << "one flat place for each (patch, vertex)";
  EXPECT_TRUE(strips.arches[2].crease);
  EXPECT_FALSE(strips.arches[0].crease);
  EXPECT_EQ(strips.patches[1].corners, (std::vector<int>{0, 12, 13, 25}));
}

TEST(AssembleStrips, NamesPointsByTheirSharedIndex) {
  const StripSource source = two_leaves(4);
  const StripMesh strips = assemble_strips(source);
  for (std::size_t p = 0; p < 2; ++p) {
    const StripMesh::Patch& patch = strips.patches[p];
    EXPECT_EQ(patch.boundary, source.patches[p].outline);
    ASSERT_EQ(patch.boundary_vt.size(), patch.boundary.size());
    for (std::size_t t = 0; t < patch.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        const int place = source.patches[p].triangles[t][k];
        EXPECT_EQ(patch.triangles[t].v[k], source.patches[p].outline[place]);
        EXPECT_EQ(patch.triangles[t].vt[k], patch.boundary_vt[place]);
      }
    for (std::size_t r = 0; r < patch.rulings.size(); ++r)
      for (int k = 0; k < 2; ++k)
        EXPECT_EQ(patch.rulings[r][k], source.patches[p].outline[source.patches[p].rulings[r][k]]);
  }
}

TEST(AssembleStrips, SeamOfAPatchWithItselfHasTwoFlatPlaces) {
  // A tube: the outline passes the seam's points twice.
  const int n = 12;
  StripSource source;
  for (int i = 0; i < n; ++i)
    for (double z : {0.0, 2.0})
      source.points.emplace_back(std::cos(2 * shapes::kPi * i / n), std::sin(2 * shapes::kPi * i / n), z);
  StripSource::Patch patch;
  for (int i = 0; i <= n; ++i) patch.outline.push_back(2 * (i % n));
  for (int i = n; i >= 0; --i) patch.outline.push_back(2 * (i % n) + 1);
  for (int i = 0; i < n; ++i) {
    patch.triangles.push_back({i, i + 1, 2 * n - i});
    patch.triangles.push_back({i, 2 * n - i, 2 * n + 1 - i});
    if (i > 0) patch.rulings.push_back({i, 2 * n + 1 - i});
  }
  patch.corners = {0, n, n + 1, 2 * n + 1};
  patch.arches = {0, 1, 2, 1};
  source.patches = {patch};
  std::vector<int> low, high;
  for (int i = 0; i <= n; ++i) low.push_back(2 * (i % n)), high.push_back(2 * (i % n) + 1);
  source.arches = {{low, {0, -1}}, {{0, 1}, {0, 0}}, {high, {0, -1}}};
  const StripMesh strips = assemble_strips(source);
  TriangleSoup soup = shapes::soup_of(strips);
  const SurfaceMesh surface = build_surface_mesh(soup.points, soup.faces);
  const auto defects = check_structure(strips, &surface, 6, 3);
  EXPECT_TRUE(defects.empty()) << text_of(defects);
  EXPECT_EQ(strips.uvs.size(), strips.points.size() + 2);
}

// Half of an arc of this many degrees for each of the leaves, in n steps: planar quads between rungs.
StripMesh bent(int n, double degrees) {
  StripSource source = two_leaves(n);
  const double whole = degrees * shapes::kPi / 180;
  for (int i = 0; i <= n; ++i) {
    const double a = whole * i / n, r = whole > 0 ? 2 / whole : 0;
    const double x = whole > 0 ? r * std::sin(a) : 2.0 * i / n, z = whole > 0 ? r * (1 - std::cos(a)) : 0;
    for (int row = 0; row < 3; ++row) source.points[row * (n + 1) + i] = {x, row - 1.0, z};
  }
  return assemble_strips(source);
}

TEST(DropFlatRulings, OnlyWhereTheSheetBendsThereAreRulings) {
  StripMesh strips = bent(12, 60);
  drop_flat_rulings(strips);
  for (const auto& patch : strips.patches) {
    EXPECT_EQ(patch.rulings.size(), 11u) << "the rungs, not the diagonals of plane quads";
    for (const auto& [a, b] : patch.rulings) EXPECT_NEAR(strips.points[a].x(), strips.points[b].x(), 1e-12);
  }
}

TEST(DropFlatRulings, SmallBendsAddUp) {
  StripMesh strips = bent(120, 24);  // a fifth of a degree at each rung
  drop_flat_rulings(strips);
  for (const auto& patch : strips.patches) EXPECT_EQ(patch.rulings.size(), 39u) << "at every third rung";
  TriangleSoup soup = shapes::soup_of(strips);
  const SurfaceMesh surface = build_surface_mesh(soup.points, soup.faces);
  EXPECT_TRUE(check_structure(strips, &surface, 6, 4).empty());
}

TEST(DropFlatRulings, APlaneHasNoneAndWhatIsAlmostPlaneOne) {
  StripMesh plane = bent(12, 0), almost = bent(12, 0.4);
  drop_flat_rulings(plane), drop_flat_rulings(almost);
  for (int p : {0, 1}) {
    EXPECT_TRUE(plane.patches[p].rulings.empty());
    EXPECT_EQ(almost.patches[p].rulings.size(), 1u);
    EXPECT_TRUE(check_patch(plane, p, 4).empty());
    EXPECT_TRUE(check_patch(almost, p, 4).empty());
  }
}

TEST(Append, ShiftsEveryIndex) {
  StripMesh all = shapes::cube_faces();
  const StripMesh cube = all, leaves = shapes::two_leaves(60, 0.4, 6);
  append(all, leaves, 1);
  EXPECT_EQ(all.points.size(), cube.points.size() + leaves.points.size());
  EXPECT_EQ(all.patches.size(), cube.patches.size() + leaves.patches.size());
  EXPECT_EQ(all.arches.size(), cube.arches.size() + leaves.arches.size());
  // The second component lies inside of the cube's box; nothing is shared, so it is sound as a whole.
  TriangleSoup soup = shapes::soup_of(all);
  const SurfaceMesh surface = build_surface_mesh(soup.points, soup.faces);
  const auto defects = check_structure(all, &surface, 6, 4);
  EXPECT_TRUE(defects.empty()) << text_of(defects);
  for (std::size_t p = 0; p < all.patches.size(); ++p)
    EXPECT_EQ(all.patches[p].component, p < cube.patches.size() ? 0 : 1);
  const auto& last = all.patches.back();
  const auto& same = leaves.patches.back();
  for (std::size_t i = 0; i < last.boundary.size(); ++i) {
    EXPECT_EQ(all.points[last.boundary[i]], leaves.points[same.boundary[i]]);
    EXPECT_EQ(all.uvs[last.boundary_vt[i]], leaves.uvs[same.boundary_vt[i]]);
  }
}

TEST(Append, ToNothingIsACopy) {
  StripMesh all;
  const StripMesh cube = shapes::cube_faces();
  append(all, cube, 0);
  EXPECT_EQ(all.points, cube.points);
  ASSERT_EQ(all.patches.size(), cube.patches.size());
  EXPECT_EQ(all.patches[5].boundary, cube.patches[5].boundary);
  EXPECT_EQ(all.arches[3].patches, cube.arches[3].patches);
}

TEST(Append, KeepsMirrorImagesAndBorders) {
  StripMesh half = shapes::two_leaves(60, 0, 3);
  half.patches[1].mirror_of = 0;
  StripMesh all = shapes::cube_faces();
  append(all, half, 2);
  EXPECT_EQ(all.patches[6].mirror_of, -1);
  EXPECT_EQ(all.patches[7].mirror_of, 6);
  int borders = 0;
  for (const auto& a : all.arches) borders += a.patches[1] < 0;
  int wanted = 0;
  for (const auto& a : half.arches) wanted += a.patches[1] < 0;
  EXPECT_EQ(borders, wanted);
  EXPECT_GT(wanted, 0);
}

}  // namespace
}  // namespace sheetform
