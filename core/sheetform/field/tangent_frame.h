// Tangent frames at vertices and the parallel transport between them (method.md 2.3).
#pragma once
#include <complex>
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// A right-handed orthonormal frame; tangent vectors are complex numbers in it (x + iy).
struct TangentFrame {
  Vector3 x, y, normal;
  /// Coordinates of the tangential part of `w`.
  std::complex<double> to_complex(const Vector3& w) const { return {w.dot(x), w.dot(y)}; }
  Vector3 to_vector(const std::complex<double>& z) const { return x * z.real() + y * z.imag(); }
};

/// A frame for a unit normal; x is the projected coordinate axis that is least aligned with it.
TangentFrame tangent_frame(const Vector3& normal);
std::vector<TangentFrame> tangent_frames(const std::vector<Vector3>& normals);

/// Rotates w by the smallest rotation that takes unit `from` to unit `to`. Opposite normals: w is returned as
/// is.
Vector3 transport(const Vector3& w, const Vector3& from, const Vector3& to);

/// The unit number r such that a tangent vector z of frame a, carried to frame b, is r * z.
std::complex<double> transport_factor(const TangentFrame& a, const TangentFrame& b);

/// Product of two complex numbers by the school formula (std::complex checks for infinities, which costs 3
/// x).
inline std::complex<double> mul(const std::complex<double>& a, const std::complex<double>& b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}
/// Fourth power of z / |z|: the same for all four directions of a cross. Zero for z = 0.
std::complex<double> unit_fourth_power(const std::complex<double>& z);

}  // namespace sheetform
