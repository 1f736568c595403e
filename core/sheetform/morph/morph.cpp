#include "sheetform/morph/morph.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace sheetform {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

// Normal equations with a fixed pattern: assembled into the same slots in every round.
class NormalEquations {
 public:
  NormalEquations(const MorphProblem& problem, const MorphParams& params)
      : problem_(problem), params_(params), n_(static_cast<int>(problem.rest.size())) {
    double total = 0;
    for (const MorphSample& s : problem.samples) total += s.weight;
    unit_ = std::max(total, 1e-12) / std::max(n_, 1);
  }

  std::vector<Vector3> solve(const std::vector<double>& weight, const std::vector<Vector3>& target) {
    triplets_.clear();
    rhs_ = Eigen::MatrixX3d::Zero(n_, 3);
    for (std::size_t s = 0; s < problem_.samples.size(); ++s)
      if (weight[s] > 0) add_sample(problem_.samples[s], weight[s], target[s]);
    for (const auto& t : problem_.stencils) add_stencil(t, params_.smooth * unit_, true);
    if (params_.bend > 0)
      for (const auto& t : problem_.bends) add_stencil(t, params_.bend * unit_, false);
    for (int i = 0; i < n_; ++i) {
      const double w = problem_.anchor[i] * unit_;
      triplets_.emplace_back(i, i, w);
      rhs_.row(i) += w * problem_.rest[i].transpose();
    }
    Sparse matrix(n_, n_);
    matrix.setFromTriplets(triplets_.begin(), triplets_.end());
    if (!analysed_) solver_.analyzePattern(matrix);
    analysed_ = true;
    solver_.factorize(matrix);
    Eigen::MatrixX3d x = solver_.solve(rhs_);
    if (!problem_.on_plane.empty()) x.col(0) = solve_across(matrix);
    std::vector<Vector3> position(n_);
    for (int i = 0; i < n_; ++i) position[i] = x.row(i);
    return position;
  }

 private:
  // The coordinate across the plane of symmetry: that of points on it is 0, so their rows drop out.
  Eigen::VectorXd solve_across(Sparse matrix) {
    const std::vector<char>& fixed = problem_.on_plane;
    for (int column = 0; column < n_; ++column)
      for (Sparse::InnerIterator it(matrix, column); it; ++it)
        if (fixed[column] || fixed[it.row()]) it.valueRef() = it.row() == column ? 1 : 0;
    solver_.factorize(matrix);
    Eigen::VectorXd right = rhs_.col(0);
    for (int i = 0; i < n_; ++i)
      if (fixed[i]) right[i] = 0;
    return solver_.solve(right);
  }
  void add(int i, int j, double v) {
    if (i >= j) triplets_.emplace_back(i, j, v);
  }
  void add_sample(const MorphSample& s, double w, const Vector3& target) {
    for (int a = 0; a < 3; ++a) {
      if (s.coefficient[a] == 0) continue;
      const double wa = w * s.coefficient[a];
      rhs_.row(s.unknown[a]) += wa * target.transpose();
      for (int b = 0; b < 3; ++b)
        if (s.coefficient[b] != 0) add(s.unknown[a], s.unknown[b], wa * s.coefficient[b]);
    }
  }
  // The middle point against the line between its neighbours.
  void add_stencil(const std::array<int, 3>& t, double w, bool relative) {
    const std::vector<Vector3>& rest = problem_.rest;
    const double before = std::max((rest[t[1]] - rest[t[0]]).norm(), 1e-12),
                 after = std::max((rest[t[2]] - rest[t[1]]).norm(), 1e-12);
    const std::array<double, 3> c{after / (before + after), -1, before / (before + after)};
    if (params_.spacing > 0) {
      const double longer = std::max(before * after / (params_.spacing * params_.spacing), 1.0);
      w /= longer * longer;
    }
    Vector3 value = Vector3::Zero();
    if (relative)
      for (int a = 0; a < 3; ++a) value += c[a] * rest[t[a]];
    for (int a = 0; a < 3; ++a) {
      rhs_.row(t[a]) += w * c[a] * value.transpose();
      for (int b = 0; b < 3; ++b) add(t[a], t[b], w * c[a] * c[b]);
    }
  }

  const MorphProblem& problem_;
  const MorphParams& params_;
  int n_;
  double unit_ = 1;
  bool analysed_ = false;
  std::vector<Eigen::Triplet<double>> triplets_;
  Eigen::MatrixX3d rhs_;
  Eigen::SimplicialLDLT<Sparse> solver_;
};

}  // namespace

MorphResult morph(const MorphProblem& problem, const MorphParams& params) {
  NormalEquations equations(problem, params);
  const std::size_t n = problem.samples.size();
  std::vector<double> weight(n), error(n, 0);
  std::vector<Vector3> target(n);
  for (std::size_t s = 0; s < n; ++s)
    weight[s] = problem.samples[s].weight, target[s] = problem.samples[s].target;
  MorphResult best;
  for (int round = 0; round <= params.rounds; ++round) {
    std::vector<Vector3> x = equations.solve(weight, target);
    double worst = 0, mean = 0, total = 0;
    for (std::size_t s = 0; s < n; ++s) {
      const MorphSample& sample = problem.samples[s];
      if (sample.weight <= 0) continue;
      const Vector3 offset = sample.at(x) - sample.target;
      const Vector3 tangential = offset - sample.normal * sample.normal.dot(offset);
      const Vector3 forgiven = params.slide * sample.slide * tangential;
      error[s] = (offset - forgiven).norm();
      target[s] = sample.target + forgiven;
      worst = std::max(worst, error[s]);
      mean += weight[s] * error[s], total += weight[s];
    }
    if (round == 0 || worst < best.max_error) best.position = std::move(x), best.max_error = worst;
    if (worst <= params.stop_below || total <= 0 || mean <= 0) break;
    mean /= total;
    for (std::size_t s = 0; s < n; ++s)
      if (problem.samples[s].weight > 0)
        weight[s] = std::max(weight[s] * error[s] / mean, 0.02 * problem.samples[s].weight);
  }
  return best;
}

}  // namespace sheetform
