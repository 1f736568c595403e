#include "sheetform/search/fair_outlines.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

namespace sheetform {
namespace {

constexpr double kWavelength = 0.2;  // of a diagonal: shorter waves go
// Points that patches want closer to where they were have so many times the weight, in as many steps as there
// are, and stay after the last.
constexpr double kHold = 30;
constexpr int kMostSteps = 5;
constexpr double kTurned = 0.3;  // cosine of the angle that a triangle may turn by

// Where the points of a curve lie along it.
std::vector<double> stations(const std::vector<Vector3>& line) {
  std::vector<double> at(line.size(), 0);
  for (std::size_t i = 1; i < line.size(); ++i)
    at[i] = at[i - 1] + std::max((line[i] - line[i - 1]).norm(), 1e-9);
  return at;
}

// Factors of four values at these places that give the third derivative of the cubic through them.
std::array<double, 4> third_derivative(const double* at) {
  std::array<double, 4> c{};
  for (int i = 0; i < 4; ++i) {
    c[i] = 6;
    for (int j = 0; j < 4; ++j)
      if (j != i) c[i] /= at[i] - at[j];
  }
  return c;
}

Vector3 normal_of(const StripSource::Patch& patch, const std::array<int, 3>& t,
                  const std::vector<Vector3>& points) {
  const Vector3 &a = points[patch.outline[t[0]]], &b = points[patch.outline[t[1]]],
                &c = points[patch.outline[t[2]]];
  return (b - a).cross(c - a).normalized();
}

}  // namespace

// Least squares of displacement plus third derivative: waves of this length are halved, and one of twice that
// length keeps 98 %.
std::vector<Vector3> faired(const std::vector<Vector3>& line, double wavelength,
                            const std::vector<double>& weight) {
  const int n = static_cast<int>(line.size());
  if (n < 4 || wavelength <= 0) return line;
  const std::vector<double> at = stations(line);
  const double stiffness = std::pow(wavelength / (2 * 3.14159265358979323846), 6);
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(n, 3);
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    const bool end = i == 0 || i == n - 1;
    const double w = end ? 1e8 * at.back() : weight[i] * (at[i + 1] - at[i - 1]) / 2;
    entries.emplace_back(i, i, w);
    right.row(i) = w * line[i].transpose();
  }
  for (int i = 0; i + 3 < n; ++i) {
    const std::array<double, 4> c = third_derivative(&at[i]);
    const double w = stiffness * (at[i + 3] - at[i]) / 3;
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < 4; ++b) entries.emplace_back(i + a, i + b, w * c[a] * c[b]);
  }
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  if (solver.info() != Eigen::Success) return line;
  const Eigen::MatrixX3d places = solver.solve(right);
  std::vector<Vector3> out = line;
  for (int i = 1; i + 1 < n; ++i) out[i] = places.row(i);
  return out;
}

OutlineFairing::OutlineFairing(const StripSource& source, const std::vector<char>& may_move, Allowed allowed)
    : source_(source),
      allowed_(std::move(allowed)),
      held_(source.points.size(), kMostSteps),
      arch_of_(source.points.size(), -1),
      points_(source.points) {
  for (std::size_t a = 0; a < may_move.size(); ++a) {
    const std::vector<int>& ids = source.arches[a].points;
    if (!may_move[a] || ids.size() < 4) continue;
    for (std::size_t i = 1; i + 1 < ids.size(); ++i)
      arch_of_[ids[i]] = static_cast<int>(a), held_[ids[i]] = 0;
  }
  for (std::size_t a = 0; a < may_move.size(); ++a) fair(static_cast<int>(a));
}

void OutlineFairing::fair(int arch) {
  const std::vector<int>& ids = source_.arches[arch].points;
  if (ids.size() < 4 || arch_of_[ids[1]] != arch) return;
  std::vector<Vector3> line;
  std::vector<double> weight;
  for (int i : ids) line.push_back(source_.points[i]), weight.push_back(std::pow(kHold, held_[i]));
  line = faired(line, kWavelength, weight);
  for (std::size_t i = 1; i + 1 < ids.size(); ++i)
    points_[ids[i]] = held_[ids[i]] < kMostSteps ? line[i] : source_.points[ids[i]];
}

bool OutlineFairing::hold(const std::vector<int>& points) {
  std::set<int> arches;
  for (int i : std::set<int>(points.begin(), points.end())) {
    if (held_[i] == kMostSteps) continue;
    ++held_[i];
    arches.insert(arch_of_[i]);
  }
  for (int a : arches) fair(a);
  return !arches.empty();
}

bool OutlineFairing::hold_outlines(const std::vector<int>& patches) {
  std::vector<int> points;
  for (int p : patches)
    points.insert(points.end(), source_.patches[p].outline.begin(), source_.patches[p].outline.end());
  return hold(points);
}

std::vector<int> OutlineFairing::astray() const {
  std::vector<int> points;
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (held_[i] < kMostSteps && !allowed_(source_.points[i], points_[i]))
      points.push_back(static_cast<int>(i));
  return points;
}

// Corners of triangles that are turned over.
std::vector<int> OutlineFairing::turned_over() const {
  std::vector<int> points;
  for (const StripSource::Patch& patch : source_.patches)
    for (const auto& t : patch.triangles)
      if (normal_of(patch, t, points_).dot(normal_of(patch, t, source_.points)) < kTurned)
        for (int corner : t) points.push_back(patch.outline[corner]);
  return points;
}

std::vector<Vector3> OutlineFairing::places() {
  while (hold(astray()) || hold(turned_over())) {
  }
  return points_;
}

}  // namespace sheetform
