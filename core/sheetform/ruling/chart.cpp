#include "sheetform/ruling/chart.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace sheetform {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

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

void tutte(const std::vector<RestTriangle>& rest, const std::vector<int>& place, PatchChart& chart) {
  const int n = static_cast<int>(chart.vertices.size());
  std::vector<int> loop;
  std::vector<char> on_loop(n, 0);
  for (const auto& line : chart.boundary)
    for (std::size_t i = 0; i + 1 < line.size(); ++i) loop.push_back(line[i]), on_loop[line[i]] = 1;
  // Lengths along the loop, from the rest triangles' boundary edges, are close to uniform: use steps.
  chart.uv.assign(n, Vector2::Zero());
  double area = 0;
  for (const auto& r : rest) area += r.area;
  const double radius = std::sqrt(area / 3.14159265358979),
               step = 2 * 3.14159265358979 / static_cast<double>(loop.size());
  for (std::size_t i = 0; i < loop.size(); ++i)
    chart.uv[loop[i]] =
        radius * Vector2(std::cos(step * static_cast<double>(i)), std::sin(step * static_cast<double>(i)));
  std::vector<int> inner(n, -1), order(n);
  for (int v = 0; v < n; ++v) order[place[v]] = v;
  int m = 0;
  for (int v : order)
    if (!on_loop[v]) inner[v] = m++;
  if (m == 0) return;
  Triplets triplets;
  Eigen::MatrixX2d rhs = Eigen::MatrixX2d::Zero(m, 2);
  for (std::size_t i = 0; i < rest.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const int a = chart.triangles[i][(k + 1) % 3], b = chart.triangles[i][(k + 2) % 3];
      const double w = rest[i].cot[k];
      for (auto [x, y] : {std::pair{a, b}, std::pair{b, a}}) {
        if (inner[x] < 0) continue;
        triplets.emplace_back(inner[x], inner[x], w);
        if (inner[y] >= 0) {
          if (inner[x] > inner[y]) triplets.emplace_back(inner[x], inner[y], -w);
        } else {
          rhs.row(inner[x]) += w * chart.uv[y].transpose();
        }
      }
    }
  const Eigen::MatrixX2d x = Solver(m, triplets).solve(rhs);
  for (int v = 0; v < n; ++v)
    if (inner[v] >= 0) chart.uv[v] = x.row(inner[v]);
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
  const std::vector<int> place = elimination_order(params, chart);
  tutte(rest, place, chart);
  arap(rest, params, place, chart);
  measure(rest, chart);
  return chart;
}

}  // namespace sheetform
