#include "sheetform/search/layout_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sheetform/base/error.h"
#include "sheetform/search/detail_points.h"
#include "unit/search/drawn_surface.h"

namespace sheetform {
namespace {

// No network vertex inside of the surface with one edge only.
void expect_no_loose_ends(const LayoutSearch& search, const SurfaceMesh& mesh) {
  for (int v = 0; v < mesh.vertex_count(); ++v)
    EXPECT_NE(network_degree(mesh, search.network().network(), v), 1) << v;
}

struct Case {
  const char* name;
  TriangleSoup soup;
  double e_max;
  int most;  // patches that the finished search may need
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class WholeSearch : public ::testing::TestWithParam<Case> {};
TEST_P(WholeSearch, InsertsUntilViableThenRemovesAndStaysSo) {
  const Case& c = GetParam();
  Searched s(c.soup, c.e_max);
  LayoutSearch& search = *s.search;
  search.insert();
  expect_viable(search, c.e_max);
  expect_no_loose_ends(search, s.bed.surface.mesh);
  const std::size_t inserted = search.layout().patches.size();
  const int edges = inner_edges(s.bed.surface.mesh, search.network().network());
  search.remove_paths();
  expect_viable(search, c.e_max);
  const std::size_t after_paths = search.layout().patches.size();
  EXPECT_LE(after_paths, inserted);
  EXPECT_LE(inner_edges(s.bed.surface.mesh, search.network().network()), edges);
  search.remove_arches();
  expect_viable(search, c.e_max);
  expect_no_loose_ends(search, s.bed.surface.mesh);
  const std::size_t after_arches = search.layout().patches.size();
  EXPECT_LE(after_arches, after_paths);
  EXPECT_LE(static_cast<int>(after_arches), c.most);
  const double objective = search.objective();
  const int improved = search.improve(5, 1);
  EXPECT_EQ(search.objective() < objective, improved > 0);
  EXPECT_LE(search.objective(), objective) << "what does not help is taken back";
  expect_viable(search, c.e_max);
}
INSTANTIATE_TEST_SUITE_P(Shapes, WholeSearch,
                         ::testing::Values(Case{"torus", shapes::torus(60, 30), 0.03, 8},
                                           Case{"sphere", shapes::sphere(16), 0.04, 8},
                                           Case{"saddle", shapes::saddle(30, 0.8), 0.02, 4},
                                           Case{"tube", shapes::cylinder(48, 24), 0.02, 1},
                                           Case{"closed_cylinder", shapes::closed_cylinder(48, 16), 0.02,
                                                3}));

// A ball with knobs all over.
TriangleSoup knobbly(int n, double height, double knobs) {
  TriangleSoup soup = shapes::sphere(n);
  for (Vector3& p : soup.points)
    p *= 1 + height * std::sin(knobs * p.x()) * std::sin(knobs * p.y()) * std::sin(knobs * p.z());
  return soup;
}

// Where a path ends no more, the patch beyond it has a node less: it must still have strips.
TEST(LayoutSearch, RemovalsLeaveStripsToTheNeighbours) {
  Searched s(knobbly(22, 0.9, 5), 0.015);
  s.search->insert();
  const auto expect_strips = [&] {
    for (const auto& p : s.search->evaluation().patches)
      EXPECT_TRUE(p->viable() || p->verdict == PatchVerdict::kError) << to_string(p->verdict);
  };
  expect_strips();
  s.search->remove_paths();
  expect_strips();
  s.search->remove_arches();
  expect_strips();
}

TEST(LayoutSearch, CreasesAreNeverRemoved) {
  Searched s(shapes::closed_cylinder(48, 16), 0.02);
  s.search->insert();
  s.search->remove_paths();
  s.search->remove_arches();
  const PathNetwork& network = s.search->network().network();
  for (int e = 0; e < s.bed.surface.mesh.edge_count(); ++e) {
    if (!s.crease[e]) continue;
    ASSERT_TRUE(network.used(e));
    EXPECT_EQ(network.kinds[network.edge_path[e]], PathKind::kCrease);
  }
}

TEST(LayoutSearch, ObjectiveIsPartsPlusALittleForLength) {
  Searched s(shapes::torus(48, 24), 0.03);
  s.search->insert();
  double length = 0;
  for (const Arch& a : s.search->layout().arches)
    if (a.left >= 0 && a.right >= 0) length += a.length;
  const double parts = static_cast<double>(s.search->layout().patches.size());
  EXPECT_GT(s.search->objective(), parts);
  EXPECT_LT(s.search->objective(), parts + length);
}

TEST(LayoutSearch, SplitGivesMorePatches) {
  Searched s(shapes::torus(48, 24), 0.05);
  s.search->insert();
  const std::size_t before = s.search->layout().patches.size();
  EXPECT_EQ(s.search->split({0, 1}, PatchVerdict::kError), 2);
  EXPECT_EQ(s.search->layout().patches.size(), before + 2);
}

TEST(LayoutSearch, SmoothingMovesVerticesOnTheSurfaceOnly) {
  Searched s(shapes::torus(48, 24), 0.05);
  s.search->insert();
  const double diagonal = 1, step = mean_edge_length(s.bed.surface.mesh);
  s.search->smooth();
  for (const Vector3& p : s.bed.surface.mesh.points)
    EXPECT_LT(std::sqrt(s.bed.tree.closest(p).squared_distance), 0.05 * step * diagonal);
  const SurfaceMesh& mesh = s.bed.surface.mesh;
  for (int f = 0; f < mesh.face_count(); ++f)
    EXPECT_GT(mesh.face_normal_raw(f).dot(s.bed.surface.guide.normal[f]), 0);
}

// Points a little off the mesh, each attached to the face that it was made above; ascending.
DetailPoints details_above(const SurfaceMesh& mesh, double height) {
  std::vector<DetailPoint> details;
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Vector3 up = mesh.face_normal_raw(f).normalized();
    const Vector3 weights(0.2 + 0.1 * (f % 5), 0.2, 0.6 - 0.1 * (f % 5));
    Vector3 p = height * up;
    for (int k = 0; k < 3; ++k) p += weights[k] * mesh.points[mesh.faces[f][k]];
    details.push_back({p, weights, f});
  }
  return std::make_shared<const std::vector<DetailPoint>>(std::move(details));
}

// A finer tolerance asks for details that a coarser one leaves out.
TEST(LayoutSearch, StartsAgainWithOtherDetails) {
  Searched s(shapes::plane(10), 0.03);
  SearchParams params;
  params.evaluation.e_max = 0.03;
  const DetailPoints details = details_above(s.bed.surface.mesh, 0.1);
  const double without = s.search->evaluation().patch_error.at(0);
  LayoutSearch fine(*s.search, s.search->network().network(), details, params);
  EXPECT_GT(fine.evaluation().patch_error.at(0), 0.03);
  fine.smooth();
  LayoutSearch coarse(fine, s.search->network().network(), nullptr, params);
  EXPECT_EQ(s.bed.surface.details, nullptr);
  EXPECT_DOUBLE_EQ(coarse.evaluation().patch_error.at(0), without);
}

TEST(LayoutSearch, DetailsStayAboveTheirFacesAsTheMeshIsSmoothed) {
  Searched s(knobbly(20, 0.5, 5), 0.03);
  SurfaceMesh& mesh = s.bed.surface.mesh;
  const double height = 0.002;
  const DetailPoints made = s.bed.surface.details = details_above(mesh, height);
  const std::vector<DetailPoint>& before = *made;
  const std::vector<int> versions = s.bed.surface.versions;
  s.search->insert();  // and smooths
  const std::vector<DetailPoint>& after = *s.bed.surface.details;
  ASSERT_EQ(after.size(), before.size());
  const ClosestPointTree tree(mesh.points, mesh.faces);
  for (const DetailPoint& d : after) {
    Vector3 below = Vector3::Zero();
    for (int k = 0; k < 3; ++k) below += d.barycentric[k] * mesh.points[mesh.faces[d.face][k]];
    const double nearest = std::sqrt(tree.closest(d.point).squared_distance);
    EXPECT_LE((below - d.point).norm(), nearest + 0.1 * height);
  }
  EXPECT_TRUE(std::is_sorted(after.begin(), after.end(),
                             [](const DetailPoint& a, const DetailPoint& b) { return a.face < b.face; }));
  const std::vector<int> changed = faces_that_differ(before, after);
  EXPECT_GT(changed.size(), before.size() / 10) << "the test needs a path that moves";
  for (int f : changed)
    for (int v : mesh.faces[f]) EXPECT_GT(s.bed.surface.versions[v], versions[v]) << f;
}

TEST(DetailPoints, FacesThatDifferAreThoseWithOtherPoints) {
  const auto at = [](int face, double x) { return DetailPoint{Vector3(x, 0, 0), Vector3(1, 0, 0), face}; };
  const std::vector<DetailPoint> one{at(1, 0), at(1, 1), at(3, 0), at(5, 0)},
      other{at(1, 0), at(1, 1), at(3, 2), at(4, 0), at(5, 0), at(5, 1)};
  EXPECT_TRUE(faces_that_differ(one, one).empty());
  EXPECT_EQ(faces_that_differ(one, other), (std::vector<int>{3, 4, 5}));
  EXPECT_EQ(faces_that_differ(other, one), (std::vector<int>{3, 4, 5}));
  EXPECT_EQ(faces_that_differ({}, one), (std::vector<int>{1, 3, 5}));
}

// Arches between two patches that turn by more than 35 degrees at a vertex.
int rough_arches(const SurfaceMesh& mesh, const PatchLayout& layout) {
  int rough = 0;
  for (const Arch& a : layout.arches) {
    double sharpest = 0;
    for (std::size_t i = 1; i + 1 < a.vertices.size() && a.left >= 0 && a.right >= 0; ++i) {
      const Vector3 in = mesh.points[a.vertices[i]] - mesh.points[a.vertices[i - 1]],
                    out = mesh.points[a.vertices[i + 1]] - mesh.points[a.vertices[i]];
      sharpest = std::max(sharpest, std::atan2(in.cross(out).norm(), in.dot(out)));
    }
    rough += sharpest > 35 * shapes::kPi / 180 && !a.closed();
  }
  return rough;
}

TEST(LayoutSearch, RoughArchesLoseTheirStaircaseAndPatchesStayViable) {
  Searched s(shapes::torus(48, 24), 0.04);
  s.search->insert();
  s.search->remove_paths();
  s.search->remove_arches();
  const auto patches = s.search->layout().patches.size();
  s.search->split({0, 1}, PatchVerdict::kError);
  const std::vector<int> before = s.search->network().network().edge_path;
  const int rough = rough_arches(s.bed.surface.mesh, s.search->layout());
  ASSERT_GT(rough, 0) << "a cut runs along the edges of the mesh";
  s.search->smooth_rough_arches();
  EXPECT_LT(rough_arches(s.bed.surface.mesh, s.search->layout()), rough);
  EXPECT_EQ(s.search->network().network().edge_path, before);
  EXPECT_LE(s.search->layout().patches.size(), patches + 2);
  EXPECT_EQ(s.search->evaluation().failing, 0);
  for (const Vector3& p : s.bed.surface.mesh.points)
    EXPECT_LT(std::sqrt(s.bed.tree.closest(p).squared_distance), 0.002);
}

TEST(LayoutSearch, IsTheSameForAnyNumberOfThreads) {
  expect_same_for_any_number_of_threads(0.04, [](Searched& s) {
    s.search->insert();
    s.search->remove_paths();
    s.search->remove_arches();
  });
}

TEST(LayoutSearch, StopsWhenCancelled) {
  Searched s(shapes::sphere(16), 0.02);
  std::atomic<bool> cancelled{true};
  s.bed.context.cancelled = &cancelled;
  try {
    s.search->insert();
    FAIL() << "went on";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::kCancelled);
  }
}

}  // namespace
}  // namespace sheetform
