#include "sheetform/mesh/far_vertices.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "sheetform/base/error.h"
#include "support/shapes.h"

namespace sheetform {
namespace {

struct Pair {
  TriangleSoup soup;
  ClosestPointTree own, to;
};

// A fine torus against a coarse one, with a dent of depth 0.5 around the vertices near (x, 0, 0).
Pair dented_torus() {
  Pair pair;
  pair.soup = shapes::torus(96, 48);
  for (Vector3& p : pair.soup.points)
    if ((p - Vector3(1.4, 0, 0)).norm() < 0.2) p.z() += 0.5;
  const TriangleSoup coarse = shapes::torus(64, 32);
  pair.own = ClosestPointTree(pair.soup.points, pair.soup.faces);
  pair.to = ClosestPointTree(coarse.points, coarse.faces);
  return pair;
}

TEST(FarVertices, HoldsAllThatAreFarther) {
  const Pair pair = dented_torus();
  for (double limit : {0.0, 0.01, 0.1, 0.3, 0.45, 1.0}) {
    std::vector<char> listed(pair.soup.points.size(), 0);
    for (const FarVertex& v : far_vertices(pair.soup.faces, pair.own, pair.to, limit, {})) {
      EXPECT_FALSE(listed[v.vertex]) << "twice";
      listed[v.vertex] = 1;
      const auto& face = pair.soup.faces[v.face];
      EXPECT_NE(std::find(face.begin(), face.end(), v.vertex), face.end());
    }
    for (std::size_t v = 0; v < listed.size(); ++v) {
      const bool far = pair.to.closest(pair.soup.points[v]).squared_distance > limit * limit;
      EXPECT_TRUE(listed[v] || !far) << v;
    }
  }
}

TEST(FarFaces, HoldsAllWithAFarPoint) {
  const Pair pair = dented_torus();
  for (double limit : {0.0, 0.01, 0.3}) {
    const std::vector<int> far = far_faces(pair.own, pair.to, limit, {});
    EXPECT_TRUE(std::is_sorted(far.begin(), far.end()));
    for (int f = 0; f < static_cast<int>(pair.soup.faces.size()); ++f) {
      const auto& t = pair.soup.faces[f];
      const Vector3 middle = (pair.soup.points[t[0]] + pair.soup.points[t[1]] + pair.soup.points[t[2]]) / 3;
      const bool is_far = pair.to.closest(middle).squared_distance > limit * limit;
      EXPECT_TRUE(!is_far || std::binary_search(far.begin(), far.end(), f)) << f;
    }
  }
  EXPECT_TRUE(far_faces(pair.own, pair.to, 10, {}).empty());
}

TEST(FarVertices, PassesOverWhatIsNear) {
  const Pair pair = dented_torus();
  const auto n = pair.soup.points.size();
  EXPECT_LT(far_vertices(pair.soup.faces, pair.own, pair.to, 0.45, {}).size(), n / 8);
  EXPECT_TRUE(far_vertices(pair.soup.faces, pair.own, pair.to, 10, {}).empty());
}

TEST(FarVertices, NothingOfNothing) {
  EXPECT_TRUE(far_vertices({}, ClosestPointTree(), dented_torus().to, 0.1, {}).empty());
}

TEST(FarVertices, StopsWhenAsked) {
  const Pair pair = dented_torus();
  std::atomic<bool> cancelled{true};
  RunContext context;
  context.cancelled = &cancelled;
  EXPECT_THROW(far_vertices(pair.soup.faces, pair.own, pair.to, 0, context), Error);
}

}  // namespace
}  // namespace sheetform
