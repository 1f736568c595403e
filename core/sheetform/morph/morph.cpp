#include "sheetform/morph/morph.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

namespace sheetform {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

// One product of coefficients and the slot of the matrix that it goes to.
struct Term {
  int slot;
  double factor;
};

// Places of a lower triangle that is assembled from many small products: equal places share a slot, columns
// follow each other, rows ascend in each.
class LowerPattern {
 public:
  explicit LowerPattern(int n) : n_(n) {}
  void add(int row, int column) { places_.emplace_back(row, column); }

  // The matrix, all zero, and the slot of every place in the order of add().
  std::pair<Sparse, std::vector<int>> build() const {
    const std::vector<int> by_row = ordered(all(), [](const Place& p) { return p.first; });
    const std::vector<int> order = ordered(by_row, [](const Place& p) { return p.second; });
    std::vector<int> slot(places_.size()), rows;
    Sparse matrix(n_, n_);
    int* begin = matrix.outerIndexPtr();
    int column = -1;
    for (std::size_t i = 0; i < order.size(); ++i) {
      const Place& place = places_[order[i]];
      if (i == 0 || place != places_[order[i - 1]]) {
        for (; column < place.second; begin[column] = static_cast<int>(rows.size())) ++column;
        rows.push_back(place.first);
      }
      slot[order[i]] = static_cast<int>(rows.size()) - 1;
    }
    for (; column < n_; begin[column] = static_cast<int>(rows.size())) ++column;
    matrix.resizeNonZeros(static_cast<int>(rows.size()));
    std::copy(rows.begin(), rows.end(), matrix.innerIndexPtr());
    std::fill_n(matrix.valuePtr(), rows.size(), 0.0);
    return {std::move(matrix), std::move(slot)};
  }

 private:
  using Place = std::pair<int, int>;
  std::vector<int> all() const {
    std::vector<int> ids(places_.size());
    std::iota(ids.begin(), ids.end(), 0);
    return ids;
  }
  // Stable, by a key in [0, n).
  template <class Key>
  std::vector<int> ordered(const std::vector<int>& ids, const Key& key) const {
    std::vector<int> next(n_ + 1, 0), out(ids.size());
    for (int id : ids) ++next[key(places_[id]) + 1];
    std::partial_sum(next.begin(), next.end(), next.begin());
    for (int id : ids) out[next[key(places_[id])]++] = id;
    return out;
  }

  int n_;
  std::vector<Place> places_;
};

// Normal equations with a fixed pattern: only the weights of the samples change between rounds.
class NormalEquations {
 public:
  NormalEquations(const MorphProblem& problem, const MorphParams& params)
      : problem_(problem), params_(params), n_(static_cast<int>(problem.rest.size())) {
    double total = 0;
    for (const MorphSample& s : problem.samples) total += s.weight;
    unit_ = std::max(total, 1e-12) / std::max(n_, 1);
    LowerPattern pattern(n_);
    for (const MorphSample& s : problem.samples) {
      if (s.weight > 0) add_products(s.unknown, s.coefficient, 1, pattern, sample_terms_);
      end_of_terms_.push_back(sample_terms_.size());
    }
    lasting_rhs_ = Eigen::MatrixX3d::Zero(n_, 3);
    std::vector<Term> lasting;
    for (const auto& t : problem.stencils) add_stencil(t, params_.smooth * unit_, true, pattern, lasting);
    if (params_.bend > 0)
      for (const auto& t : problem.bends) add_stencil(t, params_.bend * unit_, false, pattern, lasting);
    for (int i = 0; i < n_; ++i) {
      const double w = problem_.anchor[i] * unit_;
      pattern.add(i, i);
      lasting.push_back({0, w});
      lasting_rhs_.row(i) += w * problem_.rest[i].transpose();
    }
    std::vector<int> slot;
    std::tie(matrix_, slot) = pattern.build();
    for (std::size_t i = 0; i < sample_terms_.size(); ++i) sample_terms_[i].slot = slot[i];
    lasting_.assign(matrix_.nonZeros(), 0);
    for (std::size_t i = 0; i < lasting.size(); ++i)
      lasting_[slot[sample_terms_.size() + i]] += lasting[i].factor;
    solver_.analyzePattern(matrix_);
  }

  std::vector<Vector3> solve(const std::vector<double>& weight, const std::vector<Vector3>& target) {
    double* value = matrix_.valuePtr();
    std::copy(lasting_.begin(), lasting_.end(), value);
    Eigen::MatrixX3d rhs = lasting_rhs_;
    std::size_t term = 0;
    for (std::size_t i = 0; i < problem_.samples.size(); ++i) {
      if (end_of_terms_[i] == term) continue;  // only measured
      for (; term < end_of_terms_[i]; ++term)
        value[sample_terms_[term].slot] += weight[i] * sample_terms_[term].factor;
      const MorphSample& s = problem_.samples[i];
      for (int a = 0; a < 3; ++a)
        if (s.coefficient[a] != 0)
          rhs.row(s.unknown[a]) += weight[i] * s.coefficient[a] * target[i].transpose();
    }
    solver_.factorize(matrix_);
    Eigen::MatrixX3d x = solver_.solve(rhs);
    if (!problem_.on_plane.empty()) x.col(0) = solve_across(matrix_, rhs.col(0));
    std::vector<Vector3> position(n_);
    for (int i = 0; i < n_; ++i) position[i] = x.row(i);
    return position;
  }

 private:
  // The coordinate across the plane of symmetry: that of points on it is 0, so their rows drop out.
  Eigen::VectorXd solve_across(Sparse matrix, Eigen::VectorXd right) {
    const std::vector<char>& fixed = problem_.on_plane;
    for (int column = 0; column < n_; ++column)
      for (Sparse::InnerIterator it(matrix, column); it; ++it)
        if (fixed[column] || fixed[it.row()]) it.valueRef() = it.row() == column ? 1 : 0;
    solver_.factorize(matrix);
    for (int i = 0; i < n_; ++i)
      if (fixed[i]) right[i] = 0;
    return solver_.solve(right);
  }
  // weight * c c^T over these unknowns.
  static void add_products(const std::array<int, 3>& unknown, const std::array<double, 3>& c, double weight,
                           LowerPattern& pattern, std::vector<Term>& terms) {
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        if (unknown[a] < unknown[b] || c[a] == 0 || c[b] == 0) continue;
        pattern.add(unknown[a], unknown[b]);
        terms.push_back({0, weight * c[a] * c[b]});
      }
  }
  // The middle point against the line between its neighbours.
  void add_stencil(const std::array<int, 3>& t, double w, bool relative, LowerPattern& pattern,
                   std::vector<Term>& terms) {
    const std::vector<Vector3>& rest = problem_.rest;
    const double before = std::max((rest[t[1]] - rest[t[0]]).norm(), 1e-12),
                 after = std::max((rest[t[2]] - rest[t[1]]).norm(), 1e-12);
    const std::array<double, 3> c{after / (before + after), -1, before / (before + after)};
    if (params_.spacing > 0) {
      const double longer = std::max(before * after / (params_.spacing * params_.spacing), 1.0);
      w /= longer * longer;
    }
    add_products(t, c, w, pattern, terms);
    if (!relative) return;
    Vector3 value = Vector3::Zero();
    for (int a = 0; a < 3; ++a) value += c[a] * rest[t[a]];
    for (int a = 0; a < 3; ++a) lasting_rhs_.row(t[a]) += w * c[a] * value.transpose();
  }

  const MorphProblem& problem_;
  const MorphParams& params_;
  int n_;
  double unit_ = 1;
  std::vector<Term> sample_terms_;
  std::vector<std::size_t> end_of_terms_;  // per sample
  std::vector<double> lasting_;            // per slot: what does not change
  Eigen::MatrixX3d lasting_rhs_;
  Sparse matrix_;
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
