#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "pipeline/run.h"

namespace sheetform {
namespace {

struct Refused {
  const char* name;
  std::function<void(DecomposeParams&)> set;
};
void PrintTo(const Refused& r, std::ostream* out) { *out << r.name; }

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

class RefusedParameters : public ::testing::TestWithParam<Refused> {};
TEST_P(RefusedParameters, AreNamed) {
  DecomposeParams params;
  GetParam().set(params);
  for (const bool whole : {false, true}) try {
      if (whole) {
        run(shapes::plane(4), params);
      } else {
        validate(params);
      }
      ADD_FAILURE() << "accepted";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::kInvalidParameter);
      EXPECT_EQ(e.where(), GetParam().name);
      EXPECT_FALSE(e.summary().empty());
      EXPECT_FALSE(e.fix().empty());
    }
}
INSTANTIATE_TEST_SUITE_P(
    All, RefusedParameters,
    ::testing::Values(
        Refused{"e_max", [](auto& p) { p.e_max = 0; }}, Refused{"e_max", [](auto& p) { p.e_max = -0.1; }},
        Refused{"e_max", [](auto& p) { p.e_max = 0.6; }}, Refused{"e_max", [](auto& p) { p.e_max = kNaN; }},
        Refused{"e_max_mm", [](auto& p) { p.e_max_mm = 0; }},
        Refused{"e_max_mm", [](auto& p) { p.e_max_mm = kInf; }},
        Refused{"e_max_mm", [](auto& p) { p.e_max_mm = kNaN; }},
        Refused{"max_sides", [](auto& p) { p.max_sides = 2; }},
        Refused{"max_sides", [](auto& p) { p.max_sides = 7; }},
        Refused{"creases", [](auto& p) { p.crease_angle = 0; }},
        Refused{"creases", [](auto& p) { p.crease_angle = 180; }},
        Refused{"creases", [](auto& p) { p.crease_angle = kNaN; }},
        Refused{"normal_deviation", [](auto& p) { p.normal_deviation = 0; }},
        Refused{"normal_deviation", [](auto& p) { p.normal_deviation = 91; }},
        Refused{"normal_deviation", [](auto& p) { p.normal_deviation = kNaN; }},
        Refused{"ruling_spacing_min", [](auto& p) { p.ruling_spacing_min = 0; }},
        Refused{"ruling_spacing_min", [](auto& p) { p.ruling_spacing_min = kNaN; }},
        Refused{"ruling_spacing_min", [](auto& p) { p.ruling_spacing_min = 3, p.ruling_spacing_max = 5; }},
        Refused{"ruling_spacing_max", [](auto& p) { p.ruling_spacing_max = -1; }},
        Refused{"ruling_spacing_max", [](auto& p) { p.ruling_spacing_max = kInf; }},
        Refused{"min_bend_radius", [](auto& p) { p.min_bend_radius = 0; }},
        Refused{"min_bend_radius", [](auto& p) { p.min_bend_radius = kInf; }},
        Refused{"scale", [](auto& p) { p.scale = 0; }}, Refused{"scale", [](auto& p) { p.scale = -1; }},
        Refused{"scale", [](auto& p) { p.scale = kNaN; }},
        Refused{"target_size", [](auto& p) { p.target_size = 0; }},
        Refused{"target_size", [](auto& p) { p.target_size = kInf; }}));

TEST(Parameters, ToleranceInMillimetresBeyondHalfOfTheDiagonalIsRefused) {
  DecomposeParams params;
  params.e_max_mm = 10;  // the plane is 1 mm wide
  try {
    run(shapes::plane(4), params);
    FAIL() << "accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::kInvalidParameter);
    EXPECT_EQ(e.where(), "e_max_mm");
  }
}

TEST(Parameters, MillimetresAndTargetSizeAreResolved) {
  const TriangleSoup soup = shapes::cylinder(40, 10, 1, 2);
  DecomposeParams params;
  params.target_size = 300;
  params.e_max_mm = 5;
  const Decomposition d = run(soup, params);
  expect_sound(soup, d);
  EXPECT_NEAR(d.params.scale, 150, 1e-9);
  EXPECT_NEAR(d.params.e_max * d.bbox_diagonal * d.params.scale, 5, 1e-9);
  EXPECT_TRUE(d.report.e_max_met);
  params.target_size.reset();
  params.scale = 10;
  EXPECT_NEAR(run(soup, params).params.e_max, 5 / (10 * d.bbox_diagonal), 1e-12);
}

TEST(Parameters, FinerToleranceTakesMoreParts) {
  const TriangleSoup soup = shapes::sphere(14);
  const Decomposition coarse = run(soup, with_e_max(0.06), 2), fine = run(soup, with_e_max(0.015), 2);
  for (const Decomposition& d : {coarse, fine}) {
    expect_sound(soup, d);
    EXPECT_TRUE(d.report.e_max_met);
  }
  EXPECT_LT(coarse.strips.patches.size(), fine.strips.patches.size());
  EXPECT_LT(coarse.report.cut_length, fine.report.cut_length);
}

TEST(Parameters, WithoutTJunctionsEveryNodeIsACorner) {
  DecomposeParams params = with_e_max(0.03);
  params.t_junctions = false;
  for (const TriangleSoup& soup : {shapes::torus(48, 24), shapes::sphere(14)}) {
    const Decomposition d = run(soup, params, 2);
    expect_sound(soup, d);
    EXPECT_TRUE(d.report.e_max_met);
    EXPECT_EQ(t_junctions(d.strips), 0);
  }
}

TEST(Parameters, WithTJunctionsThereAreFewerParts) {
  const TriangleSoup soup = shapes::sphere(14);
  DecomposeParams without = with_e_max(0.02);
  without.t_junctions = false;
  EXPECT_LE(run(soup, with_e_max(0.02), 2).strips.patches.size(),
            run(soup, without, 2).strips.patches.size());
}

TEST(Parameters, WithoutSelfSeamsNoPatchIsGluedToItself) {
  DecomposeParams params;
  params.self_seams = false;
  for (const TriangleSoup& soup : {shapes::cylinder(48, 16), shapes::closed_cylinder(48, 12)}) {
    const Decomposition d = run(soup, params);
    expect_sound(soup, d);
    EXPECT_EQ(self_seams(d.strips), 0);
    EXPECT_GE(d.strips.patches.size(), 2u);
    EXPECT_LE(d.strips.patches.size(), 4u);
  }
}

TEST(Parameters, FewerSidesAreKeptTo) {
  DecomposeParams params = with_e_max(0.03);
  params.max_sides = 4;
  const TriangleSoup soup = shapes::sphere(14);
  const Decomposition d = run(soup, params, 2);
  expect_sound(soup, d);
  for (const auto& p : d.strips.patches) EXPECT_LE(p.corners.size(), 4u);
}

// Paths cross at right angles and leave no triangles: what has four corners is cut from one to another.
TEST(Parameters, TrianglesAreFew) {
  const TriangleSoup dome = shapes::grid({30, 30}, [](double u, double v) {
    return Vector3(u, v, 0.3 * std::cos(3 * u - 1.5) * std::cos(3 * v - 1.5));
  });
  DecomposeParams params = with_e_max(0.01);
  params.max_sides = 3;
  for (const TriangleSoup& soup : {shapes::cylinder(48, 16), dome}) {
    const Decomposition d = run(soup, params, 2);
    expect_sound(soup, d);
    for (const auto& p : d.strips.patches) EXPECT_LE(p.corners.size(), 3u);
    EXPECT_LE(d.strips.patches.size(), 8u);
  }
}

TEST(Parameters, CreasesCanBeSwitchedOff) {
  const TriangleSoup soup = shapes::closed_cylinder(48, 12);
  DecomposeParams params;
  params.crease_angle.reset();
  const Decomposition d = run(soup, params, 2);
  expect_sound(soup, d);
  EXPECT_EQ(creases(d.strips), 0);
}

TEST(Parameters, EveryEffortIsSound) {
  const TriangleSoup soup = shapes::saddle(24, 1.2);
  for (Effort effort : {Effort::kDraft, Effort::kNormal, Effort::kThorough}) {
    DecomposeParams params;
    params.effort = effort;
    const Decomposition d = run(soup, params, 2);
    expect_sound(soup, d);
    EXPECT_TRUE(d.report.e_max_met);
  }
}

// ---- a field given by the user
// -------------------------------------------------------------------------------------

// Directions that spiral around the torus' tube at 45 degrees.
UserField spiral(const TriangleSoup& soup, bool per_face) {
  const auto direction = [](const Vector3& p) {
    const Vector3 around = Vector3(-p.y(), p.x(), 0).normalized(),
                  centre = Vector3(p.x(), p.y(), 0).normalized();
    return Vector3((around + around.cross((p - centre).normalized())).normalized());
  };
  UserField field;
  if (per_face) {
    for (const auto& f : soup.faces)
      field.per_face.push_back(direction((soup.points[f[0]] + soup.points[f[1]] + soup.points[f[2]]) / 3));
  } else {
    for (const Vector3& p : soup.points) field.per_vertex.push_back(direction(p));
  }
  return field;
}

TEST(UserField, IsFollowed) {
  const TriangleSoup soup = shapes::torus(60, 30);
  DecomposeParams params = with_e_max(0.04);
  params.effort = Effort::kDraft;
  const Decomposition own = run(soup, params, 2);
  for (bool per_face : {false, true}) {
    const UserField field = spiral(soup, per_face);
    const Decomposition d = run(soup, params, 2, &field);
    expect_sound(soup, d);
    EXPECT_TRUE(d.report.e_max_met);
    EXPECT_NE(d.strips.points, own.strips.points);
  }
}

TEST(UserField, OfTheWrongLengthIsRefused) {
  const TriangleSoup soup = shapes::torus(20, 10);
  UserField field = spiral(soup, false);
  field.per_vertex.pop_back();
  try {
    run(soup, {}, 1, &field);
    FAIL() << "accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::kInvalidParameter);
    EXPECT_EQ(e.where(), "field");
  }
}

TEST(UserField, OfZeroesIsTheSameAsFree) {
  const TriangleSoup soup = shapes::saddle(20, 1.0);
  UserField field;
  field.per_vertex.assign(soup.points.size(), Vector3::Zero());
  const Decomposition d = run(soup, {}, 1, &field);
  expect_sound(soup, d);
  EXPECT_TRUE(d.report.e_max_met);
}

}  // namespace
}  // namespace sheetform
