#include "sheetform/ruling/chart.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace sheetform {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;
constexpr double kPi = 3.14159265358979323846;
constexpr double kMostChange = 0.8;  // of a length of the outline

double cross(const Vector2& a, const Vector2& b) { return a.x() * b.y() - a.y() * b.x(); }

struct Corners {  // union-find over the 3F corners of a patch
  std::vector<int> parent;
  int find(int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  }
  void join(int a, int b) {
    a = find(a), b = find(b);
    if (a != b) parent[std::max(a, b)] = std::min(a, b);
  }
};

int corner_at(const std::array<int, 3>& face, int v) { return face[0] == v ? 0 : face[1] == v ? 1 : 2; }

// Local vertices: corners joined across inner edges.
void cut_open(const SurfaceMesh& mesh, const PatchLayout& layout, const Patch& patch, PatchChart& chart) {
  const int n = static_cast<int>(patch.faces.size());
  Corners corners;
  corners.parent.resize(3 * n);
  std::iota(corners.parent.begin(), corners.parent.end(), 0);
  auto local_face = [&](int f) {
    return static_cast<int>(std::lower_bound(patch.faces.begin(), patch.faces.end(), f) -
                            patch.faces.begin());
  };
  for (int i = 0; i < n; ++i) {
    const int f = patch.faces[i];
    for (int k = 0; k < 3; ++k) {
      const int e = mesh.face_edges[f][k];
      if (layout.edge_arch[e] >= 0) continue;
      const int g = mesh.edges[e].other_face(f);
      if (g < f) continue;
      const int j = local_face(g), a = mesh.faces[f][k], b = mesh.faces[f][(k + 1) % 3];
      corners.join(3 * i + k, 3 * j + corner_at(mesh.faces[g], a));
      corners.join(3 * i + (k + 1) % 3, 3 * j + corner_at(mesh.faces[g], b));
    }
  }
  std::vector<int> id(3 * n, -1);
  chart.triangles.resize(n);
  for (int c = 0; c < 3 * n; ++c) {
    const int root = corners.find(c);
    if (id[root] < 0) {
      id[root] = static_cast<int>(chart.vertices.size());
      chart.vertices.push_back(mesh.faces[patch.faces[c / 3]][c % 3]);
    }
    chart.triangles[c / 3][c % 3] = id[root];
  }
  for (const ArchUse& use : patch.boundary) {
    const Arch& arch = layout.arches[use.arch];
    std::vector<int> line;
    const int m = static_cast<int>(arch.edges.size());
    for (int s = 0; s < m; ++s) {
      const int i = use.forward ? s : m - 1 - s;
      const int a = arch.vertices[use.forward ? i : i + 1], b = arch.vertices[use.forward ? i + 1 : i];
      const auto& edge = mesh.edges[arch.edges[i]];
      for (int f : {edge.f0, edge.f1}) {
        if (f < 0) continue;
        const int k = corner_at(mesh.faces[f], a);
        if (mesh.faces[f][(k + 1) % 3] != b) continue;
        const auto& t = chart.triangles[local_face(f)];
        if (line.empty()) line.push_back(t[k]);
        line.push_back(t[(k + 1) % 3]);
      }
    }
    chart.boundary.push_back(std::move(line));
  }
}

struct RestTriangle {
  Vector2 p[3];
  double cot[3];  // opposite corner k, clamped: Tutte's theorem needs positive weights
  double area;
};

std::vector<RestTriangle> rest_triangles(const SurfaceMesh& mesh, const Patch& patch) {
  std::vector<RestTriangle> rest(patch.faces.size());
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const auto& t = mesh.faces[patch.faces[i]];
    const Vector3 a = mesh.points[t[1]] - mesh.points[t[0]], b = mesh.points[t[2]] - mesh.points[t[0]];
    const double la = std::max(a.norm(), 1e-12), twice = a.cross(b).norm();
    RestTriangle& r = rest[i];
    r.p[0] = {0, 0}, r.p[1] = {la, 0}, r.p[2] = {a.dot(b) / la, twice / la};
    r.area = twice / 2;
    for (int k = 0; k < 3; ++k) {
      const Vector2 u = r.p[(k + 1) % 3] - r.p[k], v = r.p[(k + 2) % 3] - r.p[k];
      r.cot[k] = std::clamp(u.dot(v) / std::max(twice, 1e-14), 0.05, 10.0);
    }
  }
  return rest;
}

// Places of the local vertices in the order of elimination.
std::vector<int> elimination_order(const ChartParams& params, const PatchChart& chart) {
  const int n = static_cast<int>(chart.vertices.size());
  std::vector<int> order(n), place(n);
  std::iota(order.begin(), order.end(), 0);
  if (params.elimination_rank != nullptr)
    std::sort(order.begin(), order.end(), [&](int a, int b) {
      const int ra = (*params.elimination_rank)[chart.vertices[a]],
                rb = (*params.elimination_rank)[chart.vertices[b]];
      return ra != rb ? ra < rb : a < b;
    });
  for (int i = 0; i < n; ++i) place[order[i]] = i;
  return place;
}

// Factorises in the order given.
class Solver {
 public:
  Solver(int n, const Triplets& triplets) {
    Sparse matrix(n, n);
    matrix.setFromTriplets(triplets.begin(), triplets.end());
    ldlt_.compute(matrix);
  }
  Eigen::MatrixX2d solve(const Eigen::MatrixX2d& rhs) const { return ldlt_.solve(rhs); }

 private:
  Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::NaturalOrdering<int>> ldlt_;
};

std::vector<int> outline_of(const PatchChart& chart) {
  std::vector<int> loop;
  for (const auto& line : chart.boundary)
    for (std::size_t i = 0; i + 1 < line.size(); ++i) loop.push_back(line[i]);
  return loop;
}

// The cotangent Laplacian of the patch with its inner vertices eliminated.
class InnerSolver {
 public:
  InnerSolver(const std::vector<RestTriangle>& rest, const std::vector<int>& place,
              const std::vector<int>& loop, const PatchChart& chart)
      : rest_(rest), chart_(chart), inner_(chart.vertices.size(), -1) {
    std::vector<char> on_loop(inner_.size(), 0);
    std::vector<int> order(inner_.size());
    for (int v : loop) on_loop[v] = 1;
    for (std::size_t v = 0; v < order.size(); ++v) order[place[v]] = static_cast<int>(v);
    for (int v : order)
      if (!on_loop[v]) inner_[v] = count_++;
    if (count_ == 0) return;
    Triplets triplets;
    each_edge([&](int a, int b, double w) {
      if (inner_[a] < 0) return;
      triplets.emplace_back(inner_[a], inner_[a], w);
      if (inner_[b] >= 0 && inner_[a] > inner_[b]) triplets.emplace_back(inner_[a], inner_[b], -w);
    });
    solver_.emplace(count_, triplets);
  }

  // Fills in the inner entries so that the Laplacian of x is `load` there; x is given on the outline.
  void solve(const Eigen::MatrixX2d& load, Eigen::MatrixX2d& x) const {
    if (count_ == 0) return;
    Eigen::MatrixX2d rhs(count_, 2);
    for (std::size_t v = 0; v < inner_.size(); ++v)
      if (inner_[v] >= 0) rhs.row(inner_[v]) = load.row(static_cast<int>(v));
    each_edge([&](int a, int b, double w) {
      if (inner_[a] >= 0 && inner_[b] < 0) rhs.row(inner_[a]) += w * x.row(b);
    });
    const Eigen::MatrixX2d inside = solver_->solve(rhs);
    for (std::size_t v = 0; v < inner_.size(); ++v)
      if (inner_[v] >= 0) x.row(static_cast<int>(v)) = inside.row(inner_[v]);
  }

  // The Laplacian of x.
  Eigen::MatrixX2d laplacian(const Eigen::MatrixX2d& x) const {
    Eigen::MatrixX2d out = Eigen::MatrixX2d::Zero(x.rows(), 2);
    each_edge([&](int a, int b, double w) { out.row(a) += w * (x.row(a) - x.row(b)); });
    return out;
  }

 private:
  // Every side of every triangle, both ways: visit(from, to, weight).
  template <class Visit>
  void each_edge(const Visit& visit) const {
    for (std::size_t i = 0; i < rest_.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const int a = chart_.triangles[i][(k + 1) % 3], b = chart_.triangles[i][(k + 2) % 3];
        visit(a, b, rest_[i].cot[k]);
        visit(b, a, rest_[i].cot[k]);
      }
  }

  const std::vector<RestTriangle>& rest_;
  const PatchChart& chart_;
  std::vector<int> inner_;  // per local vertex: row, -1 on the outline
  int count_ = 0;
  std::optional<Solver> solver_;
};

// The outline on a circle: with it the inner points never fold over (Tutte).
Eigen::MatrixX2d round_outline(const std::vector<RestTriangle>& rest, const std::vector<int>& loop,
                               std::size_t vertices) {
  double area = 0;
  for (const auto& r : rest) area += r.area;
  const double radius = std::sqrt(area / kPi), step = 2 * kPi / static_cast<double>(loop.size());
  Eigen::MatrixX2d outline = Eigen::MatrixX2d::Zero(static_cast<int>(vertices), 2);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const double angle = step * static_cast<double>(i);
    outline.row(loop[i]) = radius * Vector2(std::cos(angle), std::sin(angle)).transpose();
  }
  return outline;
}

// The conformal outline that keeps its lengths (Sawhney and Crane 2017, "Boundary First Flattening"), exact
// where the patch is developable: angles follow from a Poisson problem, lengths change as little as closing
// takes. Nothing where they would have to change by much.
std::optional<Eigen::MatrixX2d> unrolled_outline(const SurfaceMesh& mesh, const InnerSolver& inner,
                                                 const std::vector<RestTriangle>& rest,
                                                 const PatchChart& chart, const std::vector<int>& loop) {
  const auto vertices = static_cast<int>(chart.vertices.size());
  std::vector<char> on_loop(vertices, 0);
  for (int v : loop) on_loop[v] = 1;
  Eigen::MatrixX2d load = Eigen::MatrixX2d::Zero(vertices, 2), u = load;
  std::vector<double> angle(vertices, 0);
  for (std::size_t i = 0; i < rest.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const Vector2 a = rest[i].p[(k + 1) % 3] - rest[i].p[k], b = rest[i].p[(k + 2) % 3] - rest[i].p[k];
      angle[chart.triangles[i][k]] += std::atan2(cross(a, b), a.dot(b));
    }
  for (int v = 0; v < vertices; ++v)
    if (!on_loop[v]) load(v, 0) = angle[v] - 2 * kPi;
  inner.solve(load, u);
  const Eigen::MatrixX2d flux = inner.laplacian(u);

  const std::size_t n = loop.size();
  std::vector<double> length(n);
  std::vector<Vector2> along(n);
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  Vector2 gap = Vector2::Zero();
  double heading = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vector3 &a = mesh.points[chart.vertices[loop[i]]],
                  &b = mesh.points[chart.vertices[loop[(i + 1) % n]]];
    length[i] = std::max((b - a).norm(), 1e-12);
    if (i > 0) heading += kPi - angle[loop[i]] + flux(loop[i], 0);
    along[i] = {std::cos(heading), std::sin(heading)};
    spread += length[i] * along[i] * along[i].transpose();
    gap += length[i] * along[i];
  }
  const Vector2 pull = spread.inverse() * gap;
  Eigen::MatrixX2d outline = Eigen::MatrixX2d::Zero(vertices, 2);
  Vector2 at = Vector2::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    const double keep = 1 - along[i].dot(pull);
    if (!(keep > 1 - kMostChange && keep < 1 + kMostChange)) return std::nullopt;
    outline.row(loop[i]) = at.transpose();
    at += keep * length[i] * along[i];
  }
  return outline;
}

// One local step: rotations and the right-hand side; returns the energy of the current map.
double local_step(const std::vector<RestTriangle>& rest, const PatchChart& chart,
                  const std::vector<int>& place, Eigen::MatrixX2d& rhs) {
  rhs.setZero();
  double energy = 0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const auto& t = chart.triangles[i];
    const RestTriangle& r = rest[i];
    double a = 0, b = 0;
    for (int k = 0; k < 3; ++k) {
      const int p = (k + 1) % 3, q = (k + 2) % 3;
      const Vector2 u = chart.uv[t[q]] - chart.uv[t[p]], x = r.p[q] - r.p[p];
      a += r.cot[k] * u.dot(x);
      b += r.cot[k] * (x.x() * u.y() - x.y() * u.x());
    }
    const double norm = std::max(std::sqrt(a * a + b * b), 1e-300);
    a /= norm, b /= norm;
    for (int k = 0; k < 3; ++k) {
      const int p = (k + 1) % 3, q = (k + 2) % 3;
      const Vector2 x = r.p[q] - r.p[p], turned(a * x.x() - b * x.y(), b * x.x() + a * x.y());
      energy += r.cot[k] * (chart.uv[t[q]] - chart.uv[t[p]] - turned).squaredNorm();
      rhs.row(place[t[q]]) += r.cot[k] * turned.transpose();
      rhs.row(place[t[p]]) -= r.cot[k] * turned.transpose();
    }
  }
  return energy;
}

void arap(const std::vector<RestTriangle>& rest, const ChartParams& params, const std::vector<int>& place,
          PatchChart& chart) {
  const int n = static_cast<int>(place.size());
  Triplets triplets;
  triplets.reserve(9 * rest.size() + 1);
  for (std::size_t i = 0; i < rest.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const int a = place[chart.triangles[i][(k + 1) % 3]], b = place[chart.triangles[i][(k + 2) % 3]];
      const double w = rest[i].cot[k];
      triplets.emplace_back(a, a, w), triplets.emplace_back(b, b, w);
      triplets.emplace_back(std::max(a, b), std::min(a, b), -w);
    }
  triplets.emplace_back(place[0], place[0], 1.0);  // pins vertex 0, the only freedom left
  const Solver solver(n, triplets);
  Eigen::MatrixX2d rhs(n, 2), x;
  double last = 0;
  for (int it = 0; it < params.max_iterations; ++it) {
    const double energy = local_step(rest, chart, place, rhs);
    if (it > 0 && last - energy < params.stop * last) break;
    last = energy;
    rhs.row(place[0]) += chart.uv[0].transpose();
    x = solver.solve(rhs);
    for (int v = 0; v < n; ++v) chart.uv[v] = x.row(place[v]);
  }
}

void measure(const std::vector<RestTriangle>& rest, PatchChart& chart) {
  double area = 0, folded = 0, distortion = 0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const auto& t = chart.triangles[i];
    const RestTriangle& r = rest[i];
    Eigen::Matrix2d from, to;
    from << r.p[1], r.p[2];
    to << chart.uv[t[1]] - chart.uv[t[0]], chart.uv[t[2]] - chart.uv[t[0]];
    area += r.area;
    if (to.determinant() <= 0) folded += r.area;
    if (from.determinant() < 1e-14) continue;
    const Eigen::Matrix2d j = to * from.inverse();
    // |J|^2 - 2 (s1 + s2) + 2, with s1 + s2 = sqrt(|J|^2 + 2 |det J|)
    const double frob = j.squaredNorm();
    distortion += r.area * (frob - 2 * std::sqrt(std::max(0.0, frob + 2 * std::abs(j.determinant()))) + 2);
  }
  chart.folded = folded / std::max(area, 1e-300);
  chart.distortion = distortion / std::max(area, 1e-300);
}

}  // namespace

std::vector<int> elimination_rank(const SurfaceMesh& mesh) {
  const int n = static_cast<int>(mesh.points.size());
  Triplets triplets;
  for (const auto& e : mesh.edges) triplets.emplace_back(e.v0, e.v1, 1), triplets.emplace_back(e.v1, e.v0, 1);
  for (int v = 0; v < n; ++v) triplets.emplace_back(v, v, 1);
  Sparse matrix(n, n);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(matrix, order);
  std::vector<int> rank(n);
  for (int i = 0; i < n; ++i) rank[order.indices()[i]] = i;
  return rank;
}

PatchChart parametrize(const SurfaceMesh& mesh, const PatchLayout& layout, const Patch& patch,
                       const ChartParams& params) {
  PatchChart chart;
  cut_open(mesh, layout, patch, chart);
  const auto rest = rest_triangles(mesh, patch);
  const std::vector<int> place = elimination_order(params, chart), loop = outline_of(chart);
  const InnerSolver inner(rest, place, loop, chart);
  const Eigen::MatrixX2d no_load = Eigen::MatrixX2d::Zero(static_cast<int>(chart.vertices.size()), 2);
  const auto settle = [&](Eigen::MatrixX2d start) {
    inner.solve(no_load, start);
    chart.uv.resize(chart.vertices.size());
    for (std::size_t v = 0; v < chart.uv.size(); ++v) chart.uv[v] = start.row(static_cast<int>(v));
    arap(rest, params, place, chart);
    measure(rest, chart);
  };
  const auto unrolled = unrolled_outline(mesh, inner, rest, chart, loop);
  if (unrolled) settle(*unrolled);
  if (!unrolled || chart.folded > 0) settle(round_outline(rest, loop, chart.vertices.size()));
  return chart;
}

}  // namespace sheetform
