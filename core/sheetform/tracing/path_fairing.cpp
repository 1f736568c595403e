#include "sheetform/tracing/path_fairing.h"

#include <Eigen/SparseCholesky>
#include <algorithm>

#include "sheetform/base/error.h"
#include "sheetform/field/tangent_frame.h"

namespace sheetform {
namespace {

using Matrix32 = Eigen::Matrix<double, 3, 2>;

Matrix32 tangents(const Vector3& normal) {
  const TangentFrame frame = tangent_frame(normal);
  Matrix32 m;
  m << frame.x, frame.y;
  return m;
}

// Normal equations of the energy in tangential coordinates, two unknowns a vertex.
class FairingSystem {
 public:
  FairingSystem(const std::vector<Vector3>& points, const std::vector<int>& slot,
                const std::vector<Vector3>& normal, double anchor)
      : points_(points),
        slot_(slot),
        rhs_(Eigen::VectorXd::Zero(2 * static_cast<Eigen::Index>(normal.size()))) {
    for (const Vector3& n : normal) frames_.push_back(tangents(n));
    for (int i = 0; i < rhs_.size(); ++i) entries_.emplace_back(i, i, anchor);
  }

  void add(const PathStencil& s) {
    const Vector3 residual = points_[s.at] - (points_[s.before] + points_[s.after]) / 2;
    const Matrix32& frame = frames_[slot_[s.at]];
    if (s.across_only) {
      const Vector3 along = points_[s.after] - points_[s.before];
      const Vector3 across = frame.col(0).cross(frame.col(1)).cross(along).normalized();
      add_row(s, across, residual);
      return;
    }
    add_row(s, frame.col(0), residual);
    add_row(s, frame.col(1), residual);
  }

  // Tangential coordinates, two for each movable vertex.
  Eigen::VectorXd solve() const {
    Eigen::SparseMatrix<double> matrix(rhs_.size(), rhs_.size());
    matrix.setFromTriplets(entries_.begin(), entries_.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
    if (solver.info() != Eigen::Success)
      throw Error(ErrorCode::kInternal, "the fairing matrix is not definite");
    return solver.solve(rhs_);
  }
  Vector3 move(int i, const Eigen::VectorXd& u) const { return frames_[i] * u.segment<2>(2 * i); }

 private:
  // direction . (x_at - (x_before + x_after) / 2), squared.
  void add_row(const PathStencil& s, const Vector3& direction, const Vector3& residual) {
    struct Term {
      int unknown;
      double value;
    };
    std::array<Term, 6> terms{};
    int count = 0;
    for (const auto& [v, factor] :
         {std::pair(s.at, 1.0), std::pair(s.before, -0.5), std::pair(s.after, -0.5)}) {
      if (slot_[v] < 0) continue;
      const Eigen::Vector2d value = factor * (frames_[slot_[v]].transpose() * direction);
      for (int k = 0; k < 2; ++k) terms[count++] = {2 * slot_[v] + k, value[k]};
    }
    const double constant = direction.dot(residual);
    for (int i = 0; i < count; ++i) {
      rhs_[terms[i].unknown] -= terms[i].value * constant;
      for (int j = 0; j < count; ++j)
        if (terms[i].unknown >= terms[j].unknown)
          entries_.emplace_back(terms[i].unknown, terms[j].unknown, terms[i].value * terms[j].value);
    }
  }

  const std::vector<Vector3>& points_;
  const std::vector<int>& slot_;
  std::vector<Matrix32> frames_;
  Eigen::VectorXd rhs_;
  std::vector<Eigen::Triplet<double>> entries_;
};

}  // namespace

std::vector<Vector3> fair_paths(const std::vector<Vector3>& points, const std::vector<int>& movable,
                                const std::vector<int>& slot, const std::vector<Vector3>& normal,
                                const std::vector<PathStencil>& stencils, double anchor) {
  FairingSystem system(points, slot, normal, anchor);
  for (const PathStencil& s : stencils) system.add(s);
  const Eigen::VectorXd u = system.solve();
  std::vector<Vector3> out;
  for (std::size_t i = 0; i < movable.size(); ++i)
    out.push_back(points[movable[i]] + system.move(static_cast<int>(i), u));
  return out;
}

}  // namespace sheetform
