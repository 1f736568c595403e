#include "sheetform/strip/topology.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace sheetform {
namespace {

// Against a map, on any triangles: edges of many faces, faces that name a vertex twice, vertices of none.
TEST(EdgeTable, HasEveryUseOfEveryEdgeInOrder) {
  std::mt19937 random(3);
  for (int vertices : {1, 4, 12, 60}) {
    std::vector<Triple> faces(40);
    for (Triple& t : faces)
      for (int& v : t) v = static_cast<int>(random() % vertices);
    std::map<std::pair<int, int>, std::vector<std::array<int, 3>>> known;
    for (int f = 0; f < 40; ++f)
      for (int k = 0; k < 3; ++k) {
        const int a = faces[f][k], b = faces[f][(k + 1) % 3];
        known[{std::min(a, b), std::max(a, b)}].push_back({a, b, f});
      }
    const EdgeTable table(faces);
    ASSERT_EQ(table.edges.size(), known.size());
    auto edge = table.edges.begin();
    for (const auto& [ends, uses] : known) {
      EXPECT_EQ(std::pair(edge->a, edge->b), ends);
      std::vector<std::array<int, 3>> found;
      for (int k = 0; k < edge->count; ++k) {
        const EdgeTable::Use& u = table.use(*edge, k);
        found.push_back({u.a, u.b, u.face});
      }
      EXPECT_EQ(found, uses);
      EXPECT_EQ(table.find(ends.second, ends.first), edge - table.edges.begin());
      ++edge;
    }
  }
  EXPECT_TRUE(EdgeTable(std::vector<Triple>{}).edges.empty());
}

}  // namespace
}  // namespace sheetform
