#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "sheetform/layout/layout.h"
#include "support/drawing.h"
#include "support/shapes.h"

namespace sheetform {
namespace {

using shapes::Canvas;
using shapes::Drawing;
using shapes::drawn;

int node_count(const PatchLayout& layout) {
  return static_cast<int>(
      std::count_if(layout.node.begin(), layout.node.end(), [](char n) { return n != 0; }));
}

int first_vertex(const PatchLayout& layout, const ArchUse& use) {
  const Arch& a = layout.arches[use.arch];
  return use.forward ? a.vertices.front() : a.vertices.back();
}
int last_vertex(const PatchLayout& layout, const ArchUse& use) {
  return first_vertex(layout, {use.arch, !use.forward});
}

// Rolled to a tube of radius 1 and of the height that keeps the cells square.
Canvas tube(int columns) {
  Canvas canvas;
  canvas.roll = true;
  canvas.place = [=](double x, double y) {
    const double a = 2 * shapes::kPi * x / columns;
    return Vector3(std::cos(a), std::sin(a), 2 * shapes::kPi * y / columns);
  };
  return canvas;
}

Canvas torus(int columns, int rows) {
  Canvas canvas;
  canvas.roll = canvas.close = true;
  canvas.place = [=](double x, double y) {
    const double a = 2 * shapes::kPi * x / columns, b = 2 * shapes::kPi * y / rows;
    return Vector3((2 + std::cos(b)) * std::cos(a), (2 + std::cos(b)) * std::sin(a), std::sin(b));
  };
  return canvas;
}

// Every statement of layout.h that can be told from the result alone.
void expect_consistent(const Drawing& d, const PatchLayout& layout) {
  std::map<int, int> uses;  // arch -> how many sides of patches
  double area = 0;
  for (int p = 0; p < static_cast<int>(layout.patches.size()); ++p) {
    const Patch& patch = layout.patches[p];
    area += patch.area;
    EXPECT_TRUE(std::is_sorted(patch.faces.begin(), patch.faces.end()));
    for (int f : patch.faces) EXPECT_EQ(layout.face_patch[f], p);
    const std::size_t n = patch.boundary.size();
    for (std::size_t i = 0; i < n; ++i) {
      const ArchUse &use = patch.boundary[i], &next = patch.boundary[(i + 1) % n];
      EXPECT_EQ(last_vertex(layout, use), first_vertex(layout, next));
      const Arch& a = layout.arches[use.arch];
      EXPECT_EQ(use.forward ? a.left : a.right, p) << "the patch lies on the left of its boundary";
      ++uses[use.arch];
    }
  }
  EXPECT_NEAR(area, surface_area(d.mesh), 1e-12 * surface_area(d.mesh));
  for (int i = 0; i < static_cast<int>(layout.arches.size()); ++i) {
    const Arch& a = layout.arches[i];
    ASSERT_EQ(a.vertices.size(), a.edges.size() + 1);
    double length = 0;
    for (std::size_t s = 0; s < a.edges.size(); ++s) {
      EXPECT_EQ(d.mesh.find_edge(a.vertices[s], a.vertices[s + 1]), a.edges[s]);
      EXPECT_EQ(layout.edge_arch[a.edges[s]], i);
      EXPECT_EQ(d.network.edge_path[a.edges[s]], a.path);
      EXPECT_TRUE(s == 0 || !layout.node[a.vertices[s]]);
      length += d.mesh.edge_length(a.edges[s]);
    }
    EXPECT_NEAR(a.length, length, 1e-12);
    EXPECT_TRUE(a.closed() || (layout.node[a.vertices.front()] && layout.node[a.vertices.back()]));
  }
  for (int e = 0; e < d.mesh.edge_count(); ++e) EXPECT_EQ(layout.edge_arch[e] >= 0, d.network.used(e));
}

// Of the complex of nodes, arches and patches, when all patches are disks.
int euler(const PatchLayout& layout) {
  return node_count(layout) - static_cast<int>(layout.arches.size()) +
         static_cast<int>(layout.patches.size());
}

TEST(ExtractLayout, ThreeRectanglesAroundOneTJunction) {
  const Drawing d = drawn("AAB/AAC");
  const PatchLayout layout = d.layout();
  expect_consistent(d, layout);
  ASSERT_EQ(layout.patches.size(), 3u);
  EXPECT_EQ(node_count(layout), 8);  // four corners, three ends on the border, one T-junction inside
  EXPECT_EQ(layout.arches.size(), 10u);
  EXPECT_EQ(euler(layout), 1);
  for (const Patch& p : layout.patches) {
    EXPECT_EQ(p.defect, TopologyDefect::kNone);
    EXPECT_EQ(p.loops, 1);
  }
  const Patch& a = layout.patches[d.patch_of(layout, 'A')];
  EXPECT_NEAR(a.area, 4, 1e-12);
  EXPECT_EQ(a.boundary.size(), 5u);
  EXPECT_EQ(a.faces, d.faces_of('A'));
  EXPECT_EQ(layout.patches[d.patch_of(layout, 'B')].boundary.size(), 4u);
  EXPECT_TRUE(layout.node[d.vertex_at(2, 1)]);
  EXPECT_FALSE(layout.node[d.vertex_at(1, 1)]);
  EXPECT_FALSE(layout.node[d.vertex_at(1, 0)]) << "straight border";
}

TEST(ExtractLayout, BoundaryRunsCounterClockwise) {
  const Drawing d = drawn("AAB/AAC");
  const PatchLayout layout = d.layout();
  for (const Patch& p : layout.patches) {
    double twice = 0;
    for (const ArchUse& use : p.boundary) {
      const Vector3 &a = d.mesh.points[first_vertex(layout, use)],
                    &b = d.mesh.points[last_vertex(layout, use)];
      twice += a.x() * b.y() - a.y() * b.x();
    }
    EXPECT_NEAR(twice / 2, p.area, 1e-12);
  }
}

TEST(ExtractLayout, ArchesKnowBothSides) {
  const Drawing d = drawn("AAB/AAC");
  const PatchLayout layout = d.layout();
  const int a = d.patch_of(layout, 'A'), b = d.patch_of(layout, 'B'), c = d.patch_of(layout, 'C');
  std::map<std::set<int>, double> length;
  for (const Arch& arch : layout.arches) length[{arch.left, arch.right}] += arch.length;
  EXPECT_NEAR((length[{a, b}]), 1, 1e-12);
  EXPECT_NEAR((length[{a, c}]), 1, 1e-12);
  EXPECT_NEAR((length[{b, c}]), 1, 1e-12);
  EXPECT_NEAR((length[{a, Arch::kOutside}]), 6, 1e-12);
  EXPECT_NEAR((length[{b, Arch::kOutside}]), 2, 1e-12);
}

TEST(ExtractLayout, OneLetterInTwoPlacesIsTwoPatches) {
  const Drawing d = drawn("ABA");
  EXPECT_EQ(d.layout().patches.size(), 3u);
}

TEST(ExtractLayout, RingIsNoDisk) {
  const Drawing d = drawn("AAA/ABA/AAA");
  const PatchLayout layout = d.layout();
  expect_consistent(d, layout);
  const Patch &a = layout.patches[d.patch_of(layout, 'A')], &b = layout.patches[d.patch_of(layout, 'B')];
  EXPECT_EQ(a.defect, TopologyDefect::kNotADisk);
  EXPECT_EQ(a.loops, 2);
  EXPECT_EQ(b.defect, TopologyDefect::kNone);
  EXPECT_EQ(b.boundary.size(), 4u);
}

TEST(ExtractLayout, HandleIsNoDiskAlthoughItHasOneLoop) {
  // A torus with one square taken out: one loop, chi = -1.
  const Drawing d = drawn("AAA/ABA/AAA", torus(3, 3));
  const PatchLayout layout = d.layout();
  expect_consistent(d, layout);
  const Patch& a = layout.patches[d.patch_of(layout, 'A')];
  EXPECT_EQ(a.loops, 1);
  EXPECT_EQ(a.defect, TopologyDefect::kNotADisk);
}

TEST(ExtractLayout, ClosedSurfaceWithoutNetworkHasNoLoop) {
  const Drawing d = drawn("AA/AA", torus(2, 2));
  const PatchLayout layout = d.layout();
  ASSERT_EQ(layout.patches.size(), 1u);
  EXPECT_EQ(layout.patches[0].loops, 0);
  EXPECT_EQ(layout.patches[0].defect, TopologyDefect::kNotADisk);
  EXPECT_TRUE(layout.arches.empty());
}

TEST(ExtractLayout, PatchThatMeetsItselfAtOneVertexTouchesItself) {
  const Drawing d = drawn("AAA/ABA/AAB");
  const PatchLayout layout = d.layout();
  expect_consistent(d, layout);
  ASSERT_EQ(layout.patches.size(), 3u);
  const Patch& a = layout.patches[d.patch_of(layout, 'A')];
  EXPECT_EQ(a.loops, 1);
  EXPECT_EQ(a.defect, TopologyDefect::kTouchesItself);
}

// The walls of these drawings are lines of the user or of the input, which no step may shorten.
Drawing held(Drawing d, PathKind kind) {
  for (PathKind& k : d.network.kinds)
    if (k == PathKind::kTraced) k = kind;
  return d;
}

TEST(ExtractLayout, SlitThatEndsInsideIsADart) {
  const Drawing d = drawn("AA|AA/AAAA");
  const PatchLayout layout = d.layout();
  expect_consistent(d, layout);
  ASSERT_EQ(layout.patches.size(), 1u);
  const Patch& patch = layout.patches[0];
  EXPECT_EQ(patch.loops, 1);
  EXPECT_EQ(patch.defect, TopologyDefect::kNone);
  const int tip = d.vertex_at(2, 1), base = d.vertex_at(2, 0);
  std::map<int, std::set<bool>> ways;
  int at_tip = 0, at_base = 0;
  for (const ArchUse& use : patch.boundary) {
    const Arch& arch = layout.arches[use.arch];
    if (arch.left == arch.right) ways[use.arch].insert(use.forward);
    at_tip += first_vertex(layout, use) == tip;
    at_base += first_vertex(layout, use) == base;
  }
  ASSERT_EQ(ways.size(), 1u) << "one arch";
  EXPECT_EQ(ways.begin()->second.size(), 2u) << "walked to and fro";
  EXPECT_NEAR(layout.arches[ways.begin()->first].length, 1, 1e-12);
  EXPECT_EQ(at_tip, 1);
  EXPECT_EQ(at_base, 2);
}

TEST(ExtractLayout, DartOfAPathThatGoesOnIsOneToo) {
  // A path across from border to border of which a half has gone; it was cut off at a node.
  Drawing d = drawn("AABB/AABB/AABB");
  for (int e : d.line(2, 1, 2, 3)) d.network.edge_path[e] = PathNetwork::kFree;
  const PatchLayout layout = d.layout();
  expect_consistent(d, layout);
  ASSERT_EQ(layout.patches.size(), 1u);
  EXPECT_EQ(layout.patches[0].defect, TopologyDefect::kNone);
  EXPECT_EQ(d.layout({true, false}).patches[0].defect, TopologyDefect::kDangling);
}

TEST(ExtractLayout, SeveralDartsMayHangAtOnePatch) {
  const Drawing d = drawn("A|A|AA/AAAA/AA|AA");
  const PatchLayout layout = d.layout();
  expect_consistent(d, layout);
  ASSERT_EQ(layout.patches.size(), 1u);
  EXPECT_EQ(layout.patches[0].defect, TopologyDefect::kNone);
  EXPECT_EQ(std::count_if(layout.arches.begin(), layout.arches.end(),
                          [](const Arch& a) { return a.left == a.right; }),
            3);
}

TEST(ExtractLayout, WithoutDartsASlitThatEndsInsideIsDangling) {
  const Drawing d = drawn("AA|AA/AAAA");
  EXPECT_EQ(d.layout({true, false}).patches[0].defect, TopologyDefect::kDangling);
  EXPECT_NE(d.layout({false, true}).patches[0].defect, TopologyDefect::kNone) << "it is a seam with itself";
}

TEST(ExtractLayout, CreasesAndDrawnSeamsThatEndInsideAreDangling) {
  for (PathKind kind : {PathKind::kCrease, PathKind::kDrawn}) {
    const Drawing d = held(drawn("AA|AA/AAAA"), kind);
    for (bool darts : {true, false})
      EXPECT_EQ(d.layout({true, darts}).patches[0].defect, TopologyDefect::kDangling) << int(kind) << darts;
  }
}

TEST(ExtractLayout, SlitThatHangsNowhereIsNoDart) {
  const Drawing d = drawn("AAAA/AA|AA/AAAA");
  const PatchLayout layout = d.layout();
  ASSERT_EQ(layout.patches.size(), 1u);
  EXPECT_EQ(layout.patches[0].loops, 2);
  EXPECT_EQ(layout.patches[0].defect, TopologyDefect::kNotADisk);
}

TEST(ExtractLayout, TubeGluedToItselfIsADisk) {
  const Drawing d = drawn("AAAA/AAAA", tube(4));
  EXPECT_EQ(d.layout().patches[0].defect, TopologyDefect::kNotADisk) << "without a seam it is a ring";
  const Drawing seam = drawn("AAAA|/AAAA|", tube(4));
  const PatchLayout layout = seam.layout();
  expect_consistent(seam, layout);
  ASSERT_EQ(layout.patches.size(), 1u);
  const Patch& patch = layout.patches[0];
  EXPECT_EQ(patch.defect, TopologyDefect::kNone);
  ASSERT_EQ(patch.boundary.size(), 4u);
  EXPECT_EQ(layout.arches.size(), 3u);  // two rims, one seam
  int both = 0;
  for (const Arch& a : layout.arches) both += a.left == 0 && a.right == 0;
  EXPECT_EQ(both, 1);
  std::map<int, std::set<bool>> directions;
  for (const ArchUse& use : patch.boundary) directions[use.arch].insert(use.forward);
  for (const auto& [arch, ways] : directions)
    EXPECT_EQ(ways.size(), layout.arches[arch].left == layout.arches[arch].right ? 2u : 1u);
}

TEST(ExtractLayout, SeamsWithItselfCanBeForbidden) {
  const Drawing d = drawn("AAAA|/AAAA|", tube(4));
  EXPECT_EQ(d.layout({false}).patches[0].defect, TopologyDefect::kSelfSeam);
  const Drawing halves = drawn("AABB", tube(4));
  for (const Patch& p : halves.layout({false}).patches) EXPECT_EQ(p.defect, TopologyDefect::kNone);
}

TEST(ExtractLayout, TorusOfFourSheets) {
  const Drawing d = drawn("AABB/CCDD", torus(4, 2));
  const PatchLayout layout = d.layout();
  expect_consistent(d, layout);
  EXPECT_EQ(layout.patches.size(), 4u);
  EXPECT_EQ(node_count(layout), 4);
  EXPECT_EQ(layout.arches.size(), 8u);
  EXPECT_EQ(euler(layout), 0);
  for (const Patch& p : layout.patches) {
    EXPECT_EQ(p.defect, TopologyDefect::kNone);
    EXPECT_EQ(p.boundary.size(), 4u);
  }
}

TEST(ExtractLayout, ClosedArchStartsAtItsLowestVertexTowardsItsLowerNeighbour) {
  Canvas canvas;
  canvas.one_path = true;
  const Drawing d = drawn("AAA/ABA/AAA", canvas);
  const PatchLayout layout = d.layout();
  expect_consistent(d, layout);
  const Patch& b = layout.patches[d.patch_of(layout, 'B')];
  ASSERT_EQ(b.boundary.size(), 1u);
  const Arch& arch = layout.arches[b.boundary[0].arch];
  ASSERT_TRUE(arch.closed());
  EXPECT_NEAR(arch.length, 4, 1e-12);
  EXPECT_EQ(arch.vertices.front(), *std::min_element(arch.vertices.begin(), arch.vertices.end()));
  EXPECT_LT(arch.vertices[1], arch.vertices[arch.vertices.size() - 2]);
}

TEST(ExtractLayout, OpenArchStartsAtItsLowerEnd) {
  const Drawing d = drawn("AAB/AAC/DDD");
  for (const Arch& a : d.layout().arches) EXPECT_TRUE(a.closed() || a.vertices.front() < a.vertices.back());
}

TEST(ExtractLayout, LoopThroughOneNodeIsAClosedArchThatStartsThere) {
  // The seam meets both rims once: each rim is a closed arch from that node to itself.
  const Drawing d = drawn("AAAA|/AAAA|", tube(4));
  const PatchLayout layout = d.layout();
  int rims = 0;
  for (const Arch& a : layout.arches) {
    if (!a.closed()) continue;
    ++rims;
    EXPECT_TRUE(layout.node[a.vertices.front()]);
  }
  EXPECT_EQ(rims, 2);
}

TEST(ExtractLayout, KeysChangeWithTheVersionsOfTheOutline) {
  Drawing d = drawn("AAB/AAC");
  const PatchLayout before = d.layout();
  ++d.versions[d.mesh.edges[d.line(2, 0, 2, 1)[1]].v0];  // inside the arch between A and B
  const PatchLayout after = d.layout();
  const auto same = [&](char letter) {
    return before.patches[d.patch_of(before, letter)].key == after.patches[d.patch_of(after, letter)].key;
  };
  EXPECT_FALSE(same('A'));
  EXPECT_FALSE(same('B'));
  EXPECT_TRUE(same('C'));
  int changed = 0;
  for (std::size_t a = 0; a < before.arches.size(); ++a)
    changed += before.arches[a].key != after.arches[a].key;
  EXPECT_EQ(changed, 1);
}

TEST(ExtractLayout, KeysChangeWithTheVersionsInside) {
  Drawing d = drawn("AAB/AAC");
  const PatchLayout before = d.layout();
  std::vector<int> inner;
  for (int v = 0; v < d.mesh.vertex_count(); ++v)
    if (before.node[v] == PatchLayout::kNone && network_degree(d.mesh, d.network, v) == 0) inner.push_back(v);
  for (int v : inner) {
    ++d.versions[v];
    const PatchLayout after = d.layout();
    int changed = 0;
    for (std::size_t p = 0; p < before.patches.size(); ++p)
      changed += before.patches[p].key != after.patches[p].key;
    EXPECT_EQ(changed, 1);
    for (std::size_t a = 0; a < before.arches.size(); ++a)
      EXPECT_EQ(before.arches[a].key, after.arches[a].key);
    --d.versions[v];
  }
  EXPECT_FALSE(inner.empty());
}

TEST(ExtractLayout, KeysOfDifferentPatchesDiffer) {
  const Drawing d = drawn("ABCD/EFGH/AABB/CDCD");
  const PatchLayout layout = d.layout();
  std::set<std::uint64_t> patches, arches;
  for (const Patch& p : layout.patches) patches.insert(p.key);
  for (const Arch& a : layout.arches) arches.insert(a.key);
  EXPECT_EQ(patches.size(), layout.patches.size());
  EXPECT_EQ(arches.size(), layout.arches.size());
}

TEST(ExtractLayout, OneLoopWithoutNodesBoundsTwoPatchesWithDifferentKeys) {
  Canvas canvas;
  canvas.one_path = true;
  // Both sides of a closed curve on a torus tube: same outline, other side.
  const Drawing d = drawn("AAA/BBB", torus(3, 2));
  const PatchLayout layout = d.layout();
  ASSERT_EQ(layout.patches.size(), 2u);
  EXPECT_NE(layout.patches[0].key, layout.patches[1].key);
}

class Drawings : public ::testing::TestWithParam<const char*> {};
TEST_P(Drawings, AreConsistentAndEulerHolds) {
  const Drawing d = drawn(GetParam());
  const PatchLayout layout = d.layout();
  expect_consistent(d, layout);
  bool disks = true;
  for (const Patch& p : layout.patches) disks &= p.loops == 1;
  const int chi = d.mesh.vertex_count() - d.mesh.edge_count() + d.mesh.face_count();
  if (disks) {
    EXPECT_EQ(euler(layout), chi);
  }
}
INSTANTIATE_TEST_SUITE_P(Some, Drawings,
                         ::testing::Values("A", "AB", "A/B", "AB/CD", "AAB/CAB/CDD", "A.B/ACB",
                                           "AAAA/BCCB/BCCB/DDDD", "ABC/DEF/GHI", "AAAB/CDDB/CDDB/CEEE",
                                           "..A../.BBB./CCDCC/.EEE./..F..", "AAA/A.A/AAA", "ABA/BAB/ABA"));

void expect_same(const PatchLayout& a, const PatchLayout& b) {
  EXPECT_EQ(a.face_patch, b.face_patch);
  EXPECT_EQ(a.edge_arch, b.edge_arch);
  EXPECT_EQ(a.node, b.node);
  EXPECT_EQ(a.versions, b.versions);
  ASSERT_EQ(a.arches.size(), b.arches.size());
  for (std::size_t i = 0; i < a.arches.size(); ++i) {
    const Arch &x = a.arches[i], &y = b.arches[i];
    EXPECT_EQ(x.vertices, y.vertices);
    EXPECT_EQ(x.edges, y.edges);
    EXPECT_TRUE(x.path == y.path && x.left == y.left && x.right == y.right && x.length == y.length &&
                x.key == y.key);
  }
  ASSERT_EQ(a.patches.size(), b.patches.size());
  for (std::size_t p = 0; p < a.patches.size(); ++p) {
    const Patch &x = a.patches[p], &y = b.patches[p];
    EXPECT_EQ(x.faces, y.faces);
    EXPECT_EQ(x.outline, y.outline);
    ASSERT_EQ(x.boundary.size(), y.boundary.size());
    for (std::size_t i = 0; i < x.boundary.size(); ++i)
      EXPECT_TRUE(x.boundary[i].arch == y.boundary[i].arch && x.boundary[i].forward == y.boundary[i].forward);
    EXPECT_TRUE(x.loops == y.loops && x.defect == y.defect && x.area == y.area && x.key == y.key);
  }
}

// Seams come and go, change their path, vertices move: each layout follows from the one before.
TEST(ExtractLayout, FromTheOneBeforeItIsTheSame) {
  std::mt19937 random(3);
  const auto any = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  for (int drawing = 0; drawing < 12; ++drawing) {
    Canvas canvas = drawing % 3 == 0 ? torus(6, 4) : Canvas();
    canvas.steps = 2;
    Drawing d = drawn("ABBACC/AABCCC/DABBCA/DDDACA", canvas);
    PatchLayout layout = extract_layout(d.mesh, d.network, d.versions, {});
    int last_version = 0;
    for (int step = 0; step < 40; ++step) {
      const Arch& arch = layout.arches[any(static_cast<int>(layout.arches.size()))];
      const bool border = arch.left < 0 || arch.right < 0;
      const int change = any(4), other = any(static_cast<int>(d.network.kinds.size()));
      if (change == 0 && !border)
        for (int e : arch.edges) d.network.edge_path[e] = PathNetwork::kFree;
      if (change == 1 && !border)
        for (int e : arch.edges) d.network.edge_path[e] = other;
      if (change == 2)  // some may hang anywhere
        for (int k = 0; k < 3; ++k)
          if (int& path = d.network.edge_path[any(d.mesh.edge_count())]; path == PathNetwork::kFree)
            path = other;
      if (change == 3) {
        const int v = any(d.mesh.vertex_count());
        d.mesh.points[v] += Vector3(0.01, -0.02, 0.01), d.versions[v] = ++last_version;
      }
      layout = extract_layout(d.mesh, d.network, d.versions, {}, std::move(layout));
      expect_same(layout, extract_layout(d.mesh, d.network, d.versions, {}));
      if (layout.arches.empty()) break;
    }
    ASSERT_FALSE(HasFailure()) << "drawing " << drawing;
  }
}

}  // namespace
}  // namespace sheetform
