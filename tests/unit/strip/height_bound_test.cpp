#include "sheetform/strip/height_bound.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sheetform/mesh/closest_point.h"
#include "support/shapes.h"

namespace sheetform {
namespace {

using Corners = std::array<Vector3, 3>;

constexpr double kNoLimit = 1e9;

// A surface with what asks for its bounds.
struct Target {
  TriangleSoup soup;
  ClosestPointTree tree{soup.points, soup.faces};
  HeightBound heights{soup.points, soup.faces, tree.diagonal()};

  double bound(const Corners& t, double limit = kNoLimit) const {
    return heights(t, {face_at(t[0]), face_at(t[1]), face_at(t[2])}, limit);
  }
  int face_at(const Vector3& p) const { return tree.closest(p).face; }
  // The largest distance of a fine grid of points on the triangle.
  double seen(const Corners& t) const {
    constexpr int n = 24;
    double largest = 0;
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        const Vector3 p = (i * t[0] + j * t[1] + (n - i - j) * t[2]) / n;
        largest = std::max(largest, std::sqrt(tree.closest(p).squared_distance));
      }
    return largest;
  }
};

bool known(double bound) { return std::isfinite(bound); }

TEST(HeightBound, OfAParallelPlaneIsItsDistance) {
  const Target plane{shapes::plane(8)};
  const Corners t{Vector3(0.2, 0.2, 0.1), Vector3(0.8, 0.3, 0.1), Vector3(0.4, 0.9, 0.1)};
  EXPECT_NEAR(plane.bound(t), 0.1, 1e-12);
  EXPECT_NEAR(plane.bound({t[0], t[2], t[1]}), 0.1, 1e-12) << "seen from the other side";
  EXPECT_FALSE(known(plane.bound(t, 0.09)));
}

TEST(HeightBound, CountsWhatIsOverTheTriangleAlone) {
  TriangleSoup soup = shapes::plane(8);
  soup.points[9 * 7 + 2].z() += 5;  // a spike at (0.25, 0.875)
  const Target spiked{soup};
  const double beside =
      spiked.bound({Vector3(0.3, 0.1, 0.1), Vector3(0.9, 0.2, 0.1), Vector3(0.5, 0.7, 0.1)});
  EXPECT_NEAR(beside, 0.1, 1e-12);
  const double under =
      spiked.bound({Vector3(0.1, 0.6, 0.1), Vector3(0.6, 0.63, 0.1), Vector3(0.25, 0.97, 0.1)});
  EXPECT_NEAR(under, 4.9, 1e-12);
}

// No point is farther than is told, on any of many triangles near a surface that bends both ways; and what is
// told is of use: seldom above the true distance by more than the slope between the two explains.
TEST(HeightBound, IsNeverBelowTheDistance) {
  std::mt19937 random(7);
  const auto unit = [&] { return static_cast<double>(random() % 1000003) / 1000003; };
  for (const Target& target : {Target{shapes::torus(60, 30)}, Target{shapes::saddle(40)}}) {
    int told = 0;
    double excess = 0;
    for (int i = 0; i < 300; ++i) {
      const Vector3 around = target.soup.points[random() % target.soup.points.size()];
      Corners t;
      for (Vector3& p : t) p = around + 0.3 * Vector3(unit() - 0.5, unit() - 0.5, unit() - 0.5);
      for (Vector3& p : t) p = target.tree.closest(p).point + 0.05 * Vector3(unit(), unit(), unit());
      const double bound = target.bound(t), seen = target.seen(t);
      if (!known(bound)) continue;
      ++told;
      EXPECT_GE(bound, seen - 1e-12);
      excess += bound / seen;
    }
    EXPECT_GT(told, 100);
    EXPECT_LT(excess / told, 2);
  }
}

TEST(HeightBound, IsNotKnownWhereTheSurfaceEnds) {
  const Target plane{shapes::plane(8)};
  EXPECT_FALSE(known(plane.bound({Vector3(0.5, 0.2, 0.1), Vector3(1.01, 0.5, 0.1), Vector3(0.5, 0.8, 0.1)})));
  TriangleSoup soup = shapes::plane(8);
  soup.faces.erase(soup.faces.begin() + 2 * (8 * 4 + 4));
  const Target holed{soup};
  const Corners over{Vector3(0.2, 0.2, 0.1), Vector3(0.8, 0.3, 0.1), Vector3(0.5, 0.9, 0.1)};
  EXPECT_FALSE(known(holed.bound(over)));
  EXPECT_TRUE(known(plane.bound(over)));
}

TEST(HeightBound, IsNotKnownWhereFacesDoNotHangTogether) {
  const TriangleSoup plane = shapes::plane(8);
  TriangleSoup torn;  // each face with its own corners
  for (const auto& f : plane.faces) {
    const int n = static_cast<int>(torn.points.size());
    for (int v : f) torn.points.push_back(plane.points[v]);
    torn.faces.push_back({n, n + 1, n + 2});
  }
  const Corners t{Vector3(0.2, 0.2, 0.1), Vector3(0.8, 0.3, 0.1), Vector3(0.5, 0.9, 0.1)};
  EXPECT_FALSE(known(Target{torn}.bound(t)));
  TriangleSoup turned = plane;  // one of them shows its other side
  auto& f = turned.faces[2 * (8 * 4 + 4)];
  std::swap(f[0], f[1]);
  EXPECT_FALSE(known(Target{turned}.bound(t)));
}

// Over a pleat the sheet lies three times, once with its other side: it covers all, and its top counts.
TEST(HeightBound, OfAPleatIsItsTop) {
  const Target pleat{shapes::grid({12, 6}, [](double u, double v) {
    const double s = 3 * u;
    if (s < 1) return Vector3(0.6 * s, v, 0);
    if (s < 2) return Vector3(0.6 - 0.2 * (s - 1), v, 0.1 * (s - 1));
    return Vector3(0.4 + 0.6 * (s - 2), v, 0.1);
  })};
  EXPECT_NEAR(pleat.bound({Vector3(0.2, 0.3, -0.05), Vector3(0.8, 0.3, -0.05), Vector3(0.5, 0.7, -0.05)}),
              0.15, 1e-12);
}

TEST(HeightBound, IsNotKnownBeyondAFold) {
  const Target folded{shapes::grid({20, 10}, [](double u, double v) {
    return u < 0.5 ? Vector3(2 * u, v, 0) : Vector3(2 - 2 * u, v, 0.2 * (u - 0.5));
  })};
  EXPECT_FALSE(
      known(folded.bound({Vector3(0.3, 0.3, -0.05), Vector3(1.2, 0.3, -0.05), Vector3(0.5, 0.7, -0.05)})));
  EXPECT_NEAR(folded.bound({Vector3(0.3, 0.3, -0.05), Vector3(0.7, 0.3, -0.05), Vector3(0.5, 0.7, -0.05)}),
              0.05, 1e-12)
      << "the other leaf is of no account";
}

TEST(HeightBound, IsLeftToSplitsWhereFacesAreTooMany) {
  const Target plane{shapes::plane(100)};
  const auto of_size = [&](double s) {
    return plane.bound({Vector3(0.1, 0.1, 0.1), Vector3(0.1 + s, 0.1, 0.1), Vector3(0.1, 0.1 + s, 0.1)});
  };
  EXPECT_TRUE(known(of_size(0.05)));
  EXPECT_FALSE(known(of_size(0.8)));
}

TEST(HeightBound, OfANeedleIsNotKnown) {
  const Target plane{shapes::plane(8)};
  EXPECT_FALSE(known(plane.bound({Vector3(0.2, 0.2, 0.1), Vector3(0.4, 0.4, 0.1), Vector3(0.6, 0.6, 0.1)})));
  EXPECT_FALSE(known(plane.bound({Vector3(0.2, 0.2, 0.1), Vector3(0.2, 0.2, 0.1), Vector3(0.2, 0.2, 0.1)})));
}

}  // namespace
}  // namespace sheetform
