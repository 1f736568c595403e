#include "sheetform/field/tangent_frame.h"

#include <cmath>

namespace sheetform {

TangentFrame tangent_frame(const Vector3& normal) {
  int axis = 0;
  normal.cwiseAbs().minCoeff(&axis);
  const Vector3 x = (Vector3::Unit(axis) - normal * normal[axis]).normalized();
  return {x, normal.cross(x), normal};
}

std::vector<TangentFrame> tangent_frames(const std::vector<Vector3>& normals) {
  std::vector<TangentFrame> frames;
  frames.reserve(normals.size());
  for (const Vector3& n : normals) frames.push_back(tangent_frame(n));
  return frames;
}

Vector3 transport(const Vector3& w, const Vector3& from, const Vector3& to) {
  const double c = from.dot(to);
  if (c < -1 + 1e-9) return w;
  // Rodrigues with axis from x to, whose length is the sine: no normalisation, no angle needed.
  const Vector3 axis = from.cross(to);
  return c * w + axis.cross(w) + axis * (axis.dot(w) / (1 + c));
}

std::complex<double> transport_factor(const TangentFrame& a, const TangentFrame& b) {
  const std::complex<double> r = b.to_complex(transport(a.x, a.normal, b.normal));
  const double length = std::abs(r);
  return length > 1e-12 ? r / length : std::complex<double>(1, 0);
}

std::complex<double> unit_fourth_power(const std::complex<double>& z) {
  const double length2 = std::norm(z);
  if (length2 <= 0) return {0, 0};
  const std::complex<double> square = mul(z, z) / length2;
  return mul(square, square);
}

}  // namespace sheetform
