#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "sheetform/layout/layout.h"
#include "sheetform/mesh/creases.h"
#include "support/drawing.h"
#include "support/shapes.h"

namespace sheetform {
namespace {

using shapes::Drawing;
using shapes::drawn;

std::set<int> pinned(const PathNetwork& network) {
  std::set<int> vertices;
  for (std::size_t v = 0; v < network.pinned_node.size(); ++v)
    if (network.pinned_node[v]) vertices.insert(static_cast<int>(v));
  return vertices;
}

TEST(BareNetwork, TheBorderIsPathZeroAndItsCornersAreNodes) {
  const Drawing d = drawn("AA/A.");
  const PathNetwork bare = bare_network(d.mesh);
  ASSERT_EQ(bare.kinds.size(), 1u);
  EXPECT_EQ(bare.kinds[0], PathKind::kBorder);
  for (int e = 0; e < d.mesh.edge_count(); ++e) EXPECT_EQ(bare.used(e), d.mesh.edges[e].border());
  const std::set<int> corners{d.vertex_at(0, 0), d.vertex_at(2, 0), d.vertex_at(2, 1),
                              d.vertex_at(1, 1), d.vertex_at(1, 2), d.vertex_at(0, 2)};
  EXPECT_EQ(pinned(bare), corners) << "five of 90 degrees and the one of 270";
}

// Border corners of any angle: pinned outside of [126, 243] degrees.
TEST(BareNetwork, BluntBorderCornersAreNoNodes) {
  for (const auto& [degrees, corner] :
       {std::pair{120.0, true}, {135.0, false}, {170.0, false}, {235.0, false}, {250.0, true}}) {
    // A fan of triangles around a border vertex.
    const int n = 6;
    std::vector<Vector3> points{{0, 0, 0}};
    std::vector<std::array<int, 3>> faces;
    for (int i = 0; i <= n; ++i) {
      const double a = degrees * shapes::kPi / 180 * i / n;
      points.emplace_back(std::cos(a), std::sin(a), 0);
      if (i > 0) faces.push_back({0, i, i + 1});
    }
    const SurfaceMesh mesh = build_surface_mesh(points, faces);
    EXPECT_EQ(bare_network(mesh).pinned_node[0] != 0, corner) << degrees;
  }
}

TEST(BareNetwork, RoundBorderHasNoNodes) {
  const TriangleSoup soup = shapes::cylinder(24, 4);
  EXPECT_TRUE(pinned(bare_network(build_surface_mesh(soup.points, soup.faces))).empty());
}

PatchLayout crease_layout(const SurfaceMesh& mesh, PathNetwork* network) {
  *network = bare_network(mesh);
  add_creases(mesh, detect_creases(mesh, 40), *network);
  return extract_layout(mesh, *network, std::vector<int>(mesh.points.size(), 0), {});
}

TEST(AddCreases, BoxIsSixFacesTwelveArchesEightNodes) {
  const TriangleSoup soup = shapes::box(6, {1, 2, 3});
  const SurfaceMesh mesh = build_surface_mesh(soup.points, soup.faces);
  PathNetwork network;
  const PatchLayout layout = crease_layout(mesh, &network);
  EXPECT_EQ(layout.patches.size(), 6u);
  EXPECT_EQ(layout.arches.size(), 12u);
  EXPECT_EQ(std::count_if(layout.node.begin(), layout.node.end(), [](char n) { return n != 0; }), 8);
  EXPECT_EQ(network.kinds.size(), 13u) << "the border and one path an edge of the box";
  std::multiset<double> areas;
  for (const Patch& p : layout.patches) {
    EXPECT_EQ(p.boundary.size(), 4u);
    EXPECT_EQ(p.defect, TopologyDefect::kNone);
    areas.insert(std::round(p.area * 1e9) / 1e9);
  }
  EXPECT_EQ(areas, (std::multiset<double>{2, 2, 3, 3, 6, 6}));
  for (const Arch& a : layout.arches) EXPECT_EQ(network.kinds[a.path], PathKind::kCrease);
}

TEST(AddCreases, ClosedCylinderHasTwoClosedCreases) {
  const TriangleSoup soup = shapes::closed_cylinder(36, 8);
  const SurfaceMesh mesh = build_surface_mesh(soup.points, soup.faces);
  PathNetwork network;
  const PatchLayout layout = crease_layout(mesh, &network);
  ASSERT_EQ(layout.patches.size(), 3u);
  ASSERT_EQ(layout.arches.size(), 2u);
  for (const Arch& a : layout.arches) EXPECT_TRUE(a.closed());
  int disks = 0, rings = 0;
  for (const Patch& p : layout.patches) {
    disks += p.defect == TopologyDefect::kNone;
    rings += p.defect == TopologyDefect::kNotADisk && p.loops == 2;
  }
  EXPECT_EQ(disks, 2);
  EXPECT_EQ(rings, 1) << "the wall waits for a seam";
}

TEST(AddCreases, ChainsBreakWhereTheyTurnByMoreThan50Degrees) {
  Drawing d = drawn("AAA/AAA/AAA");
  std::vector<char> crease(d.mesh.edges.size(), 0);
  for (int e : d.line(1, 0, 1, 1))
    crease[e] = 1;  // down from the border, then right to the border: one turn of 90
  for (int e : d.line(1, 1, 3, 1)) crease[e] = 1;
  PathNetwork network = bare_network(d.mesh);
  add_creases(d.mesh, crease, network);
  EXPECT_EQ(network.kinds.size(), 3u);
  const PatchLayout layout = extract_layout(d.mesh, network, d.versions, {});
  EXPECT_TRUE(layout.node[d.vertex_at(1, 1)]);
  EXPECT_EQ(layout.patches.size(), 2u);
}

TEST(AddCreases, LeavesOtherPathsAlone) {
  Drawing d = drawn("AB/AB");
  std::vector<char> crease(d.mesh.edges.size(), 0);
  for (int e : d.line(0, 1, 2, 1)) crease[e] = 1;  // crosses the path between A and B
  PathNetwork network = d.network;
  add_creases(d.mesh, crease, network);
  for (int e : d.line(1, 0, 1, 2)) EXPECT_EQ(network.kinds[network.edge_path[e]], PathKind::kTraced);
  EXPECT_EQ(extract_layout(d.mesh, network, d.versions, {}).patches.size(), 4u);
}

TEST(NetworkDegree, CountsNetworkEdges) {
  const Drawing d = drawn("AAB/AAC");
  EXPECT_EQ(network_degree(d.mesh, d.network, d.vertex_at(2, 1)), 3);
  EXPECT_EQ(network_degree(d.mesh, d.network, d.vertex_at(1, 1)), 0);
  EXPECT_EQ(network_degree(d.mesh, d.network, d.vertex_at(0, 0)), 2);
  EXPECT_EQ(network_degree(d.mesh, d.network, d.vertex_at(2, 0)), 3);
}

}  // namespace
}  // namespace sheetform
