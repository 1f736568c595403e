#include "sheetform/field/cross_field.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <string>

#include "sheetform/base/error.h"
#include "sheetform/field/tangent_frame.h"

namespace sheetform {
namespace {

using Complex = std::complex<double>;
using ComplexMatrix = Eigen::SparseMatrix<Complex>;
using ComplexVector = Eigen::VectorXcd;

constexpr double kPi = 3.14159265358979323846;

// The energy sum_ij w_ij |z_j - t_ij z_i|^2 + sum_i a_i |z_i - c_i|^2, c_i unit or zero.
struct FieldProblem {
  std::vector<Complex> transport4;  // per edge, v0 -> v1: the transport factor to the fourth
  std::vector<Complex> transport1;
  std::vector<double> edge_weight;
  std::vector<double> vertex_area;
  std::vector<double> pull;     // a_i
  std::vector<Complex> target;  // c_i
};

// Half the sum of the two cotangents; clamped, so that the matrix stays positive definite on bad triangles.
std::vector<double> cotangent_weights(const SurfaceMesh& mesh) {
  std::vector<double> weight(mesh.edges.size(), 0);
  for (int f = 0; f < mesh.face_count(); ++f) {
    const auto& t = mesh.faces[f];
    const double twice_area = std::max(mesh.face_normal_raw(f).norm(), 1e-300);
    for (int k = 0; k < 3; ++k) {
      const Vector3& apex = mesh.points[t[(k + 2) % 3]];
      const double cot = (mesh.points[t[k]] - apex).dot(mesh.points[t[(k + 1) % 3]] - apex) / twice_area;
      weight[mesh.face_edges[f][k]] += std::clamp(cot, -20.0, 20.0) / 2;
    }
  }
  for (double& w : weight) w = std::clamp(w, 0.05, 20.0);
  return weight;
}

std::vector<double> vertex_areas(const SurfaceMesh& mesh) {
  std::vector<double> area(mesh.points.size(), 0);
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int v : mesh.faces[f]) area[v] += mesh.face_normal_raw(f).norm() / 6;
  return area;
}

void set_transport(const SurfaceMesh& mesh, const std::vector<TangentFrame>& frames, FieldProblem& problem) {
  for (const auto& e : mesh.edges) {
    const Complex r = transport_factor(frames[e.v0], frames[e.v1]);
    const Complex r2 = mul(r, r);
    problem.transport1.push_back(r);
    problem.transport4.push_back(mul(r2, r2));
  }
}

void pull_to_curvature(const CurvatureField& curvature, const std::vector<TangentFrame>& frames,
                       double diagonal, const FieldParams& params, double lambda, FieldProblem& problem) {
  for (std::size_t v = 0; v < frames.size(); ++v) {
    const double x = std::abs(curvature.k_max[v] - curvature.k_min[v]) * diagonal / params.curvature_scale;
    problem.target[v] = unit_fourth_power(frames[v].to_complex(curvature.dir_min[v]));
    problem.pull[v] =
        problem.target[v] == Complex(0) ? 0 : lambda * problem.vertex_area[v] * x * x / (1 + x * x);
  }
}

// A direction given by the user is obeyed: it outweighs all edges at its vertex.
void pull_to_guide(const std::vector<Vector3>& guide, const std::vector<TangentFrame>& frames,
                   FieldProblem& problem) {
  constexpr double kGuideWeight = 100;
  for (std::size_t v = 0; v < frames.size(); ++v) {
    problem.target[v] = unit_fourth_power(frames[v].to_complex(guide[v]));
    problem.pull[v] = problem.target[v] == Complex(0) ? 0 : kGuideWeight;
  }
}

bool is_feature(const SurfaceMesh& mesh, const std::vector<char>& crease_edge, int e) {
  return mesh.edges[e].border() || (!crease_edge.empty() && crease_edge[e]);
}

// True when the features at v bound a sector whose angle is far from every multiple of 90 degrees: no cross
// can follow both of its sides (pitfall: such corners count as quarter singularities when forced).
bool is_odd_corner(const SurfaceMesh& mesh, const std::vector<char>& crease_edge, int v) {
  constexpr double kTolerance = 27 * kPi / 180;  // of 45: beyond, half of the alignment is lost
  const int* ring = mesh.ring_begin_of(v);
  const int count = static_cast<int>(mesh.ring_end_of(v) - ring);
  int first = 0;
  while (first < count && !is_feature(mesh, crease_edge, ring[first])) ++first;
  if (first == count) return false;
  const int steps = mesh.border_vertex[v] ? count - 1 : count;
  double sector = 0;
  for (int i = 0; i < steps; ++i) {
    const int a = ring[(first + i) % count], b = ring[(first + i + 1) % count];
    sector += angle_between(mesh.points[mesh.edges[a].other(v)] - mesh.points[v],
                            mesh.points[mesh.edges[b].other(v)] - mesh.points[v]);
    if (!is_feature(mesh, crease_edge, b)) continue;
    if (std::abs(std::remainder(sector, kPi / 2)) > kTolerance) return true;
    sector = 0;
  }
  return false;
}

// Borders and creases: the mean of their edges' fourth powers, weighted by how well these agree.
void pull_to_features(const SurfaceMesh& mesh, const std::vector<char>& crease_edge,
                      const std::vector<TangentFrame>& frames, double weight_area, FieldProblem& problem) {
  const int n = mesh.vertex_count();
  std::vector<Complex> sum(n, 0);
  std::vector<int> count(n, 0);
  std::vector<char> odd(n, 0);
  for (int e = 0; e < mesh.edge_count(); ++e) {
    if (!is_feature(mesh, crease_edge, e)) continue;
    const Vector3 along = mesh.points[mesh.edges[e].v1] - mesh.points[mesh.edges[e].v0];
    for (int v : {mesh.edges[e].v0, mesh.edges[e].v1})
      sum[v] += unit_fourth_power(frames[v].to_complex(along)), ++count[v];
  }
  for (int v = 0; v < n; ++v) {
    if (count[v] == 0 || !is_odd_corner(mesh, crease_edge, v)) continue;
    odd[v] = 1;
    for (const int* e = mesh.ring_begin_of(v); e != mesh.ring_end_of(v); ++e)
      odd[mesh.edges[*e].other(v)] = 1;
  }
  for (int v = 0; v < n; ++v) {
    if (count[v] == 0 || odd[v]) continue;
    const double agreement = std::abs(sum[v]) / count[v];
    const double pull = (weight_area * problem.vertex_area[v] + 1) * std::max(0.0, 2 * agreement - 1);
    if (pull <= problem.pull[v]) continue;
    problem.pull[v] = pull;
    problem.target[v] = sum[v] / std::abs(sum[v]);
  }
}

// Lower triangle of the energy's matrix plus `extra[i]` on the diagonal. Edges have v0 < v1.
ComplexMatrix assemble(const SurfaceMesh& mesh, const FieldProblem& problem,
                       const std::vector<double>& extra) {
  const int n = mesh.vertex_count();
  std::vector<double> diagonal(n);
  for (int v = 0; v < n; ++v) diagonal[v] = problem.pull[v] + extra[v];
  Eigen::VectorXi column_size = Eigen::VectorXi::Ones(n);
  for (int e = 0; e < mesh.edge_count(); ++e) {
    diagonal[mesh.edges[e].v0] += problem.edge_weight[e];
    diagonal[mesh.edges[e].v1] += problem.edge_weight[e];
    ++column_size[mesh.edges[e].v0];
  }
  ComplexMatrix matrix(n, n);
  matrix.reserve(column_size);
  for (int v = 0, e = 0; v < n; ++v) {
    matrix.insert(v, v) = diagonal[v];
    for (; e < mesh.edge_count() && mesh.edges[e].v0 == v; ++e)  // edges are sorted by (v0, v1)
      matrix.insert(mesh.edges[e].v1, v) = -problem.edge_weight[e] * problem.transport4[e];
  }
  matrix.makeCompressed();
  return matrix;
}

class Factor {
 public:
  void compute(const ComplexMatrix& matrix) {
    if (!analysed_) solver_.analyzePattern(matrix);
    analysed_ = true;
    solver_.factorize(matrix);
    if (solver_.info() != Eigen::Success)
      throw Error(ErrorCode::kInternal, "the field's matrix is not definite");
  }
  ComplexVector solve(const ComplexVector& rhs) const { return solver_.solve(rhs); }

 private:
  Eigen::SimplicialLDLT<ComplexMatrix> solver_;
  bool analysed_ = false;
};

void normalise(ComplexVector& z) {
  for (Eigen::Index v = 0; v < z.size(); ++v) {
    const double length = std::abs(z[v]);
    z[v] = length > 1e-100 ? z[v] / length : Complex(1, 0);
  }
}

// The linear solve, then rounds of "normalise, one implicit step": they merge pairs of singularities.
ComplexVector minimise(const SurfaceMesh& mesh, const FieldProblem& problem, double lambda, int rounds,
                       RunContext& context) {
  const int n = mesh.vertex_count();
  ComplexVector pull(n);
  for (int v = 0; v < n; ++v) pull[v] = problem.pull[v] * problem.target[v];
  Factor factor;
  std::vector<double> mass(n);
  for (int v = 0; v < n; ++v)
    mass[v] = 1e-9 * problem.vertex_area[v] * lambda;  // keeps a free flat piece regular
  factor.compute(assemble(mesh, problem, mass));
  ComplexVector z = factor.solve(pull);
  normalise(z);
  context.checkpoint();
  if (rounds <= 0) return z;
  for (int v = 0; v < n; ++v)
    mass[v] = 2 * lambda * problem.vertex_area[v];  // step of half the feature length squared
  factor.compute(assemble(mesh, problem, mass));
  for (int round = 0; round < rounds; ++round) {
    context.checkpoint();
    ComplexVector rhs = pull;
    for (int v = 0; v < n; ++v) rhs[v] += mass[v] * z[v];
    z = factor.solve(rhs);
    normalise(z);
  }
  return z;
}

// Quarter turns that the cross makes around a face, against parallel transport.
void find_singularities(const SurfaceMesh& mesh, const FieldProblem& problem, const ComplexVector& z,
                        CrossField& field) {
  for (int f = 0; f < mesh.face_count(); ++f) {
    double turn = 0;
    Complex holonomy = 1;
    for (int k = 0; k < 3; ++k) {
      const int e = mesh.face_edges[f][k], a = mesh.faces[f][k], b = mesh.faces[f][(k + 1) % 3];
      const bool forward = mesh.edges[e].v0 == a;
      const Complex t4 = forward ? problem.transport4[e] : std::conj(problem.transport4[e]);
      const Complex t1 = forward ? problem.transport1[e] : std::conj(problem.transport1[e]);
      // Summed from the lower vertex on both sides of an edge, so that a difference of 180 degrees cancels
      // exactly.
      const double delta = forward ? std::arg(mul(z[b], std::conj(mul(t4, z[a]))))
                                   : -std::arg(mul(z[a], std::conj(mul(std::conj(t4), z[b]))));
      turn += delta;
      holonomy = mul(holonomy, t1);
    }
    const int index = static_cast<int>(std::lround((turn + 4 * std::arg(holonomy)) / (2 * kPi)));
    if (index == 0) continue;
    field.singular_faces.push_back(f);
    field.singular_index.push_back(index);
  }
}

// A field without any constraint still needs a direction: the first vertex gets one, too weak to matter
// elsewhere.
void anchor_if_free(FieldProblem& problem) {
  double total = 0;
  for (double p : problem.pull) total += p;
  if (total > 1e-12 || problem.pull.empty()) return;
  problem.pull[0] = 1e-3;
  problem.target[0] = 1;
}

}  // namespace

int closest_direction(const CrossField& field, int v, const Vector3& w) {
  const double along = field.dir[v].dot(w), across = field.normal[v].cross(field.dir[v]).dot(w);
  if (std::abs(along) >= std::abs(across)) return along >= 0 ? 0 : 2;
  return across >= 0 ? 1 : 3;
}

CrossField cross_field(const SurfaceMesh& mesh, const std::vector<char>& crease_edge,
                       const CurvatureField& curvature, const std::vector<Vector3>* guide,
                       const FieldParams& params, RunContext& context) {
  if (guide != nullptr && guide->size() != mesh.points.size())
    throw Error(
        ErrorCode::kInvalidParameter, "the guide field does not fit the mesh",
        std::to_string(guide->size()) + " directions for " + std::to_string(mesh.points.size()) + " vertices",
        "give one direction for each vertex, zero where it is free");
  const double diagonal = bounding_box_diagonal(mesh.points);
  const double lambda = 1 / std::pow(params.feature_length * diagonal, 2);
  const std::vector<TangentFrame> frames = tangent_frames(curvature.normal);
  FieldProblem problem;
  set_transport(mesh, frames, problem);
  problem.edge_weight = cotangent_weights(mesh);
  problem.vertex_area = vertex_areas(mesh);
  problem.pull.assign(mesh.points.size(), 0);
  problem.target.assign(mesh.points.size(), 0);
  if (guide != nullptr)
    pull_to_guide(*guide, frames, problem);
  else
    pull_to_curvature(curvature, frames, diagonal, params, lambda, problem);
  pull_to_features(mesh, crease_edge, frames, params.border_weight * lambda, problem);
  anchor_if_free(problem);
  const ComplexVector z = minimise(mesh, problem, lambda, params.diffusion_rounds, context);

  CrossField field;
  field.normal = curvature.normal;
  for (std::size_t v = 0; v < frames.size(); ++v)
    field.dir.push_back(frames[v].to_vector(std::polar(1.0, std::arg(z[static_cast<Eigen::Index>(v)]) / 4)));
  find_singularities(mesh, problem, z, field);
  return field;
}

}  // namespace sheetform
