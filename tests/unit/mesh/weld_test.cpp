#include "sheetform/mesh/weld.h"

#include <gtest/gtest.h>

#include <random>

namespace sheetform {
namespace {

TEST(Weld, ExactClassesInOrderOfAppearance) {
  const std::vector<Vector3> p{{1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {-0.0, 0, 0}, {1, 0, 1e-300}};
  EXPECT_EQ(exact_classes(p), (std::vector<int>{0, 1, 0, 1, 2}));
}

// Small clusters on a coarse lattice: what is nearer than the distance must be joined, other clusters must
// not.
TEST(Weld, NearClassesJoinWhatIsNearAndNothingFar) {
  std::mt19937_64 rng(4);
  std::uniform_real_distribution<double> u(-1, 1);
  for (double distance : {1e-9, 1e-3}) {
    std::vector<Vector3> p;
    std::vector<int> cluster;
    for (int i = 0; i < 600; ++i) {
      const int c = static_cast<int>(rng() % 64);
      cluster.push_back(c);
      p.push_back(20 * distance * Vector3(c % 4, c / 4 % 4, c / 16) +
                  distance * Vector3(u(rng), u(rng), u(rng)));
    }
    const std::vector<int> id = near_classes(p, distance);
    for (std::size_t i = 0; i < p.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_TRUE((p[i] - p[j]).norm() > distance || id[i] == id[j]);
        EXPECT_TRUE(cluster[i] == cluster[j] || id[i] != id[j]);
      }
  }
}

TEST(Weld, ManyPointsAtNearlyOnePlaceAreNoProblem) {
  std::vector<Vector3> p(200000, Vector3(1, 1, 1));
  for (std::size_t i = 0; i < p.size(); ++i) p[i].x() += 1e-15 * static_cast<double>(i);
  p.emplace_back(2, 2, 2);
  const std::vector<int> id = near_classes(p, 1e-9);
  EXPECT_EQ(id[p.size() - 2], 0);
  EXPECT_EQ(id.back(), 1);
}

TEST(Weld, MergingRenumbersFaces) {
  std::vector<Vector3> p{{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 1, 0}};
  std::vector<std::array<int, 3>> f{{0, 1, 3}, {2, 3, 1}};
  EXPECT_EQ(merge_classes(exact_classes(p), p, f), 3);
  EXPECT_EQ(f, (std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 2, 1}}));
  EXPECT_EQ(p[2], Vector3(0, 1, 0));
}

}  // namespace
}  // namespace sheetform
