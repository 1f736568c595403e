#include "sheetform/morph/full_morph.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <string>

#include "sheetform/base/error.h"
#include "sheetform/morph/full_energy.h"

namespace sheetform {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void check_weights(const FullMorphWeights& w) {
  const std::array<std::pair<const char*, double>, 7> all{{{"approx", w.approx},
                                                           {"laplace", w.laplace},
                                                           {"straight", w.straight},
                                                           {"seams", w.seams},
                                                           {"smooth", w.smooth},
                                                           {"flat", w.flat},
                                                           {"anchor", w.anchor}}};
  for (const auto& [name, value] : all)
    if (!(value >= 0) || !std::isfinite(value))
      throw Error(ErrorCode::kInvalidParameter, "a weight of the morph must be a number from 0 on", name,
                  "use the paper's weights");
  if (!(w.approx + w.anchor > 0))
    throw Error(ErrorCode::kInvalidParameter, "nothing holds the surface in place", "approx, anchor",
                "give one of the two a weight above 0");
}

struct NormalEquations {
  Sparse matrix;  // lower triangle
  Eigen::MatrixX3d rhs;
};

NormalEquations normal_equations(const EnergyRows& rows, const FullMorphWeights& weights, int n) {
  NormalEquations out{Sparse(n, n), Eigen::MatrixX3d::Zero(n, 3)};
  std::vector<Eigen::Triplet<double>> triplets;
  const auto& entries = rows.entries();
  for (const EnergyRows::Row& row : rows.rows()) {
    const double w = weight_of(row.term, weights) * row.factor;
    for (int a = row.begin; a < row.end; ++a) {
      const double wa = w * entries[a].coefficient;
      out.rhs.row(entries[a].vertex) += wa * row.target.transpose();
      for (int b = row.begin; b < row.end; ++b)
        if (entries[a].vertex >= entries[b].vertex)
          triplets.emplace_back(entries[a].vertex, entries[b].vertex, wa * entries[b].coefficient);
    }
  }
  out.matrix.setFromTriplets(triplets.begin(), triplets.end());
  return out;
}

// The unknowns are displacements: those are small, and so are the rounding errors of the solve.
void solve(const FullMorphProblem& problem, const EnergyRows& rows, const FullMorphWeights& weights,
           const RunContext& context, FullMorphResult& result) {
  const auto& rest = problem.mesh.rest;
  const int n = problem.mesh.size();
  auto start = Clock::now();
  EnergyRows moved;
  for (const EnergyRows::Row& row : rows.rows())
    moved.add(row.term, {rows.entries().begin() + row.begin, rows.entries().begin() + row.end},
              -rows.value(row, rest), row.factor);
  const NormalEquations equations = normal_equations(moved, weights, n);
  result.figures.unknowns = n;
  result.figures.nonzeros = equations.matrix.nonZeros();
  result.figures.assemble_seconds += seconds_since(start);
  context.checkpoint();
  start = Clock::now();
  const Eigen::SimplicialLDLT<Sparse> solver(equations.matrix);
  if (solver.info() != Eigen::Success)
    throw Error(ErrorCode::kInvalidParameter, "these weights leave part of the surface without a place",
                "weights of the morph", "give anchor a weight above 0");
  result.figures.factor_seconds = seconds_since(start);
  context.checkpoint();
  start = Clock::now();
  const Eigen::MatrixX3d step = solver.solve(equations.rhs);
  result.figures.solve_seconds = seconds_since(start);
  result.position.resize(n);
  result.displacement.resize(n);
  for (int v = 0; v < n; ++v) {
    result.position[v] = rest[v] + Vector3(step.row(v));
    result.displacement[v] = step.row(v).norm();
  }
}

void measure(const FullMorphProblem& problem, FullMorphResult& result) {
  const RuledMesh& mesh = problem.mesh;
  result.patch_displacement.assign(problem.patches, 0);
  result.ruling_displacement.assign(problem.patches, 0);
  for (int v = 0; v < mesh.size(); ++v) {
    double& all = result.patch_displacement[mesh.patch[v]];
    double& ruled = result.ruling_displacement[mesh.patch[v]];
    all = std::max(all, result.displacement[v]);
    if (mesh.on_ruling[v]) ruled = std::max(ruled, result.displacement[v]);
  }
  for (const auto& [a, b] : problem.seams)
    result.gap = std::max(result.gap, (result.position[a] - result.position[b]).norm());
  for (const RuledMesh::Ruling& r : mesh.rulings) {
    const Vector3 from = result.position[r.vertices.front()],
                  chord = result.position[r.vertices.back()] - from;
    const Vector3 along = chord.normalized();
    for (int v : r.vertices) {
      const Vector3 offset = result.position[v] - from;
      result.bow = std::max(result.bow, (offset - along * along.dot(offset)).norm());
    }
  }
}

// Means of the displacements of all copies of an arch's samples; a node is one point of all its arches.
class ArchMeans {
 public:
  ArchMeans(const FullMorphProblem& problem, const FullMorphResult& result)
      : problem_(problem), result_(result), sides_(problem.arch_rest.size()) {
    for (const RuledMesh::Side& side : problem.mesh.sides) {
      sides_[side.arch].push_back(&side);
      nodes_[problem.arch_nodes[side.arch][0]].copies.push_back(side.vertices.front());
      nodes_[problem.arch_nodes[side.arch][1]].copies.push_back(side.vertices.back());
    }
    for (auto& [vertex, node] : nodes_) {
      std::sort(node.copies.begin(), node.copies.end());
      node.copies.erase(std::unique(node.copies.begin(), node.copies.end()), node.copies.end());
      node.step = mean_step(node.copies);
    }
    for (std::size_t a = 0; a < problem.held.size(); ++a) {
      if (problem.held[a].empty() || sides_[a].empty()) continue;
      nodes_[problem.arch_nodes[a][0]].step = problem.held[a].front() - problem.arch_rest[a].front();
      nodes_[problem.arch_nodes[a][1]].step = problem.held[a].back() - problem.arch_rest[a].back();
    }
  }

  std::vector<Vector3> points_of(std::size_t arch) const {
    if (!problem_.held[arch].empty()) return problem_.held[arch];
    std::vector<Vector3> points = problem_.arch_rest[arch];
    if (points.empty()) return points;
    for (std::size_t s = 1; s + 1 < points.size(); ++s) {
      std::vector<int> copies;
      for (const auto* side : sides_[arch]) copies.push_back(side->vertices[problem_.arch_stop[arch][s]]);
      points[s] += mean_step(copies);
    }
    points.front() += nodes_.at(problem_.arch_nodes[arch][0]).step;
    points.back() += nodes_.at(problem_.arch_nodes[arch][1]).step;
    return points;
  }

 private:
  struct Node {
    std::vector<int> copies;
    Vector3 step = Vector3::Zero();
  };
  Vector3 mean_step(const std::vector<int>& copies) const {
    Vector3 sum = Vector3::Zero();
    for (int v : copies) sum += result_.position[v] - problem_.mesh.rest[v];
    return sum / static_cast<double>(copies.size());
  }
  const FullMorphProblem& problem_;
  const FullMorphResult& result_;
  std::vector<std::vector<const RuledMesh::Side*>> sides_;
  std::map<int, Node> nodes_;  // by mesh vertex
};

void check_held(const FullMorphProblem& problem) {
  for (std::size_t a = 0; a < problem.held.size(); ++a)
    if (!problem.held[a].empty() && problem.held[a].size() != problem.arch_stop[a].size())
      throw Error(ErrorCode::kInvalidParameter, "a held arch needs one place per sample",
                  "arch " + std::to_string(a), "leave it empty, or give a place for each of its samples");
}

}  // namespace

FullMorphWeights resolution_independent_weights() {
  FullMorphWeights w;
  w.straight = 1e3;
  w.straightness = Straightness::kChords;
  w.smooth_target = w.flat_target = BendTarget::kRest;
  return w;
}

FullMorphResult full_morph(const FullMorphProblem& problem, const FullMorphWeights& weights,
                           const RunContext& context) {
  check_weights(weights);
  check_held(problem);
  FullMorphResult result;
  const auto start = Clock::now();
  const EnergyRows rows = energy_rows(problem, weights);
  result.figures.assemble_seconds = seconds_since(start);
  context.checkpoint();
  if (problem.mesh.size() > 0) solve(problem, rows, weights, context, result);
  result.energy = energy_of(rows, weights, result.position);
  measure(problem, result);
  result.arch_points.resize(problem.arch_rest.size());
  const ArchMeans means(problem, result);
  for (std::size_t a = 0; a < result.arch_points.size(); ++a) result.arch_points[a] = means.points_of(a);
  return result;
}

FullMorphEnergy full_morph_energy(const FullMorphProblem& problem, const FullMorphWeights& weights,
                                  const std::vector<Vector3>& position) {
  if (position.size() != problem.mesh.rest.size())
    throw Error(ErrorCode::kInvalidParameter, "one position per vertex of the temporary mesh is needed",
                "position", "use positions of the same problem");
  return energy_of(energy_rows(problem, weights), weights, position);
}

}  // namespace sheetform
