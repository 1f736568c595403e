#include "sheetform/morph/full_energy.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace sheetform {
namespace {

using Entry = EnergyRows::Entry;
using Entries = std::vector<Entry>;

// One-ring averages with cotangent weights of the chart.
class Planarity {
 public:
  explicit Planarity(const RuledMesh& mesh) : mesh_(mesh), first_(mesh.size() + 1, 0) {
    for (const auto& t : mesh.triangles)
      for (int v : t) ++first_[v + 1];
    for (int v = 0; v < mesh.size(); ++v) first_[v + 1] += first_[v];
    corner_.resize(first_.back());
    std::vector<int> next(first_.begin(), first_.end() - 1);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) corner_[next[mesh.triangles[t][k]]++] = {static_cast<int>(t), k};
  }

  /// Neighbours with weights that sum to 1; equal weights next to folded or flat triangles.
  Entries average(int v) const {
    Entries ring;
    double sum = 0;
    bool sound = true;
    for (int c = first_[v]; c < first_[v + 1]; ++c) {
      const auto [t, k] = corner_[c];
      const int a = mesh_.triangles[t][(k + 1) % 3], b = mesh_.triangles[t][(k + 2) % 3];
      const Vector2 &uv = mesh_.uv[v], &ua = mesh_.uv[a], &ub = mesh_.uv[b];
      const double twice = cross(ua - uv, ub - uv),
                   longest = std::max((ua - uv).squaredNorm(), (ub - uv).squaredNorm());
      if (!(twice > 1e-9 * longest)) sound = false;
      // The weight of an edge is the cotangent of the angle opposite to it.
      const double to_b = (uv - ua).dot(ub - ua) / twice, to_a = (uv - ub).dot(ua - ub) / twice;
      entry(ring, a) += to_a;
      entry(ring, b) += to_b;
      sum += to_a + to_b;
    }
    for (Entry& e : ring)
      e.coefficient = sound ? e.coefficient / sum : 1.0 / static_cast<double>(ring.size());
    return ring;
  }

  /// The least change of the weights that makes the average exact on planes; false when the ring does not
  /// allow it without weights above kMost.
  bool make_exact(int v, Entries& ring) const {
    const auto n = static_cast<Eigen::Index>(ring.size());
    if (n < 3) return false;
    Eigen::Matrix3Xd rule(3, n);
    Eigen::VectorXd weight(n);
    double size = 0;
    for (const Entry& e : ring) size = std::max(size, (mesh_.uv[e.vertex] - mesh_.uv[v]).norm());
    if (!(size > 0)) return false;
    for (Eigen::Index j = 0; j < n; ++j) {
      rule.col(j) << 1, (mesh_.uv[ring[j].vertex] - mesh_.uv[v]) / size;
      weight[j] = ring[j].coefficient;
    }
    const Eigen::FullPivLU<Eigen::Matrix3d> gram(rule * rule.transpose());
    if (gram.rank() < 3) return false;
    weight += rule.transpose() * gram.solve(Vector3::UnitX() - rule * weight);
    if (!(weight.cwiseAbs().maxCoeff() <= kMost)) return false;
    for (Eigen::Index j = 0; j < n; ++j) ring[j].coefficient = weight[j];
    return true;
  }

 private:
  static constexpr double kMost = 10;
  static double& entry(Entries& ring, int vertex) {
    for (Entry& e : ring)
      if (e.vertex == vertex) return e.coefficient;
    ring.push_back({vertex, 0});
    return ring.back().coefficient;
  }
  const RuledMesh& mesh_;
  std::vector<int> first_;
  std::vector<std::array<int, 2>> corner_;  // triangle, corner
};

// Eq. 3.
void add_planarity(const RuledMesh& mesh, OutlinePlanarity outline, EnergyRows& rows) {
  const Planarity planarity(mesh);
  for (int v = 0; v < mesh.size(); ++v) {
    if (mesh.on_ruling[v] || (mesh.on_border[v] && outline == OutlinePlanarity::kOff)) continue;
    Entries row = planarity.average(v);
    if (row.empty()) continue;
    if (mesh.on_border[v] && outline == OutlinePlanarity::kPlanar && !planarity.make_exact(v, row)) continue;
    row.push_back({v, -1});
    rows.add(EnergyTerm::kLaplace, row, Vector3::Zero());
  }
}

// Eq. 2.
void add_straightness(const RuledMesh& mesh, Straightness kind, EnergyRows& rows) {
  for (const RuledMesh::Ruling& r : mesh.rulings) {
    const int last = static_cast<int>(r.vertices.size()) - 1;
    for (int j = 1; j < last; ++j) {
      const int i = kind == Straightness::kTriplets ? j - 1 : 0,
                k = kind == Straightness::kTriplets ? j + 1 : last;
      const double alpha = (r.at[k] - r.at[j]) / (r.at[k] - r.at[i]);
      rows.add(EnergyTerm::kStraight,
               {{r.vertices[i], alpha}, {r.vertices[k], 1 - alpha}, {r.vertices[j], -1}}, Vector3::Zero());
    }
  }
}

// Eq. 4; the seam to a patch that does not move has its other side as target.
void add_seams(const FullMorphProblem& problem, EnergyRows& rows) {
  for (const auto& [a, b] : problem.seams) rows.add(EnergyTerm::kSeams, {{a, 1}, {b, -1}}, Vector3::Zero());
  for (const RuledMesh::Side& side : problem.mesh.sides) {
    const auto& held = problem.held[side.arch];
    for (std::size_t s = 0; s < held.size(); ++s)
      rows.add(EnergyTerm::kSeams, {{side.vertices[problem.arch_stop[side.arch][s]], 1}}, held[s]);
  }
}

Vector3 bend_target(const Entries& row, const RuledMesh& mesh, BendTarget target) {
  Vector3 bend = Vector3::Zero();
  if (target == BendTarget::kRest)
    for (const Entry& e : row) bend += e.coefficient * mesh.rest[e.vertex];
  return bend;
}

void add_smoothness(const FullMorphProblem& problem, BendTarget target, EnergyRows& rows) {
  const auto& rest = problem.mesh.rest;
  for (const auto& [i, j, k] : problem.outline) {
    const double before = (rest[j] - rest[i]).norm(), after = (rest[k] - rest[j]).norm();
    if (!(before + after > 0)) continue;
    const double alpha = after / (before + after);
    const Entries row{{i, alpha}, {k, 1 - alpha}, {j, -1}};
    rows.add(EnergyTerm::kSmooth, row, bend_target(row, problem.mesh, target));
  }
}

// A point of a ruling between two of its vertices.
struct RulingPoint {
  Vector2 uv;
  std::array<Entry, 2> entries;
};

// Where the line through p across `direction` meets a ruling; false when it passes it by.
bool point_across(const RuledMesh& mesh, const RuledMesh::Ruling& ruling, const Vector2& p,
                  const Vector2& direction, RulingPoint& out) {
  const Vector2 from = mesh.uv[ruling.vertices.front()], chord = mesh.uv[ruling.vertices.back()] - from;
  const double run = chord.dot(direction);
  if (std::abs(run) < 0.1 * chord.norm()) return false;
  const double at = (p - from).dot(direction) / run;
  if (!(at >= 0 && at <= 1)) return false;
  auto k =
      static_cast<std::size_t>(std::upper_bound(ruling.at.begin(), ruling.at.end(), at) - ruling.at.begin());
  k = std::clamp<std::size_t>(k, 1, ruling.at.size() - 1);
  const double t = (at - ruling.at[k - 1]) / (ruling.at[k] - ruling.at[k - 1]);
  const int a = ruling.vertices[k - 1], b = ruling.vertices[k];
  out.uv = (1 - t) * mesh.uv[a] + t * mesh.uv[b];
  out.entries = {Entry{a, 1 - t}, Entry{b, t}};
  return true;
}

void add_flatness_at(const RuledMesh& mesh, const std::array<const RuledMesh::Ruling*, 3>& r, int v,
                     BendTarget target, EnergyRows& rows) {
  const Vector2 chord = mesh.uv[r[1]->vertices.back()] - mesh.uv[r[1]->vertices.front()],
                d = chord.normalized();
  RulingPoint i, k;
  if (!point_across(mesh, *r[0], mesh.uv[v], d, i) || !point_across(mesh, *r[2], mesh.uv[v], d, k)) return;
  const double before = cross(d, i.uv - mesh.uv[v]), after = cross(d, k.uv - mesh.uv[v]);
  // Rulings that share an end meet there: nothing bends.
  if (before * after >= 0 || std::min(std::abs(before), std::abs(after)) < 1e-3 * std::abs(before - after))
    return;
  const double alpha = after / (after - before);
  Entries row{{v, -1}};
  for (const Entry& e : i.entries) row.push_back({e.vertex, alpha * e.coefficient});
  for (const Entry& e : k.entries) row.push_back({e.vertex, (1 - alpha) * e.coefficient});
  rows.add(EnergyTerm::kFlat, row, bend_target(row, mesh, target), mesh.isotropy[v]);
}

void add_flatness(const RuledMesh& mesh, BendTarget target, EnergyRows& rows) {
  for (std::size_t r = 1; r + 1 < mesh.rulings.size(); ++r) {
    const std::array<const RuledMesh::Ruling*, 3> three{&mesh.rulings[r - 1], &mesh.rulings[r],
                                                        &mesh.rulings[r + 1]};
    if (three[0]->patch != three[1]->patch || three[2]->patch != three[1]->patch) continue;
    for (int v : three[1]->vertices) add_flatness_at(mesh, three, v, target, rows);
  }
}

}  // namespace

double weight_of(EnergyTerm term, const FullMorphWeights& weights) {
  switch (term) {
    case EnergyTerm::kApprox:
      return weights.approx;
    case EnergyTerm::kLaplace:
      return weights.laplace;
    case EnergyTerm::kStraight:
      return weights.straight;
    case EnergyTerm::kSeams:
      return weights.seams;
    case EnergyTerm::kSmooth:
      return weights.smooth;
    case EnergyTerm::kFlat:
      return weights.flat;
    case EnergyTerm::kAnchor:
      return weights.anchor;
  }
  return 0;
}

void EnergyRows::add(EnergyTerm term, const std::vector<Entry>& entries, const Vector3& target,
                     double factor) {
  const int begin = static_cast<int>(entries_.size());
  entries_.insert(entries_.end(), entries.begin(), entries.end());
  rows_.push_back({term, factor, target, begin, static_cast<int>(entries_.size())});
}

Vector3 EnergyRows::value(const Row& row, const std::vector<Vector3>& position) const {
  Vector3 sum = -row.target;
  for (int e = row.begin; e < row.end; ++e) sum += entries_[e].coefficient * position[entries_[e].vertex];
  return sum;
}

EnergyRows energy_rows(const FullMorphProblem& problem, const FullMorphWeights& weights) {
  const RuledMesh& mesh = problem.mesh;
  EnergyRows rows;
  for (int v = 0; v < mesh.size(); ++v)
    if (mesh.on_ruling[v]) rows.add(EnergyTerm::kApprox, {{v, 1}}, mesh.rest[v]);  // eq. 1
  if (weights.laplace > 0) add_planarity(mesh, weights.planarity, rows);
  if (weights.straight > 0) add_straightness(mesh, weights.straightness, rows);
  if (weights.seams > 0) add_seams(problem, rows);
  if (weights.smooth > 0) add_smoothness(problem, weights.smooth_target, rows);
  if (weights.flat > 0) add_flatness(mesh, weights.flat_target, rows);
  if (weights.anchor > 0)
    for (int v = 0; v < mesh.size(); ++v) rows.add(EnergyTerm::kAnchor, {{v, 1}}, mesh.rest[v]);
  return rows;
}

FullMorphEnergy energy_of(const EnergyRows& rows, const FullMorphWeights& weights,
                          const std::vector<Vector3>& position) {
  FullMorphEnergy e;
  for (const EnergyRows::Row& row : rows.rows()) {
    const double value = row.factor * rows.value(row, position).squaredNorm();
    e.total += weight_of(row.term, weights) * value;
    switch (row.term) {
      case EnergyTerm::kApprox:
        e.approx += value;
        break;
      case EnergyTerm::kLaplace:
        e.laplace += value;
        break;
      case EnergyTerm::kStraight:
        e.straight += value;
        break;
      case EnergyTerm::kSeams:
        e.seams += value;
        break;
      case EnergyTerm::kSmooth:
        e.smooth += value;
        break;
      case EnergyTerm::kFlat:
        e.flat += value;
        break;
      case EnergyTerm::kAnchor:
        e.anchor += value;
        break;
    }
  }
  return e;
}

}  // namespace sheetform
