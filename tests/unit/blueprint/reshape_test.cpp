// Parts made to fit: thick material, large parts, bending radii and hinges.
#include "sheetform/blueprint/reshape.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "sheetform/base/error.h"
#include "sheetform/blueprint/fold_lines.h"
#include "sheetform/blueprint/hinges.h"
#include "sheetform/blueprint/materials.h"
#include "sheetform/blueprint/result_writer.h"
#include "sheetform/blueprint/seams.h"
#include "sheetform/strip/certificate.h"
#include "sheetform/strip/outline.h"
#include "support/shapes.h"
#include "support/strip_shapes.h"

namespace sheetform {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string text_of(const std::vector<Defect>& defects) {
  std::string text;
  for (const Defect& d : defects)
    text += d.check + " patch " + std::to_string(d.patch) + ": " + d.text + "\n";
  return text;
}

Blueprint blueprint_of(const StripMesh& strips, const BlueprintOptions& options, double scale = 50) {
  return make_blueprint(strips, scale, part_labels(strips), options);
}

// --- thickness
// -----------------------------------------------------------------------------------------------------

TEST(MovedSurface, OfAPrismIsTheSmallerPrism) {
  // A tube of 24 flat sides moved inwards by d: its flats move by exactly d.
  const int n = 24;
  const double d = 0.1, apothem = std::cos(shapes::kPi / n);
  const StripMesh tube = shapes::tube(n), moved = moved_surface(tube, -d, {"A1"}, 4);
  for (const Vector3& p : moved.points) EXPECT_NEAR(p.head<2>().norm(), (apothem - d) / apothem, 2e-3);
  EXPECT_TRUE(check_structure(moved, nullptr, 6, 4).empty());
  double length = 0;
  for (const StripMesh::Arch& a : moved.arches)
    if (a.patches[1] < 0)
      for (std::size_t i = 0; i + 1 < a.vertices.size(); ++i)
        length += (moved.points[a.vertices[i]] - moved.points[a.vertices[i + 1]]).norm();
  EXPECT_NEAR(length / 2, 2 * n * std::tan(shapes::kPi / n) * (apothem - d),
              0.02);  // the girth of the smaller prism
}

TEST(MovedSurface, OfACubeIsTheSmallerCubeAndSeamsStayEqual) {
  BlueprintOptions o;
  o.thickness = 3, o.mesh_surface = MeshSurface::kOutside;
  const Blueprint b = blueprint_of(shapes::cube_faces(), o);
  for (const BlueprintPart& part : b.parts) EXPECT_NEAR(std::sqrt(part.area), 97, 0.01);
  for (const Seam& seam : b.seams)
    EXPECT_NEAR(length_of(side_of(seam, 0, b.flat)), length_of(side_of(seam, 1, b.flat)), 1e-9);
  o.mesh_surface = MeshSurface::kInside;
  EXPECT_NEAR(std::sqrt(blueprint_of(shapes::cube_faces(), o).parts[0].area), 103, 0.01);
  o.mesh_surface = MeshSurface::kMiddle;
  EXPECT_NEAR(std::sqrt(blueprint_of(shapes::cube_faces(), o).parts[0].area), 100, 1e-9);
}

TEST(MovedSurface, TooThickIsRefusedWithTheParts) {
  BlueprintOptions o;
  o.thickness = 100, o.mesh_surface = MeshSurface::kOutside;
  try {
    blueprint_of(shapes::torus_pieces(12, 4, 15), o);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.where(), "thickness");
    EXPECT_THAT(e.what(), HasSubstr("A1"));
  }
}

// --- splitting
// -----------------------------------------------------------------------------------------------------

TEST(Split, LeavesASoundResultWhereverItCuts) {
  for (const StripMesh& whole : {shapes::tube(24), shapes::cone(24), shapes::two_leaves(60, 0.4, 12),
                                 shapes::torus_pieces(12, 4, 15), shapes::torus_bands(12, 60)}) {
    for (std::size_t p = 0; p < std::min<std::size_t>(3, whole.patches.size()); ++p)
      for (std::size_t r = 0; r < whole.patches[p].rulings.size(); r += 5) {
        StripMesh m = whole;
        const auto [a, b] = m.patches[p].rulings[r];
        std::array<int, 2> edge{};
        for (const StripMesh::Triangle& t : m.patches[p].triangles)
          for (int k = 0; k < 3; ++k)
            if (t.v[k] == a && t.v[(k + 1) % 3] == b) edge = {t.vt[k], t.vt[(k + 1) % 3]};
        split_patch(m, static_cast<int>(p), edge);
        EXPECT_EQ(m.patches.size(), whole.patches.size() + 1);
        const auto defects = check_structure(m, nullptr, 12, 4);
        EXPECT_TRUE(defects.empty()) << "patch " << p << " ruling " << r << "\n" << text_of(defects);
        EXPECT_EQ(m.patches[p].rulings.size() + m.patches.back().rulings.size() + 1,
                  whole.patches[p].rulings.size());
      }
  }
}

TEST(Split, MakesEveryPartFitItsSheet) {
  BlueprintOptions o;
  o.sheet_width = 150, o.sheet_height = 120, o.oversize = Oversize::kSplit;
  const Blueprint b = blueprint_of(shapes::tube(24), o);  // 313 x 100 mm
  EXPECT_EQ(b.parts.size(), 4u);  // halves and halves again, as every cut makes the larger half smallest
  std::set<std::string> labels;
  for (const BlueprintPart& part : b.parts) labels.insert(part.label);
  EXPECT_THAT(labels, ElementsAre("A1a", "A1b", "A1c", "A1d"));
  EXPECT_EQ(b.seams.size(), 4u);
  for (const BlueprintSheet& sheet : b.sheets)
    for (const PlacedPart& p : sheet.parts)
      for (const Vector2& q : placed(b.parts[p.part].outline, p.placement)) {
        EXPECT_GE(q.minCoeff(), o.margin - 1e-6);
        EXPECT_LE(q.x(), 150 - o.margin + 1e-6);
        EXPECT_LE(q.y(), 120 - o.margin + 1e-6);
      }
}

TEST(Split, RefusesWhatNoCutHelps) {
  BlueprintOptions o;
  o.sheet_width = 60, o.sheet_height = 60, o.oversize = Oversize::kSplit;
  try {
    blueprint_of(shapes::tube(24), o);  // rulings are 100 mm long
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.where(), "sheet");
    EXPECT_THAT(e.what(), HasSubstr("A1"));
  }
}

// --- bending
// -------------------------------------------------------------------------------------------------------

TEST(ThickSeams, AreNamedWithTheirAngle) {
  BlueprintOptions o;
  o.thickness = 3;
  const StripMesh cube = shapes::cube_faces();
  const Blueprint thick = make_blueprint(cube, 50, part_labels(cube), o);
  ASSERT_EQ(thick.warnings.size(), 1u);
  EXPECT_NE(thick.warnings[0].find("12 (90 degrees, inside edges)"), std::string::npos) << thick.warnings[0];
  o.thickness = 0.3;  // 0.15 mm at each edge: nobody bevels card
  EXPECT_TRUE(make_blueprint(cube, 50, part_labels(cube), o).warnings.empty());
  const StripMesh flat = shapes::two_leaves(0, 0, 4);
  o.thickness = 3;
  EXPECT_TRUE(make_blueprint(flat, 50, part_labels(flat), o).warnings.empty());
}

TEST(Materials, TableIsReadBetweenItsEntries) {
  const Material& ply = material_named("plywood");
  EXPECT_EQ(smallest_radius(ply, 3.2), 305);
  EXPECT_NEAR(smallest_radius(ply, 2.5), 218.5, 0.1);
  EXPECT_NEAR(smallest_radius(ply, 0.45), 25.5, 1e-9);
  EXPECT_NEAR(smallest_radius(ply, 12.8), 1574, 1e-9);
  EXPECT_EQ(smallest_radius(material_named("paper"), 0.3), 0);
  EXPECT_EQ(smallest_radius(material_named("aluminium"), 2), 2);
  EXPECT_THROW(material_named("gold"), Error);
}

TEST(Bending, RadiusOfATubeIsItsRadius) {
  const Blueprint b = blueprint_of(shapes::tube(48), {});
  const std::vector<double> radii = bend_radii(b, 0);
  ASSERT_EQ(radii.size(), 47u);
  for (double r : radii) EXPECT_NEAR(r, 50, 0.1);
  EXPECT_NEAR(b.parts[0].smallest_radius, 50, 0.1);
}

// Two flat halves at a right angle over one ruling, and the same with a narrow pleat in one of them.
StripMesh folded(double pleat) {
  StripMesh s;
  s.points = {{-40, 0, 0}, {0, 0, 0}, {0, 0, 40}, {0, 60, 40}, {0, 60, 0}, {-40, 60, 0}};
  s.uvs = {{0, 0}, {40, 0}, {80, 0}, {80, 60}, {40, 60}, {0, 60}};
  std::vector<std::array<int, 3>> faces = {{0, 1, 4}, {0, 4, 5}, {1, 2, 3}, {1, 3, 4}};
  StripMesh::Patch p;
  p.rulings = {{1, 4}};
  if (pleat > 0) {
    s.points.insert(
        s.points.end(),
        {{-21, 0, 0}, {-20, 0, pleat}, {-19, 0, 0}, {-21, 60, 0}, {-20, 60, pleat}, {-19, 60, 0}});
    const double w = std::hypot(1, pleat);  // flat, from the fold to the left
    s.uvs = {{40 - 38 - 2 * w, 0}, {40, 0}, {80, 0}, {80, 60}, {40, 60}, {2 - 2 * w, 60}};
    for (double y : {0.0, 60.0}) s.uvs.insert(s.uvs.end(), {{21 - 2 * w, y}, {21 - w, y}, {21, y}});
    faces = {{0, 6, 9},   {0, 9, 5}, {6, 7, 10}, {6, 10, 9}, {7, 8, 11},
             {7, 11, 10}, {8, 1, 4}, {8, 4, 11}, {1, 2, 3},  {1, 3, 4}};
    p.rulings = {{6, 9}, {7, 10}, {8, 11}, {1, 4}};
  }
  for (const auto& f : faces) p.triangles.push_back({f, f});
  s.patches.push_back(p);
  return s;
}

std::vector<double> radii_of(const StripMesh& s, double reach) {
  return bend_radii(s, 0, creases_of(s, 0), s.uvs, reach);
}

TEST(Bending, OfASingleRulingIsHalfTheWidthOverItsTurn) {
  const std::vector<double> radii = radii_of(folded(0), 10);
  ASSERT_EQ(radii.size(), 1u);
  EXPECT_NEAR(radii[0], 40 / (shapes::kPi / 2), 1e-9);
}

TEST(Bending, APleatIsEvenedOutOverTheReach) {
  const StripMesh pleated = folded(1);
  const std::vector<double> fine = radii_of(pleated, 0.1), coarse = radii_of(pleated, 20);
  ASSERT_EQ(fine.size(), 4u);
  EXPECT_LT(fine[1], 2);  // one ruling alone turns by a right angle within its share
  EXPECT_GT(coarse[1], 100);
  EXPECT_NEAR(coarse[3], 29.5 / (shapes::kPi / 2), 6);  // its share is 29.5 wide, some of it is the pleat's
}

TEST(Bending, TooTightIsSaidAndHingesAreCut) {
  BlueprintOptions o;
  o.material = "plywood", o.thickness = 3.2;
  const Blueprint plain = blueprint_of(shapes::tube(48), o);
  ASSERT_EQ(plain.warnings.size(), 1u);
  EXPECT_THAT(plain.warnings[0], HasSubstr("305"));
  o.hinges = true, o.kerf = 0.2;
  const Blueprint hinged = blueprint_of(shapes::tube(48), o);
  int slots = 0;
  for (const BlueprintLine& line : hinged.parts[0].lines) {
    if (line.operation != Operation::kCutInner) continue;
    ++slots;
    EXPECT_TRUE(line.closed);
    EXPECT_LT(signed_area(line.points), 0);
    for (const Vector2& p : line.points) {
      EXPECT_TRUE(contains(hinged.parts[0].outline, p));
      for (std::size_t i = 0; i < hinged.parts[0].outline.size(); ++i)
        EXPECT_GT(point_segment_distance(p, hinged.parts[0].outline[i],
                                         hinged.parts[0].outline[(i + 1) % hinged.parts[0].outline.size()]),
                  0.8 * 3.2);
    }
  }
  EXPECT_GT(slots, 300);
  for (const BlueprintLine& score : hinged.parts[0].lines)
    EXPECT_NE(score.operation, Operation::kScoreMountain);  // slots do it
  for (const BlueprintLine& text : hinged.parts[0].lines) {
    if (text.operation != Operation::kText) continue;
    for (const BlueprintLine& slot : hinged.parts[0].lines) {
      if (slot.operation != Operation::kCutInner) continue;
      for (std::size_t i = 0; i + 1 < text.points.size(); ++i)
        for (std::size_t k = 0; k < 4; ++k)
          ASSERT_GT(
              segment_distance(text.points[i], text.points[i + 1], slot.points[k], slot.points[(k + 1) % 4]),
              0.3);
    }
  }
  o.material = "paper";
  EXPECT_TRUE(blueprint_of(shapes::tube(48), o).warnings.empty());
}

TEST(Bending, SlotsDoNotTouch) {
  BlueprintOptions o;
  o.material = "plywood", o.thickness = 3.2, o.hinges = true;
  const Blueprint b = blueprint_of(shapes::cone(48), o);
  Polygons slots;
  for (const BlueprintLine& line : b.parts[0].lines)
    if (line.operation == Operation::kCutInner) slots.push_back(line.points);
  ASSERT_GT(slots.size(), 50u);
  double sum = 0;
  for (Polygon& s : slots) std::reverse(s.begin(), s.end()), sum += signed_area(s);
  EXPECT_NEAR(area_of(unite(slots)), sum, 1e-3);  // grown together they would cover less
}

}  // namespace
}  // namespace sheetform
