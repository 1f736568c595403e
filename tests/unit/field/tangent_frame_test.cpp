#include "sheetform/field/tangent_frame.h"

#include <gtest/gtest.h>

namespace sheetform {
namespace {

TEST(TangentFrame, IsRightHandedAndOrthonormal) {
  for (const Vector3& raw : {Vector3(0, 0, 1), Vector3(1, -2, 3), Vector3(-1, 0, 0), Vector3(1, 1, 1)}) {
    const TangentFrame f = tangent_frame(raw.normalized());
    EXPECT_NEAR((f.x.cross(f.y) - f.normal).norm(), 0, 1e-14);
    EXPECT_NEAR(f.x.norm(), 1, 1e-14);
  }
}

TEST(Transport, TakesNormalToNormalAndKeepsTheAxis) {
  const Vector3 a = Vector3(1, 2, 3).normalized(), b = Vector3(-1, 1, 2).normalized();
  EXPECT_NEAR((transport(a, a, b) - b).norm(), 0, 1e-14);
  const Vector3 axis = a.cross(b);
  EXPECT_NEAR((transport(axis, a, b) - axis).norm(), 0, 1e-14);
}

TEST(Transport, FactorIsUnitAndInvertedByTheWayBack) {
  const TangentFrame a = tangent_frame(Vector3(1, 2, 3).normalized());
  const TangentFrame b = tangent_frame(Vector3(0.5, 2, -1).normalized());
  const std::complex<double> there = transport_factor(a, b), back = transport_factor(b, a);
  EXPECT_NEAR(std::abs(there), 1, 1e-14);
  EXPECT_NEAR(std::abs(there * back - 1.0), 0, 1e-13);
}

TEST(Transport, AroundAnOctantOfTheSphereTurnsByARightAngle) {
  const TangentFrame x = tangent_frame(Vector3::UnitX()), y = tangent_frame(Vector3::UnitY()),
                     z = tangent_frame(Vector3::UnitZ());
  const std::complex<double> turn = transport_factor(x, y) * transport_factor(y, z) * transport_factor(z, x);
  EXPECT_NEAR(std::abs(turn - std::complex<double>(0, 1)), 0, 1e-13);
}

TEST(UnitFourthPower, IsTheSameForAllDirectionsOfACross) {
  const std::complex<double> z(0.3, -2.1), i(0, 1);
  for (const auto& w : {z * i, -z, -z * i, 7.0 * z})
    EXPECT_NEAR(std::abs(unit_fourth_power(w) - unit_fourth_power(z)), 0, 1e-14);
  EXPECT_EQ(unit_fourth_power(0), std::complex<double>(0));
}

}  // namespace
}  // namespace sheetform
