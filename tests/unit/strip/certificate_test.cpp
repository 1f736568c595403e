#include "sheetform/strip/certificate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>

#include "sheetform/strip/outline.h"
#include "sheetform/strip/patch_shape.h"
#include "support/shapes.h"
#include "support/strip_shapes.h"

namespace sheetform {
namespace {

using ::testing::UnorderedElementsAre;

constexpr double kDiagonal = 4;

std::set<std::string> checks_of(const std::vector<Defect>& defects) {
  std::set<std::string> names;
  for (const Defect& d : defects) names.insert(d.check);
  return names;
}

std::string text_of(const std::vector<Defect>& defects) {
  std::string text;
  for (const Defect& d : defects)
    text += d.check + " patch " + std::to_string(d.patch) + ": " + d.text + "\n";
  return text;
}

void expect_sound(const StripMesh& strips) {
  TriangleSoup soup = shapes::soup_of(strips);
  const SurfaceMesh input = build_surface_mesh(soup.points, soup.faces);
  double isometry = -1;
  const auto defects = check_structure(strips, &input, 6, kDiagonal, &isometry);
  EXPECT_TRUE(defects.empty()) << text_of(defects);
  EXPECT_GE(isometry, 0);
  EXPECT_LT(isometry, 1e-12);
  for (std::size_t p = 0; p < strips.patches.size(); ++p) {
    const auto alone = check_patch(strips, static_cast<int>(p), kDiagonal);
    EXPECT_TRUE(alone.empty()) << text_of(alone);
  }
}

TEST(Certificate, HandMadeResultsAreSound) {
  expect_sound(shapes::cube_faces());
  expect_sound(shapes::tube(24));
  expect_sound(shapes::cone(24));
  expect_sound(shapes::two_leaves(60, 0.4, 12));
  expect_sound(shapes::torus_bands(12, 60));
  expect_sound(shapes::torus_pieces(12, 4, 15));
}

TEST(Certificate, ShapeOfAPatchKnowsItsSeamWithItself) {
  const StripMesh tube = shapes::tube(24);
  ASSERT_EQ(tube.patches.size(), 1u);
  const PatchShape shape = shape_of(tube.patches[0]);
  EXPECT_TRUE(shape.disk);
  EXPECT_TRUE(shape.tree);
  EXPECT_EQ(shape.loop.size(), 50u);  // both ends of the seam stand there twice
  EXPECT_EQ(tube.patches[0].corners.size(), 4u);
  EXPECT_EQ(tube.patches[0].arches.size(), 4u);
  EXPECT_EQ(tube.arches.size(), 3u);
}

// One broken promise each: the mutation, and the checks that must speak up, no other.
struct Mutation {
  const char* name;
  std::function<StripMesh()> make;
  std::function<void(StripMesh&)> spoil;
  std::set<std::string> checks;
};

void PrintTo(const Mutation& m, std::ostream* out) { *out << m.name; }

StripMesh leaves() { return shapes::two_leaves(60, 0.4, 12); }
StripMesh bands() { return shapes::torus_bands(12, 60); }
StripMesh tube() { return shapes::tube(24); }

// Lifts a point that only `patch` uses, with its triangles unfolded again by nobody.
void stretch(StripMesh& m) { m.uvs[m.patches[0].boundary_vt[3]] += Vector2(1e-5, 0); }

void glue_flat(
    StripMesh& m) {  // both sides of the tube's seam get the same vt: an annulus, and flat triangles
  auto& patch = m.patches[0];
  std::map<int, int> first;
  for (auto& t : patch.triangles)
    for (int k = 0; k < 3; ++k) t.vt[k] = first.emplace(t.v[k], t.vt[k]).first->second;
}

void fold_outline(StripMesh& m) {  // bends a leaf's layout around until it runs into itself
  for (int t : m.patches[0].boundary_vt) {
    const Vector2 q = m.uvs[t];
    const double a = 4.0 * q.y();
    m.uvs[t] = (1.2 + q.x()) * Vector2(std::cos(a), std::sin(a));
  }
}

void lift_seam_point(StripMesh& m) {  // a new v for one side of a seam: the surface opens there
  const int old = 18;                 // in the middle of the seam of leaves()
  m.points.push_back(m.points[old] + Vector3(0, 0, 1e-9));
  const int fresh = static_cast<int>(m.points.size()) - 1;
  for (auto& t : m.patches[0].triangles)
    for (int& v : t.v)
      if (v == old) v = fresh;
}

class BrokenPromise : public ::testing::TestWithParam<Mutation> {};

TEST_P(BrokenPromise, IsFoundByItsOwnCheck) {
  StripMesh strips = GetParam().make();
  TriangleSoup soup = shapes::soup_of(strips);
  const SurfaceMesh input = build_surface_mesh(soup.points, soup.faces);
  GetParam().spoil(strips);
  const auto defects = check_structure(strips, &input, 6, kDiagonal);
  EXPECT_EQ(checks_of(defects), GetParam().checks) << text_of(defects);
}

INSTANTIATE_TEST_SUITE_P(
    Certificate, BrokenPromise,
    ::testing::Values(
        Mutation{"index", leaves, [](StripMesh& m) { m.patches[1].triangles[2].v[1] = 4711; }, {"S1"}},
        Mutation{"negative_uv", leaves, [](StripMesh& m) { m.patches[1].triangles[2].vt[1] = -1; }, {"S1"}},
        Mutation{"nan", leaves, [](StripMesh& m) { m.points[5].x() = std::nan(""); }, {"S1"}},
        Mutation{"corner_place", leaves, [](StripMesh& m) { m.patches[0].corners.back() = 1000; }, {"S1"}},
        Mutation{"arch_id", leaves, [](StripMesh& m) { m.patches[0].arches[0] = 99; }, {"S1"}},
        Mutation{"mirror_of_itself", leaves, [](StripMesh& m) { m.patches[0].mirror_of = 0; }, {"S1"}},
        Mutation{"inside_out",
                 bands,
                 [](StripMesh& m) {  // every face and the layout turned over
                   for (Vector2& q : m.uvs) q.y() = -q.y();
                   for (auto& patch : m.patches)
                     for (auto& f : patch.triangles) std::swap(f.v[0], f.v[1]), std::swap(f.vt[0], f.vt[1]);
                   for (auto& patch : m.patches) {
                     const int n = static_cast<int>(patch.boundary.size());
                     std::reverse(patch.boundary.begin(), patch.boundary.end());
                     std::reverse(patch.boundary_vt.begin(), patch.boundary_vt.end());
                     for (int& k : patch.corners) k = n - 1 - k;
                     std::reverse(patch.corners.begin(), patch.corners.end());
                     std::reverse(patch.arches.begin(), patch.arches.end());
                   }
                 },
                 {"S2"}},
        Mutation{"missing_patch", bands, [](StripMesh& m) { m.patches.pop_back(); }, {"S1"}},
        Mutation{
            "no_faces", leaves, [](StripMesh& m) { m.patches[1].triangles.clear(); }, {"S3", "S5", "S8"}},
        Mutation{"glued_flat", tube, glue_flat, {"S3", "S6", "S7"}},
        Mutation{"seven_sides",
                 leaves,
                 [](StripMesh& m) {
                   m.patches[0].corners.clear();
                   for (int k = 0; k < 7; ++k) m.patches[0].corners.push_back(k);
                 },
                 {"S4"}},
        Mutation{
            "clockwise",
            leaves,
            [](StripMesh& m) { std::reverse(m.patches[0].boundary.begin(), m.patches[0].boundary.end()); },
            {"S4"}},
        Mutation{"other_boundary",
                 leaves,
                 [](StripMesh& m) { m.patches[0].boundary[1] = m.patches[1].boundary[1]; },
                 {"S4"}},
        Mutation{"boundary_vt",
                 leaves,
                 [](StripMesh& m) { std::swap(m.patches[0].boundary_vt[1], m.patches[0].boundary_vt[2]); },
                 {"S4"}},
        Mutation{"corner_off_arch_end", leaves, [](StripMesh& m) { m.patches[0].corners[1] += 1; }, {"S4"}},
        Mutation{"corners_unordered",
                 leaves,
                 [](StripMesh& m) { std::swap(m.patches[0].corners[1], m.patches[0].corners[2]); },
                 {"S4"}},
        Mutation{"arches_unordered",
                 bands,
                 [](StripMesh& m) { std::swap(m.patches[0].arches[0], m.patches[0].arches[1]); },
                 {"S4"}},
        Mutation{"arch_forgotten", leaves, [](StripMesh& m) { m.patches[0].arches.pop_back(); }, {"S4"}},
        Mutation{"arch_of_others",
                 leaves,
                 [](StripMesh& m) {
                   for (auto& a : m.arches)
                     if (a.patches[1] < 0 && a.patches[0] == 0) return void(a.patches[0] = 1);
                 },
                 {"S5"}},
        Mutation{"border_not_named",
                 leaves,
                 [](StripMesh& m) {
                   for (auto& a : m.arches)
                     if (a.patches[1] >= 0) a.patches[1] = -1;
                 },
                 {"S5"}},
        Mutation{"arch_twice", leaves, [](StripMesh& m) { m.arches.push_back(m.arches[0]); }, {"S5"}},
        Mutation{"stretched", leaves, stretch, {"S6"}},
        Mutation{
            "runs_into_itself", [] { return shapes::two_leaves(60, 0, 40); }, fold_outline, {"S6", "S7"}},
        Mutation{"shared_vt",
                 leaves,
                 [](StripMesh& m) {  // both leaves laid onto each other, using one vt of the other
                   const int mine = m.patches[1].boundary_vt[0], other = m.patches[0].boundary_vt[0];
                   const Vector2 shift = m.uvs[mine] - m.uvs[other];
                   for (int i : m.patches[0].boundary_vt) m.uvs[i] += shift;
                   for (auto& face : m.patches[1].triangles)
                     for (int& i : face.vt)
                       if (i == mine) i = other;
                   m.patches[1].boundary_vt[0] = other;
                 },
                 {"S7"}},
        Mutation{"ruling_on_border",
                 leaves,
                 [](StripMesh& m) {
                   m.patches[0].rulings[0] = {m.patches[0].boundary[0], m.patches[0].boundary[1]};
                 },
                 {"S8"}},
        Mutation{"ruling_of_the_other",
                 leaves,
                 [](StripMesh& m) { m.patches[0].rulings[0] = m.patches[1].rulings[0]; },
                 {"S8"}},
        Mutation{"ruling_twice",
                 leaves,
                 [](StripMesh& m) {
                   m.patches[0].rulings[0] = {m.patches[0].rulings[1][1], m.patches[0].rulings[1][0]};
                 },
                 {"S8"}},
        Mutation{"no_rulings", leaves, [](StripMesh& m) { m.patches[0].rulings.clear(); }, {"S8"}},
        Mutation{"seam_as_ruling",
                 tube,
                 [](StripMesh& m) {
                   m.patches[0].rulings[0] = {0, 1};
                 },
                 {"S8"}},
        Mutation{"two_points_in_one_place", leaves, lift_seam_point, {"S2", "S4", "S5", "S8", "S9"}}),
    [](const auto& instance) { return std::string(instance.param.name); });

// A square that lies on the back of a larger one, a little nearer to it than to itself where the input had
// it: as a flap that repair has cut off.
struct Flap {
  StripMesh strips;
  SurfaceMesh input;
};
Flap flap(bool turned_over) {
  std::vector<Vector3> points{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
  for (const Vector3& p :
       {Vector3(1, 1, 0.01), Vector3(1, 2, 0.01), Vector3(2, 2, 0.01), Vector3(2, 1, 0.01)})
    points.push_back(p);
  shapes::StripBuilder builder(points);
  builder.add({{0, 1, 2}, {0, 2, 3}}, {0, 1, 2, 3}, {{0, 2}}, 0);
  if (turned_over)
    builder.add({{4, 6, 5}, {4, 7, 6}}, {4, 5, 6, 7}, {{4, 6}}, 1);
  else
    builder.add({{4, 5, 6}, {4, 6, 7}}, {4, 5, 6, 7}, {{4, 6}}, 1);
  for (int v = 4; v < 8; ++v) points[v].z() = 0.05;
  return {builder.finish(), build_surface_mesh(points, {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}})};
}

TEST(Certificate, ComponentOnTheBackOfAnotherHasItsOwnOutside) {
  const Flap good = flap(false);
  const auto defects = check_structure(good.strips, &good.input, 6, kDiagonal);
  EXPECT_TRUE(defects.empty()) << text_of(defects);
}

TEST(Certificate, ComponentTurnedOverIsFound) {
  Flap far = flap(true);
  for (int v = 4; v < 8; ++v) far.strips.points[v].z() = far.input.points[v].z() = 3;
  const auto defects = check_structure(far.strips, &far.input, 6, kDiagonal);
  ASSERT_EQ(defects.size(), 1u) << text_of(defects);
  EXPECT_EQ(defects[0].check, "S2");
  EXPECT_EQ(defects[0].patch, 1);
}

TEST(Certificate, FlatPatchNeedsNoRulings) {
  StripMesh flat = shapes::two_leaves(60, 0, 12);
  for (auto& patch : flat.patches) patch.rulings.clear();
  EXPECT_TRUE(check_structure(flat, nullptr, 6, kDiagonal).empty());
}

TEST(Certificate, ThinTriangleIsDegenerate) {
  StripMesh m;
  m.points = {{0, 0, 0}, {1, 0, 0}, {0.5, 2e-7, 0}};
  m.uvs = {{0, 0}, {1, 0}, {0.5, 2e-7}};
  m.patches.resize(1);
  m.patches[0].triangles = {{{0, 1, 2}, {0, 1, 2}}};
  EXPECT_THAT(checks_of(check_patch(m, 0, 4)), UnorderedElementsAre("S9"));
  EXPECT_TRUE(check_patch(m, 0, 1).empty());  // the tolerance is a fraction of the input's diagonal
}

TEST(Certificate, InnerVertexIsFound) {
  StripMesh m;
  m.points = {{0, 0, 0}, {1, 0, 0}, {-0.5, 0.8, 0}, {-0.5, -0.8, 0}};
  m.uvs = {{0, 0}, {1, 0}, {-0.5, 0.8}, {-0.5, -0.8}};
  m.patches.resize(1);
  for (const std::array<int, 3>& t : {std::array{0, 1, 2}, {0, 2, 3}, {0, 3, 1}})
    m.patches[0].triangles.push_back({t, t});
  EXPECT_THAT(checks_of(check_patch(m, 0, 2)), UnorderedElementsAre("S3"));
}

TEST(Certificate, FlatRingCutBySlitWithoutWidthIsRefused) {
  // A full flat ring: unrolled it closes, so that both sides of its seam lie on each other.
  StripMesh m;
  const int n = 24;
  std::vector<Vector3> p;
  std::vector<int> inner, outer;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * shapes::kPi * i / n;
    p.emplace_back(std::cos(a), std::sin(a), 0), p.emplace_back(2 * std::cos(a), 2 * std::sin(a), 0);
  }
  for (int i = 0; i <= n; ++i) inner.push_back(2 * (i % n)), outer.push_back(2 * (i % n) + 1);
  shapes::StripBuilder b(p);
  b.add_strip(inner, outer, {0, 1});
  m = b.finish();
  EXPECT_THAT(checks_of(check_structure(m, nullptr, 6, 6)), UnorderedElementsAre("S7"));
}

TEST(Certificate, FullTurnAtAVertexIsRefused) {
  // A fan around a border vertex that turns by exactly 360 degrees, and one that turns by a little less.
  for (const double total : {360.0, 359.0}) {
    StripMesh m;
    const int n = 12;
    m.points.push_back(Vector3::Zero());
    m.patches.resize(1);
    for (int i = 0; i <= n; ++i) {
      const double a = total * shapes::kPi / 180 * i / n;
      // The radius grows along the way: ends that lie on each other are two different points.
      m.points.emplace_back((1 + 0.2 * i / n) * std::cos(a), (1 + 0.2 * i / n) * std::sin(a), 0);
      if (i > 0) m.patches[0].triangles.push_back({{0, i, i + 1}, {0, i, i + 1}});
    }
    for (const Vector3& p : m.points) m.uvs.push_back(p.head<2>());
    const auto defects = check_patch(m, 0, 2);
    EXPECT_EQ(checks_of(defects), total == 360 ? std::set<std::string>{"S7"} : std::set<std::string>{})
        << text_of(defects);
  }
}

TEST(Outline, ContactAgreesWithBruteForce) {
  std::uint64_t state = 1;
  const auto next = [&] {
    return static_cast<double>((state = state * 6364136223846793005u + 1442695040888963407u) >> 11) * 0x1p-53;
  };
  int touching = 0;
  for (int trial = 0; trial < 400; ++trial) {
    std::vector<Vector2> p;
    const int n = 4 + trial % 30;
    for (int i = 0; i < n; ++i) {
      const double a = 2 * shapes::kPi * i / n, r = 1 + (trial % 3) * next();
      p.emplace_back(r * std::cos(a) + 0.3 * (trial % 5) * next(), r * std::sin(a));
    }
    double closest = 1e9;
    for (int i = 0; i < n; ++i)
      for (int j = i + 2; j < n; ++j)
        if (!(i == 0 && j == n - 1))
          closest = std::min(closest, segment_distance(p[i], p[(i + 1) % n], p[j], p[(j + 1) % n]));
    const double tolerance = 1e-2;
    const Contact c = self_contact(p, tolerance);
    EXPECT_EQ(c.i >= 0, closest <= tolerance);
    touching += c.i >= 0;
    if (c.i >= 0) {
      EXPECT_DOUBLE_EQ(c.distance, closest);
    }
  }
  EXPECT_GT(touching, 20);
  EXPECT_LT(touching, 380);
}

DistanceReport distance(const TriangleSoup& input, const StripMesh& result, int samples, int threads = 1) {
  RunContext context;
  context.threads = threads;
  return measure_distance(input, ClosestPointTree(input.points, input.faces), result, samples, context);
}

TEST(Distance, IsZeroAgainstItself) {
  const StripMesh torus = shapes::torus_bands(12, 60);
  const DistanceReport d = distance(shapes::soup_of(torus), torus, 2000);
  EXPECT_LT(d.hausdorff(), 1e-9);
  EXPECT_LT(d.mean, 1e-9);
}

TEST(Distance, OfShiftedPlanesIsTheShift) {
  const StripMesh flat = shapes::two_leaves(0, 0, 10);  // [0, 2] x [-1, 1] in z = 0
  TriangleSoup input = shapes::plane(7, 2);
  for (Vector3& p : input.points) p += Vector3(0, -1, 0.25);
  const DistanceReport d = distance(input, flat, 4000);
  EXPECT_NEAR(d.input_to_result, 0.25, 1e-9);
  EXPECT_NEAR(d.result_to_input, 0.25, 1e-9);
  EXPECT_NEAR(d.mean, 0.25, 1e-9);
  EXPECT_NEAR(d.patch_error[0], 0.25, 1e-9);
}

TEST(Distance, FindsTheSagittaOfAnInscribedCylinder) {
  // Tube of n flat quads inside a fine cylinder: the farthest points lie in the middle of the quads.
  const int n = 12;
  const TriangleSoup input = shapes::cylinder(600, 8, 1, 2);
  const DistanceReport d = distance(input, shapes::tube(n, 1, 2), 500);
  const double sagitta = 1 - std::cos(shapes::kPi / n);
  EXPECT_NEAR(d.result_to_input, sagitta, 1e-5 * std::sqrt(12));
  EXPECT_NEAR(d.input_to_result, sagitta, 1e-5 * std::sqrt(12));
}

TEST(Distance, FindsASpikeThatNoSampleHits) {
  TriangleSoup input = shapes::plane(40, 2);
  for (Vector3& p : input.points) p += Vector3(0, -1, 0);
  input.points[41 * 17 + 23].z() += 0.3;
  const DistanceReport d = distance(input, shapes::two_leaves(0, 0, 3), 10);
  EXPECT_NEAR(d.input_to_result, 0.3, 1e-9);
  EXPECT_LT(d.result_to_input, 0.3);
}

// The plane [0, 2] x [-1, 1] without one of its small squares: no sample of the result need lie above the
// gap.
TriangleSoup plane_with_a_gap(int n) {
  TriangleSoup input = shapes::plane(n, 2);
  for (Vector3& p : input.points) p += Vector3(0, -1, 0);
  const auto gap = input.faces.begin() + n * n + n / 3 * 2;
  input.faces.erase(gap, gap + 2);
  return input;
}

TEST(Distance, FindsThePeakThatNoSampleIsNear) {
  const int n = 60;
  const TriangleSoup input = plane_with_a_gap(n);
  const DistanceReport d = distance(input, shapes::two_leaves(0, 0, 3), 10);
  EXPECT_LT(d.input_to_result, 1e-9);
  EXPECT_NEAR(d.result_to_input, 1.0 / n, 1e-4);  // half of the gap's width
  EXPECT_GE(d.at_most, d.hausdorff());
  EXPECT_LE(d.at_most, d.hausdorff() + 1e-4);
}

TEST(Distance, IsProvenAboveAllSamples) {
  for (int bands : {8, 12, 20}) {
    const StripMesh torus = shapes::torus_bands(bands, 5 * bands);
    const TriangleSoup input = shapes::torus(50 + bands, 30);
    const DistanceReport d = distance(input, torus, 100);
    const double seen = distance(input, torus, 40000).hausdorff();
    EXPECT_GE(d.at_most, seen);
    EXPECT_NEAR(d.hausdorff(), seen, 1e-3 * seen);
  }
}

// Strips far wider than the input's faces are settled whole, by height: convexity alone leaves four times the
// distance open after all the splits that are made once a promise is known to be kept.
TEST(Distance, IsProvenOverManyFacesAtOnce) {
  const TriangleSoup input = shapes::cylinder(400, 200, 1, 2);
  RunContext context;
  const DistanceReport d = measure_distance(input, ClosestPointTree(input.points, input.faces),
                                            shapes::tube(24, 1, 2), 500, context, 1);
  EXPECT_NEAR(d.hausdorff(), 1 - std::cos(shapes::kPi / 24), 1e-4);
  EXPECT_LE(d.at_most, d.hausdorff() + 1e-4);
}

HeightBound over(const TriangleSoup& input) { return {input.points, input.faces, kDiagonal}; }

TEST(FindFar, FindsPlacesBeyondTheLimitAndNoOthers) {
  const int n = 60;
  const TriangleSoup input = plane_with_a_gap(n);
  const StripMesh result = shapes::two_leaves(0, 0, 3);
  const ClosestPointTree tree(input.points, input.faces);
  RunContext context;
  const DistanceReport far = find_far(input, tree, over(input), result, 0.9 / n, context);
  ASSERT_FALSE(far.far.empty());
  for (const FarPlace& place : far.far) {
    EXPECT_GT(place.distance, 0.9 / n);
    const Vector3 on_strips = place.barycentric[0] * result.points[place.triangle[0]] +
                              place.barycentric[1] * result.points[place.triangle[1]] +
                              place.barycentric[2] * result.points[place.triangle[2]];
    EXPECT_NEAR((on_strips - place.on_input).norm(), place.distance, 1e-9);
  }
  EXPECT_NEAR(far.result_to_input, 1.0 / n, 0.1 / n);
  const DistanceReport near = find_far(input, tree, over(input), result, 1.1 / n, context);
  EXPECT_TRUE(near.far.empty());
  EXPECT_LE(near.at_most, 1.1 / n);
}

TEST(FindFar, SeesASpikeOfTheInput) {
  TriangleSoup input = shapes::plane(40, 2);
  for (Vector3& p : input.points) p += Vector3(0, -1, 0);
  const Vector3& tip = input.points[41 * 17 + 23] += Vector3(0, 0, 0.3);
  const ClosestPointTree tree(input.points, input.faces);
  RunContext context;
  const DistanceReport d = find_far(input, tree, over(input), shapes::two_leaves(0, 0, 3), 0.2, context);
  EXPECT_NEAR(d.input_to_result, 0.3, 1e-9);
  ASSERT_FALSE(d.far.empty());
  for (const FarPlace& place : d.far)
    EXPECT_TRUE(place.distance < 0.29 || (place.on_input - tip).norm() < 0.05);
}

TEST(Distance, IsOneSidedWhereThePatchIsMissing) {
  // The input reaches farther than the result: only the way from the input sees it.
  const TriangleSoup input =
      shapes::grid({20, 20}, [](double u, double v) { return Vector3(3 * u, 2 * v - 1, 0); });
  const DistanceReport d = distance(input, shapes::two_leaves(0, 0, 5), 1000);
  EXPECT_NEAR(d.input_to_result, 1.0, 1e-9);
  EXPECT_LT(d.result_to_input, 1e-9);
}

TEST(Distance, DoesNotDependOnThreads) {
  const StripMesh torus = shapes::torus_bands(12, 60);
  const TriangleSoup input = shapes::torus(70, 40);
  const DistanceReport a = distance(input, torus, 5000, 1), b = distance(input, torus, 5000, 4);
  EXPECT_EQ(a.input_to_result, b.input_to_result);
  EXPECT_EQ(a.result_to_input, b.result_to_input);
  EXPECT_EQ(a.mean, b.mean);
  EXPECT_EQ(a.worst_place, b.worst_place);
  EXPECT_EQ(a.patch_error, b.patch_error);
}

TEST(Certify, SaysAllOfIt) {
  const StripMesh torus = shapes::torus_bands(12, 60);
  TriangleSoup input = shapes::torus(70, 40);
  const SurfaceMesh repaired = build_surface_mesh(input.points, input.faces);
  RunContext context;
  const Certificate c = certify(input, &repaired, torus, 6, 5000, context);
  EXPECT_TRUE(c.strict()) << text_of(c.defects);
  EXPECT_GT(c.distance.hausdorff(), 0);
  EXPECT_LT(c.isometry_error, 1e-12);
}

TEST(Facing, IsOneOnTheSurfaceItselfAndMinusOneInsideOut) {
  for (const StripMesh& strips : {shapes::tube(24), shapes::torus_bands(6, 24)}) {
    TriangleSoup soup = shapes::soup_of(strips);
    EXPECT_NEAR(facing(strips, soup, ClosestPointTree(soup.points, soup.faces)), 1, 1e-9);
    for (auto& f : soup.faces) std::swap(f[1], f[2]);
    EXPECT_NEAR(facing(strips, soup, ClosestPointTree(soup.points, soup.faces)), -1, 1e-9);
  }
}

TEST(HasThickness, TellsSheetsOfTwoSidesFromPlatesAndOpenSheets) {
  EXPECT_TRUE(has_thickness(shapes::plane(4)));
  EXPECT_TRUE(has_thickness(shapes::cylinder(24, 4)));
  EXPECT_TRUE(has_thickness(shapes::box(3, {1, 1, 1})));
  EXPECT_TRUE(has_thickness(shapes::box(3, {1, 1, 1e-3})));
  for (TriangleSoup sheet : {shapes::plane(4), shapes::saddle(8), shapes::cylinder_patch(12, 4)}) {
    const std::size_t faces = sheet.faces.size();
    for (std::size_t f = 0; f < faces; ++f)
      sheet.faces.push_back({sheet.faces[f][0], sheet.faces[f][2], sheet.faces[f][1]});
    EXPECT_FALSE(has_thickness(sheet));
  }
}

}  // namespace
}  // namespace sheetform
