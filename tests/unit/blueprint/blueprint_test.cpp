// The blueprint model: seams, marks, joints, nesting.
#include "sheetform/blueprint/blueprint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <set>

#include "sheetform/base/error.h"
#include "sheetform/blueprint/assembly.h"
#include "sheetform/blueprint/fold_lines.h"
#include "sheetform/blueprint/nesting.h"
#include "sheetform/blueprint/result_writer.h"
#include "sheetform/blueprint/seams.h"
#include "sheetform/blueprint/stroke_font.h"
#include "sheetform/strip/outline.h"
#include "support/shapes.h"
#include "support/strip_shapes.h"

namespace sheetform {
namespace {

using ::testing::ElementsAre;

Blueprint blueprint_of(const StripMesh& strips, const BlueprintOptions& options = {}, double scale = 50) {
  return make_blueprint(strips, scale, part_labels(strips), options);
}

std::vector<StripMesh> models() {
  return {shapes::cube_faces(),
          shapes::tube(24),
          shapes::cone(24),
          shapes::cone(24, 1, 0.25),  // a narrow slit: it opens by 11 degrees
          shapes::two_leaves(60, 0.4, 12),
          shapes::torus_pieces(12, 4, 15),
          shapes::torus_bands(12, 60)};
}

// --- seams
// ---------------------------------------------------------------------------------------------------------

TEST(Seams, BothSidesAreEquallyLongAtEveryPoint) {
  for (const StripMesh& strips : models()) {
    const Blueprint b = blueprint_of(strips);
    std::size_t joined = 0;
    for (const StripMesh::Arch& a : strips.arches) joined += a.patches[1] >= 0;
    EXPECT_EQ(b.seams.size(), joined);
    for (const Seam& seam : b.seams) {
      ASSERT_EQ(seam.vt[0].size(), seam.vt[1].size());
      for (std::size_t i = 0; i + 1 < seam.vt[0].size(); ++i)
        EXPECT_NEAR((b.flat[seam.vt[0][i]] - b.flat[seam.vt[0][i + 1]]).norm(),
                    (b.flat[seam.vt[1][i]] - b.flat[seam.vt[1][i + 1]]).norm(), 1e-9);
    }
  }
}

TEST(Seams, PartLiesOnTheSideThatIsSaid) {
  for (const Face face : {Face::kOutside, Face::kInside}) {
    BlueprintOptions o;
    o.marked_face = face;
    for (const StripMesh& strips : models()) {
      const Blueprint b = blueprint_of(strips, o);
      for (const Seam& seam : b.seams)
        for (int k = 0; k < 2; ++k) {
          const auto [p, d] = point_at(side_of(seam, k, b.flat), 0.37 * seam.length);
          const Vector2 left(-d.y(), d.x());
          EXPECT_EQ(contains(b.parts[seam.parts[k]].outline, p + 1e-3 * left), seam.left[k]);
          EXPECT_EQ(contains(b.parts[seam.parts[k]].outline, p - 1e-3 * left), !seam.left[k]);
        }
    }
  }
}

TEST(Seams, CodesDoNotMeetWhenTurnedEndForEnd) {
  const Blueprint b = blueprint_of(shapes::torus_pieces(12, 4, 15));
  int coded = 0;
  for (const Seam& seam : b.seams) {
    if (seam.code[0] == 0) continue;
    ++coded;
    std::vector<double> here = notch_places(seam, b.options.notch_size), turned;
    for (double s : here) turned.insert(turned.begin(), seam.length - s);
    bool same = here.size() == turned.size();
    for (std::size_t i = 0; same && i < here.size(); ++i) same = std::abs(here[i] - turned[i]) < 0.5;
    EXPECT_FALSE(same) << "seam " << seam.number;
    EXPECT_GT(here.front(), 0.5);
    EXPECT_LT(here.back(), seam.length - 0.5);
  }
  EXPECT_EQ(coded, static_cast<int>(b.seams.size()));
}

TEST(Seams, CodesDifferAroundAPart) {
  const Blueprint b = blueprint_of(shapes::cube_faces());
  std::map<int, std::multiset<std::array<int, 2>>> codes;
  for (const Seam& seam : b.seams)
    for (int p : seam.parts) codes[p].insert(seam.code);
  for (const auto& [part, seen] : codes) {
    EXPECT_EQ(seen.size(), 4u);
    for (const auto& code : seen) EXPECT_EQ(seen.count(code), 1u);
  }
}

TEST(Seams, NotchesOfBothSidesMeetInSpace) {
  // A tick's foot on either part, carried to 3D by its edge of the seam, is one place.
  const StripMesh strips = shapes::two_leaves(60, 0.4, 12);
  const Blueprint b = blueprint_of(strips);
  const Seam& seam = b.seams.at(0);
  std::vector<Vector3> solid;
  for (int v : strips.arches[seam.arch].vertices) solid.push_back(50 * strips.points[v]);
  for (int k = 0; k < 2; ++k) {
    const std::vector<Vector2> side = side_of(seam, k, b.flat);
    std::vector<double> found;
    for (const BlueprintLine& line : b.parts[seam.parts[k]].lines) {
      if (line.operation != Operation::kNotch) continue;
      EXPECT_EQ(line.seam, seam.number);
      double s = 0, best = 1e9, at = 0;
      for (std::size_t i = 0; i + 1 < side.size(); ++i) {
        const double length = (side[i + 1] - side[i]).norm();
        const double t = (line.points[0] - side[i]).dot(side[i + 1] - side[i]) / (length * length);
        const double d = point_segment_distance(line.points[0], side[i], side[i + 1]);
        if (d < best) best = d, at = s + t * length;
        s += length;
      }
      EXPECT_LT(best, 1e-9);
      found.push_back(at);
      EXPECT_TRUE(contains(b.parts[seam.parts[k]].outline, line.points[1]));
    }
    std::sort(found.begin(), found.end());
    const std::vector<double> wanted = notch_places(seam, b.options.notch_size);
    ASSERT_EQ(found.size(), wanted.size());
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], wanted[i], 1e-9);
  }
}

// --- bending
// -------------------------------------------------------------------------------------------------------

TEST(FoldLines, SignAndSizeOfABend) {
  const Vector3 a(0, 0, 0), b(0, 1, 0), left(-1, 0, 0);
  EXPECT_NEAR(bend_over(a, b, left, {1, 0, -1}), 45, 1e-12);  // ridge towards whom looks from above
  EXPECT_NEAR(bend_over(a, b, left, {1, 0, 1}), -45, 1e-12);
  EXPECT_NEAR(bend_over(a, b, left, {0, 0, -1}), 90, 1e-12);
  EXPECT_NEAR(bend_over(a, b, left, {1, 0, 0}), 0, 1e-12);
}

TEST(FoldLines, TubeTurnsByWhatItsSidesTurn) {
  const StripMesh tube = shapes::tube(24);
  const auto turns = ruling_turns(tube, 0, creases_of(tube, 0));
  ASSERT_EQ(turns.size(), 23u);
  for (double t : turns) EXPECT_NEAR(t, 15, 1e-9);
}

TEST(FoldLines, DrawnRulingsStandForTheBendingUpToEveryPlace) {
  std::vector<double> turns(60, 1.5);
  for (int i = 30; i < 45; ++i) turns[i] = -2;
  for (const double step : {4.0, 8.0, 15.0}) {
    const auto drawn = thinned_rulings(turns, step, 1);
    EXPECT_LT(drawn.size(), 60u);
    std::size_t next = 0;
    double bent = 0, stood_for = 0;
    for (int i = 0; i < 60; ++i) {
      bent += turns[i];
      for (; next < drawn.size() && drawn[next].ruling <= i; ++next) stood_for += drawn[next].angle;
      EXPECT_LE(std::abs(bent - stood_for), 0.6 * step + 4) << i;  // 4: what the smoothing moves
    }
    for (std::size_t i = 1; i < drawn.size(); ++i) EXPECT_GT(drawn[i].ruling, drawn[i - 1].ruling);
  }
}

TEST(FoldLines, ToAndFroIsNoFoldAndASharpBendIsOne) {
  std::vector<double> zigzag;
  for (int i = 0; i < 40; ++i) zigzag.push_back(i % 2 ? 21 : -20);  // 20 degrees altogether
  double sum = 0;
  const auto drawn = thinned_rulings(zigzag, 8, 1);
  for (const DrawnRuling& r : drawn) sum += r.angle;
  EXPECT_LE(drawn.size(), 4u);
  EXPECT_NEAR(sum, 20, 6);
  EXPECT_EQ(thinned_rulings(zigzag, 0, 1).size(), 40u);
  EXPECT_TRUE(thinned_rulings(std::vector<double>(10, 0.05), 5, 1).empty());
  const auto sharp = thinned_rulings({90}, 5, 1);
  ASSERT_EQ(sharp.size(), 1u);
  EXPECT_NEAR(sharp[0].angle, 90, 5);
}

std::map<Operation, int> count_scores(const Blueprint& b) {
  std::map<Operation, int> count;
  for (const BlueprintPart& part : b.parts)
    for (const BlueprintLine& line : part.lines) ++count[line.operation];
  return count;
}

TEST(Rulings, MountainAndValleyFollowTheDihedralAndTheMarkedFace) {
  BlueprintOptions out, in;
  in.marked_face = Face::kInside;
  EXPECT_GT(count_scores(blueprint_of(shapes::two_leaves(0, 0.4, 12), out))[Operation::kScoreMountain], 0);
  EXPECT_EQ(count_scores(blueprint_of(shapes::two_leaves(0, 0.4, 12), out))[Operation::kScoreValley], 0);
  EXPECT_EQ(count_scores(blueprint_of(shapes::two_leaves(0, -0.4, 12), out))[Operation::kScoreMountain], 0);
  EXPECT_GT(count_scores(blueprint_of(shapes::two_leaves(0, -0.4, 12), out))[Operation::kScoreValley], 0);
  EXPECT_EQ(count_scores(blueprint_of(shapes::two_leaves(0, 0.4, 12), in))[Operation::kScoreMountain], 0);
}

TEST(Rulings, StylesKeepClearOfTheEdge) {
  const StripMesh strips = shapes::tube(24);
  for (const RulingStyle style : {RulingStyle::kScore, RulingStyle::kPerforation, RulingStyle::kTicks}) {
    BlueprintOptions o;
    o.rulings = style, o.ruling_step = 0;
    o.label_height = o.seam_text_height = 0, o.notches = NotchStyle::kNone;  // folds stop short of these
    const Blueprint b = blueprint_of(strips, o);
    double length = 0;
    int lines = 0;
    for (const BlueprintLine& line : b.parts[0].lines) {
      if (line.operation != Operation::kScoreMountain) continue;
      ++lines;
      length += (line.points[1] - line.points[0]).norm();
      for (const Vector2& p : line.points) {
        double nearest = 1e9;
        for (std::size_t i = 0; i < b.parts[0].outline.size(); ++i)
          nearest = std::min(nearest,
                             point_segment_distance(p, b.parts[0].outline[i],
                                                    b.parts[0].outline[(i + 1) % b.parts[0].outline.size()]));
        EXPECT_GE(nearest, o.ruling_clear - 1e-9);
        EXPECT_TRUE(contains(b.parts[0].outline, p));
      }
    }
    const double room = 100 - 2 * o.ruling_clear;  // of each of 23 rulings
    if (style == RulingStyle::kScore) {
      EXPECT_EQ(lines, 23);
      EXPECT_NEAR(length, 23 * room, 1e-6);
    } else if (style == RulingStyle::kTicks) {
      EXPECT_EQ(lines, 46);
      EXPECT_NEAR(length, 46 * o.tick_length, 1e-6);
    } else {
      EXPECT_EQ(lines, 23 * 24);  // (97 + 2) / 4
      EXPECT_NEAR(length, 23 * 24 * o.dash, 1e-6);
    }
  }
}

// --- texts
// ---------------------------------------------------------------------------------------------------------

TEST(StrokeFont, EveryPrintableCharacterHasStrokesInItsCell) {
  std::set<std::vector<std::pair<double, double>>> shapes_seen;
  for (char c = '!'; c <= '~'; ++c) {
    const StrokeText t = stroke_text(std::string(1, c), 6);
    EXPECT_FALSE(t.lines.empty()) << c;
    EXPECT_DOUBLE_EQ(t.width, 4);
    std::vector<std::pair<double, double>> flat;
    for (const auto& line : t.lines) {
      EXPECT_GE(line.size(), 2u) << c;
      for (const Vector2& p : line) {
        EXPECT_GE(p.x(), 0) << c;
        EXPECT_LE(p.x(), 4) << c;
        EXPECT_GE(p.y(), -1) << c;
        EXPECT_LE(p.y(), 6) << c;
        flat.emplace_back(p.x(), p.y());
      }
      flat.emplace_back(-9, -9);
    }
    if (c < 'a' || c > 'z') {
      EXPECT_TRUE(shapes_seen.insert(flat).second) << c << " looks like another character";
    }
  }
  EXPECT_EQ(stroke_text("a", 6).lines, stroke_text("A", 6).lines);
  EXPECT_EQ(stroke_text("\xC3\xA4", 6).width, 4);  // one box for one character
  EXPECT_TRUE(stroke_text("", 6).lines.empty());
}

bool cross(const Vector2& a, const Vector2& b, const Vector2& c, const Vector2& d) {
  return segment_distance(a, b, c, d) == 0;
}

TEST(Texts, StayInsideTheirPartAndOffEachOther) {
  for (const StripMesh& strips : models()) {
    const Blueprint b = blueprint_of(strips);
    for (const BlueprintPart& part : b.parts) {
      std::map<int, std::vector<std::array<Vector2, 2>>> texts;  // by seam; 0: the label
      std::vector<std::array<Vector2, 2>> ticks;
      for (const BlueprintLine& line : part.lines)
        for (std::size_t i = 0; i + 1 < line.points.size(); ++i) {
          if (line.operation == Operation::kText)
            texts[line.seam].push_back({line.points[i], line.points[i + 1]});
          if (line.operation == Operation::kNotch) ticks.push_back({line.points[i], line.points[i + 1]});
        }
      EXPECT_FALSE(texts[0].empty()) << part.label;
      for (const auto& [seam, lines] : texts) {
        for (const auto& [p, q] : lines) {
          EXPECT_TRUE(contains(part.outline, p));
          for (std::size_t i = 0; i < part.outline.size(); ++i)
            ASSERT_GT(segment_distance(p, q, part.outline[i], part.outline[(i + 1) % part.outline.size()]),
                      0.1);
          for (const auto& [r, s] : ticks) ASSERT_FALSE(cross(p, q, r, s));
        }
        for (const auto& [other, more] : texts) {
          if (other <= seam) continue;
          for (const auto& [p, q] : lines)
            for (const auto& [r, t] : more)
              ASSERT_FALSE(cross(p, q, r, t)) << part.label << " seams " << seam << " and " << other;
        }
      }
    }
  }
}

TEST(Texts, OwnLabelIsTheLargest) {
  const Blueprint b = blueprint_of(shapes::torus_pieces(16, 4, 25), {}, 30);
  for (const BlueprintPart& part : b.parts) {
    double own = 0, others = 0;
    for (const BlueprintLine& line : part.lines) {
      if (line.operation != Operation::kText) continue;
      double reach = 0;
      for (const Vector2& p : line.points)
        for (const Vector2& q : line.points) reach = std::max(reach, (p - q).norm());
      (line.seam == 0 ? own : others) = std::max(line.seam == 0 ? own : others, reach);
    }
    if (own > 0) {
      EXPECT_GT(own, others) << part.label;
    }
  }
}

TEST(Texts, WhatHasNoRoomIsSaid) {
  const Blueprint b = blueprint_of(shapes::torus_pieces(16, 4, 25), {}, 5);
  EXPECT_FALSE(b.warnings.empty());
}

// --- nesting
// -------------------------------------------------------------------------------------------------------

Polygons moved(const Polygons& polygons, const Placement& placement) {
  Polygons out;
  for (const Polygon& p : polygons) out.push_back(placed(p, placement));
  return out;
}

// No two footprints on a sheet nearer than the gap, none nearer to the edge than the margin.
void expect_apart(const Blueprint& b) {
  for (const BlueprintSheet& sheet : b.sheets) {
    std::vector<Polygons> grown;
    for (const PlacedPart& p : sheet.parts) {
      const Polygons shape = moved(b.parts[p.part].footprint, p.placement);
      EXPECT_NEAR(std::hypot(p.placement.cos, p.placement.sin), 1, 1e-12);
      for (const Polygon& contour : shape)
        for (const Vector2& q : contour) {
          EXPECT_GE(q.minCoeff(), b.options.margin - 1e-6);
          EXPECT_LE(q.x(), sheet.width - b.options.margin + 1e-6);
          EXPECT_LE(q.y(), sheet.height - b.options.margin + 1e-6);
        }
      grown.push_back(offset(shape, b.options.gap / 2 - 1e-3, Corner::kRound));
    }
    for (std::size_t i = 0; i < grown.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) EXPECT_LT(area_of(intersect(grown[i], grown[j])), 1e-3);
  }
}

TEST(Nesting, KeepsItsGapsOnOnePage) {
  for (const StripMesh& strips : models()) {
    const Blueprint b = blueprint_of(strips);
    EXPECT_EQ(b.sheets.size(), 1u);
    EXPECT_EQ(b.sheets[0].parts.size(), b.parts.size());
    expect_apart(b);
  }
}

TEST(Nesting, StronglyCurvedPartsOnSeveralSheetsAndCopies) {
  BlueprintOptions o;
  o.sheet_width = 300, o.sheet_height = 200, o.gap = 2, o.margin = 7, o.copies = 2;
  const Blueprint b = blueprint_of(shapes::torus_pieces(12, 4, 15), o);
  EXPECT_GT(b.sheets.size(), 1u);
  std::map<std::pair<int, int>, int> seen;
  for (const BlueprintSheet& sheet : b.sheets)
    for (const PlacedPart& p : sheet.parts) ++seen[{p.part, p.copy}];
  EXPECT_EQ(seen.size(), 96u);
  for (const auto& [key, count] : seen) EXPECT_EQ(count, 1);
  expect_apart(b);
  EXPECT_GT(b.used_share, 0.2);
  EXPECT_LT(b.used_share, 1);
}

TEST(Nesting, RingsLieInsideRings) {
  // Two nearly closed rings: the small one goes into the hollow of the large one.
  const auto ring = [](double inner, double outer) {
    Polygon p;
    for (int i = 0; i <= 60; ++i) p.push_back(outer * Vector2(std::cos(0.1 * i), std::sin(0.1 * i)));
    for (int i = 60; i >= 0; --i) p.push_back(inner * Vector2(std::cos(0.1 * i), std::sin(0.1 * i)));
    return p;
  };
  Nester nester({220, 220, 5, 3});
  const NestedItem large = nester.place({{ring(80, 100)}, {0}}), small = nester.place({{ring(40, 60)}, {0}});
  EXPECT_EQ(large.sheet, 0);
  EXPECT_EQ(small.sheet, 0);
  EXPECT_LT((small.placement.shift - large.placement.shift).norm(), 20);
}

TEST(Nesting, WhatFitsExactlyFitsAndWhatDoesNotIsRefused) {
  const Polygon a4{{0, 0}, {200, 0}, {200, 287}, {0, 287}};
  EXPECT_EQ(Nester({210, 297, 5, 3}).place({{a4}, {0}}).sheet, 0);
  EXPECT_EQ(Nester({209.9, 297, 5, 3}).place({{a4}, {0}}).sheet, -1);
  BlueprintOptions o;
  o.sheet_width = 120, o.sheet_height = 90;
  try {
    blueprint_of(shapes::cube_faces(), o);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::kInvalidParameter);
    EXPECT_EQ(e.where(), "sheet");
  }
}

TEST(Nesting, GrainTurnsRulingsAcrossOrAlong) {
  for (const Grain grain : {Grain::kAlongRulings, Grain::kAcrossRulings}) {
    BlueprintOptions o;
    o.grain = grain;
    const Blueprint b = blueprint_of(shapes::two_leaves(30, 0.4, 12), o);
    for (const PlacedPart& p : b.sheets[0].parts) {
      const Vector2& r = b.parts[p.part].ruling_direction;
      const Vector2 on_sheet(p.placement.cos * r.x() - p.placement.sin * r.y(),
                             p.placement.sin * r.x() + p.placement.cos * r.y());
      EXPECT_NEAR(std::abs(grain == Grain::kAlongRulings ? on_sheet.x() : on_sheet.y()), 1, 1e-9);
    }
  }
}

TEST(Nesting, BarOf100MillimetresIsThereAndFree) {
  const Blueprint b = blueprint_of(shapes::torus_pieces(12, 4, 15));
  ASSERT_FALSE(b.sheets[0].guide.empty());
  const std::vector<Vector2>& frame = b.sheets[0].guide[0].points;
  ASSERT_EQ(frame.size(), 4u);
  EXPECT_NEAR((frame[1] - frame[0]).norm(), 100, 1e-9);
  EXPECT_NEAR((frame[2] - frame[1]).norm(), 10, 1e-9);
  Polygon bar = frame;
  if (signed_area(bar) < 0) std::reverse(bar.begin(), bar.end());
  for (const PlacedPart& p : b.sheets[0].parts)
    EXPECT_LT(area_of(intersect({bar}, moved(b.parts[p.part].footprint, p.placement))), 1e-6);
}

TEST(Blueprint, IsTheSameAgain) {
  const StripMesh strips = shapes::torus_pieces(12, 4, 15);
  const Blueprint a = blueprint_of(strips), b = blueprint_of(strips);
  ASSERT_EQ(a.sheets[0].parts.size(), b.sheets[0].parts.size());
  for (std::size_t i = 0; i < a.sheets[0].parts.size(); ++i) {
    EXPECT_EQ(a.sheets[0].parts[i].part, b.sheets[0].parts[i].part);
    EXPECT_EQ(a.sheets[0].parts[i].placement.shift, b.sheets[0].parts[i].placement.shift);
  }
}

TEST(Blueprint, MarkedInsideMirrorsTheOutlines) {
  BlueprintOptions o;
  o.marked_face = Face::kInside;
  const StripMesh strips = shapes::torus_pieces(12, 4, 15);
  const Blueprint out = blueprint_of(strips), in = blueprint_of(strips, o);
  for (std::size_t p = 0; p < out.parts.size(); ++p) {
    EXPECT_NEAR(out.parts[p].area, in.parts[p].area, 1e-9);
    EXPECT_GT(signed_area(in.parts[p].outline), 0);
    EXPECT_EQ(in.parts[p].outline.front(),
              Vector2(-out.parts[p].outline.back().x(), out.parts[p].outline.back().y()));
  }
  EXPECT_EQ(in.seams.size(), out.seams.size());
}

TEST(Blueprint, OptionsOutOfRangeAreNamed) {
  const std::vector<std::pair<std::function<void(BlueprintOptions&)>, std::string>> cases = {
      {[](BlueprintOptions& o) { o.gap = -1; }, "gap"},
      {[](BlueprintOptions& o) { o.gap = std::nan(""); }, "gap"},
      {[](BlueprintOptions& o) { o.sheet_width = 100; }, "sheet"},
      {[](BlueprintOptions& o) { o.turns = 0; }, "turns"},
      {[](BlueprintOptions& o) { o.copies = 1000; }, "copies"},
      {[](BlueprintOptions& o) { o.kerf = 10; }, "kerf"},
      {[](BlueprintOptions& o) { o.tab_angle = 5; }, "tab_angle"},
      {[](BlueprintOptions& o) { o.sheet_width = o.sheet_height = 10; }, "margin"}};
  for (const auto& [change, where] : cases) {
    BlueprintOptions o;
    change(o);
    try {
      blueprint_of(shapes::cube_faces(), o);
      FAIL() << where;
    } catch (const Error& e) {
      EXPECT_EQ(e.where(), where);
    }
  }
}

// --- joints
// --------------------------------------------------------------------------------------------------------

TEST(Tabs, AreOneContourWithTheirPartAndTouchNothingElse) {
  for (const TabSides sides : {TabSides::kOne, TabSides::kAlternate, TabSides::kBoth})
    for (const StripMesh& strips : models()) {
      BlueprintOptions o;
      o.tabs = sides;
      const Blueprint b = blueprint_of(strips, o);
      double tabs = 0;
      for (const BlueprintPart& part : b.parts) {
        ASSERT_FALSE(part.footprint.empty());
        EXPECT_GT(signed_area(part.footprint[0]), 0);
        for (std::size_t i = 1; i < part.footprint.size(); ++i) EXPECT_LT(signed_area(part.footprint[i]), 0);
        EXPECT_LT(self_contact(part.footprint[0], 1e-9).i, 0) << part.label;
        // The part itself is all there, and what is added lies outside of it.
        EXPECT_NEAR(area_of(intersect(part.footprint, {part.outline})), part.area, 1e-3 * part.area);
        tabs += area_of(part.footprint) - part.area;
      }
      EXPECT_GT(tabs, 50) << "sides " << static_cast<int>(sides);
      expect_apart(b);
    }
}

TEST(Tabs, OfOneSideStandOnOneSideOnly) {
  BlueprintOptions o;
  o.tabs = TabSides::kOne;
  const Blueprint b = blueprint_of(shapes::cube_faces(), o);
  std::map<int, std::set<int>> parts;  // seam -> parts with teeth on it
  for (std::size_t p = 0; p < b.parts.size(); ++p)
    for (const BlueprintLine& line : b.parts[p].lines)
      if (line.operation == Operation::kScoreMountain && line.seam > 0)
        parts[line.seam].insert(static_cast<int>(p));
  EXPECT_EQ(parts.size(), 12u);
  for (const auto& [seam, with] : parts) EXPECT_EQ(with.size(), 1u);
}

TEST(Tabs, TeethFollowTheSeamAtTheirPitch) {
  BlueprintOptions o;
  o.tabs = TabSides::kBoth, o.tab_pitch = 10;
  const Blueprint b = blueprint_of(shapes::two_leaves(60, 0.4, 12), o);
  for (const BlueprintPart& part : b.parts) {
    int teeth = 0;
    for (const BlueprintLine& line : part.lines)
      teeth += line.seam == 1 && (line.operation == Operation::kScoreMountain);
    EXPECT_EQ(teeth, 10);
  }
}

TEST(Notches, VeesTakeTheSameBiteFromBothSides) {
  BlueprintOptions o;
  o.notches = NotchStyle::kVee;
  const Blueprint b = blueprint_of(shapes::two_leaves(60, 0, 12), o);
  const double vee = 0.5 * 1.5 * 1.5;
  for (const BlueprintPart& part : b.parts) {
    EXPECT_NEAR(part.area - area_of(part.footprint), 3 * vee, 1e-3);
    EXPECT_EQ(part.footprint.size(), 1u);
  }
}

TEST(Kerf, GrowsTheCutByHalfOfIt) {
  BlueprintOptions o;
  o.kerf = 0.4;
  const Blueprint b = blueprint_of(shapes::cube_faces(), o);
  for (const BlueprintPart& part : b.parts)
    for (const BlueprintLine& line : part.lines)
      if (line.operation == Operation::kCutOuter) {
        EXPECT_NEAR(signed_area(line.points), 100.4 * 100.4, 1e-3);
      }
}

TEST(Kerf, WhatItLeavesOfANarrowSlitIsTold) {
  // The slit opens by `angle`: the middle of the cut ends kerf / 2 / sin(angle / 2) before the tip, its edge
  // kerf / 2 nearer.
  const double angle = 2 * shapes::kPi * (1 - 1 / std::sqrt(1 + 0.25 * 0.25));
  BlueprintOptions o;
  o.kerf = 0.3;
  const double left = o.kerf / 2 / std::sin(angle / 2) - o.kerf / 2;
  const Blueprint b = blueprint_of(shapes::cone(240, 1, 0.25), o);
  ASSERT_EQ(b.warnings.size(), 1u);
  char text[32];
  std::snprintf(text, sizeof text, "1 (%.1f mm)", left);
  EXPECT_THAT(b.warnings[0], ::testing::HasSubstr(text));
  o.kerf = 0.1;
  EXPECT_TRUE(blueprint_of(shapes::cone(240, 1, 0.25), o).warnings.empty()) << "half a millimetre";
  o.kerf = 0;
  EXPECT_TRUE(blueprint_of(shapes::cone(240, 1, 0.25), o).warnings.empty());
  o.kerf = 1;
  EXPECT_TRUE(blueprint_of(shapes::cone(24), o).warnings.empty()) << "a wide one";
}

// --- assembly
// ------------------------------------------------------------------------------------------------------

TEST(Assembly, EveryPartJoinsWhatIsBuilt) {
  for (const StripMesh& strips : models()) {
    const Blueprint b = blueprint_of(strips);
    const auto steps = assembly_order(b);
    ASSERT_EQ(steps.size(), b.parts.size());
    std::set<int> built, used;
    for (const AssemblyStep& step : steps) {
      bool joins = built.empty();
      for (int s : step.seams) {
        EXPECT_TRUE(used.insert(s).second);
        const Seam& seam = b.seams[s];
        const int other = seam.parts[0] == step.part ? seam.parts[1] : seam.parts[0];
        joins = joins || built.count(other);
        EXPECT_TRUE(other == step.part || built.count(other));
      }
      EXPECT_TRUE(joins);
      EXPECT_TRUE(built.insert(step.part).second);
    }
    EXPECT_EQ(used.size(), b.seams.size());
  }
}

TEST(Assembly, LastPartHasTheShortestSeams) {
  const Blueprint b = blueprint_of(shapes::torus_pieces(12, 4, 15));
  std::map<int, double> glue;
  for (const Seam& seam : b.seams)
    for (int p : seam.parts) glue[p] += seam.length;
  const int last = assembly_order(b).back().part;
  for (const auto& [part, length] : glue) EXPECT_GE(length, glue[last] - 1e-9);
}

// A slit with its tip in the sheet, then two more seams beyond it, as from the middle of a spiral outwards;
// numbers[i] is where seam i stands. turned: the arches run the other way.
Blueprint spiral(const std::array<int, 3>& numbers, bool turned) {
  Blueprint b;
  b.parts.resize(1);
  b.seams.resize(3);
  for (int i = 0; i < 3; ++i) {
    Seam& seam = b.seams[numbers[i]];
    const int left = 2 * i, right = i == 0 ? 0 : 10 + left;
    seam.vt = {std::vector<int>{left, left + 1, left + 2}, std::vector<int>{right, 11 + left, 12 + left}};
    if (turned)
      for (std::vector<int>& side : seam.vt) std::reverse(side.begin(), side.end());
    seam.number = numbers[i] + 1, seam.length = 10;
  }
  return b;
}

TEST(Assembly, APartIsGluedToItselfFromWhereItsSidesHangTogether) {
  std::array<int, 3> numbers{0, 1, 2};
  do {
    for (const bool turned : {false, true}) {
      const auto steps = assembly_order(spiral(numbers, turned));
      ASSERT_EQ(steps.size(), 1u);
      EXPECT_THAT(steps[0].seams, ElementsAre(numbers[0], numbers[1], numbers[2])) << turned;
    }
  } while (std::next_permutation(numbers.begin(), numbers.end()));
}

TEST(Assembly, SeamsOfAPartWithItselfComeByNumberWhereNoneIsBegun) {
  Blueprint b = spiral({0, 1, 2}, false);
  b.seams[0].vt[1][0] = 30;  // a sleeve: its sides hang together nowhere
  EXPECT_THAT(assembly_order(b)[0].seams, ElementsAre(0, 1, 2));
}

TEST(Totals, AddUp) {
  const Blueprint b = blueprint_of(shapes::cube_faces());
  const Totals t = totals_of(b, profile_named("makerspace"));
  EXPECT_EQ(t.parts, 6);
  EXPECT_NEAR(t.cut, 6 * 400, 1e-6);
  EXPECT_NEAR(t.glue, 12 * 100, 1e-6);
  EXPECT_NEAR(t.area, 6 * 1e4, 1e-6);
  EXPECT_EQ(t.score, 0);
  EXPECT_GT(t.minutes, 0);
}

}  // namespace
}  // namespace sheetform
