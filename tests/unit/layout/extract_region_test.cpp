// The region of a layout must say the same as the whole: the search judges removals by regions alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <string>

#include "sheetform/layout/layout.h"
#include "support/drawing.h"

namespace sheetform {
namespace {

using shapes::Canvas;
using shapes::Drawing;
using shapes::drawn;

std::string random_drawing(std::mt19937& random, int columns, int rows) {
  std::string text;
  for (int j = 0; j < rows; ++j) {
    if (j > 0) text += '/';
    for (int i = 0; i < columns; ++i) text += static_cast<char>('A' + random() % 3);
  }
  return text;
}

// Arches by their key; keys of one layout differ.
std::map<std::uint64_t, const Arch*> by_key(const PatchLayout& layout) {
  std::map<std::uint64_t, const Arch*> arches;
  for (const Arch& a : layout.arches) arches[a.key] = &a;
  return arches;
}

void expect_same_side(int whole, int part, const PatchLayout& all, const PatchLayout& region,
                      const std::set<int>& chosen) {
  if (whole == Arch::kOutside) {
    EXPECT_EQ(part, Arch::kOutside);
  } else if (!chosen.count(whole)) {
    EXPECT_EQ(part, Arch::kUnknown);
  } else {
    ASSERT_GE(part, 0);
    EXPECT_EQ(all.patches[whole].key, region.patches[part].key);
  }
}

void expect_part_of(const PatchLayout& all, const PatchLayout& region, const std::set<int>& chosen) {
  EXPECT_EQ(region.patches.size(), chosen.size());
  for (int p : chosen) {
    const Patch& whole = all.patches[p];
    const int id = region.face_patch[whole.faces.front()];
    ASSERT_GE(id, 0);
    const Patch& part = region.patches[id];
    EXPECT_EQ(part.faces, whole.faces);
    EXPECT_EQ(part.key, whole.key);
    EXPECT_EQ(part.loops, whole.loops);
    EXPECT_EQ(part.defect, whole.defect);
    EXPECT_DOUBLE_EQ(part.area, whole.area);
    ASSERT_EQ(part.boundary.size(), whole.boundary.size());
    for (std::size_t i = 0; i < part.boundary.size(); ++i) {
      EXPECT_EQ(region.arches[part.boundary[i].arch].key, all.arches[whole.boundary[i].arch].key);
      EXPECT_EQ(part.boundary[i].forward, whole.boundary[i].forward);
    }
  }
  const auto arches = by_key(all);
  for (const Arch& a : region.arches) {
    ASSERT_TRUE(arches.count(a.key));
    const Arch& whole = *arches.at(a.key);
    EXPECT_EQ(a.vertices, whole.vertices);
    EXPECT_EQ(a.edges, whole.edges);
    EXPECT_EQ(a.path, whole.path);
    expect_same_side(whole.left, a.left, all, region, chosen);
    expect_same_side(whole.right, a.right, all, region, chosen);
  }
}

// The faces of the chosen patches and of those across their arches, ascending.
void expect_neighbours(const Drawing& d, const PatchLayout& all, const std::set<int>& chosen,
                       const std::vector<int>& found) {
  std::set<int> patches = chosen;
  for (const Arch& a : all.arches) {
    if (chosen.count(a.left) && a.right >= 0) patches.insert(a.right);
    if (chosen.count(a.right) && a.left >= 0) patches.insert(a.left);
  }
  std::vector<int> faces;
  for (int f = 0; f < d.mesh.face_count(); ++f)
    if (patches.count(all.face_patch[f])) faces.push_back(f);
  EXPECT_EQ(found, faces);
}

void expect_regions_agree(const Drawing& d, std::mt19937& random) {
  const PatchLayout all = d.layout();
  for (int trial = 0; trial < 4; ++trial) {
    std::set<int> chosen;
    std::vector<int> faces;
    const int wanted = 1 + static_cast<int>(random() % std::min<std::size_t>(4, all.patches.size()));
    while (static_cast<int>(chosen.size()) < wanted)
      chosen.insert(static_cast<int>(random() % all.patches.size()));
    for (int p : chosen) faces.insert(faces.end(), all.patches[p].faces.begin(), all.patches[p].faces.end());
    std::shuffle(faces.begin(), faces.end(), random);  // the order of the faces decides nothing
    expect_part_of(all, extract_region(d.mesh, d.network, d.versions, {}, faces), chosen);
    expect_neighbours(d, all, chosen, with_neighbours(d.mesh, d.network, faces));
  }
}

TEST(ExtractRegion, AgreesWithTheWholeOnRandomDrawings) {
  std::mt19937 random(7);
  for (int drawing = 0; drawing < 60; ++drawing) {
    Canvas canvas;
    canvas.steps = 2;
    canvas.one_path = drawing % 3 == 0;  // closed arches without nodes
    const Drawing d = drawn(random_drawing(random, 6, 5), canvas);
    expect_regions_agree(d, random);
    if (HasFailure()) {
      ADD_FAILURE() << "drawing " << drawing;
      return;
    }
  }
}

TEST(ExtractRegion, AgreesWithTheWholeOnATorus) {
  std::mt19937 random(11);
  for (int drawing = 0; drawing < 20; ++drawing) {
    Canvas canvas;
    canvas.steps = 2;
    canvas.roll = canvas.close = true;
    canvas.place = [](double x, double y) {
      const double a = x * 2 * 3.14159265358979 / 5, b = y * 2 * 3.14159265358979 / 4;
      return Vector3((2 + std::cos(b)) * std::cos(a), (2 + std::cos(b)) * std::sin(a), std::sin(b));
    };
    expect_regions_agree(drawn(random_drawing(random, 5, 4), canvas), random);
  }
}

TEST(ExtractRegion, TheWholeIsARegion) {
  const Drawing d = drawn("AAB/AAC");
  std::vector<int> faces(d.mesh.faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) faces[f] = static_cast<int>(f);
  const PatchLayout all = d.layout(), region = extract_region(d.mesh, d.network, d.versions, {}, faces);
  EXPECT_EQ(region.face_patch, all.face_patch);
  EXPECT_EQ(region.edge_arch, all.edge_arch);
  EXPECT_EQ(region.node, all.node);
}

}  // namespace
}  // namespace sheetform
