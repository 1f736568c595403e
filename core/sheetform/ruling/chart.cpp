#include "sheetform/ruling/chart.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>

namespace sheetform {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Rows2 = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;  // a place in the plane per row
constexpr double kPi = 3.14159265358979323846;
constexpr double kMostChange = 0.8;  // of a length of the outline
constexpr double kBlurred = 1e-12;   // of the energy at rest: below, energies are rounding
constexpr int kInnerIterations = 3;  // with the outline held: exact on cones, where clamped weights are not

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

// Local vertices: corners joined across inner edges. Returns for side k of the i-th triangle, which joins its
// corners k and k + 1, the side of the other one there, as 3 i + k; -1 on the outline.
std::vector<int> cut_open(const SurfaceMesh& mesh, const PatchLayout& layout, const Patch& patch,
                          PatchChart& chart) {
  const int n = static_cast<int>(patch.faces.size());
  Corners corners;
  corners.parent.resize(3 * n);
  std::iota(corners.parent.begin(), corners.parent.end(), 0);
  std::vector<int> local_face(mesh.faces.size());
  for (int i = 0; i < n; ++i) local_face[patch.faces[i]] = i;
  std::vector<char> outline(mesh.points.size(), 0);  // what lies inside has one place
  for (const ArchUse& use : patch.boundary)
    for (int v : layout.arches[use.arch].vertices) outline[v] = 1;
  std::vector<int> mate(3 * n, -1);
  for (int i = 0; i < n; ++i) {
    const int f = patch.faces[i];
    for (int k = 0; k < 3; ++k) {
      const int e = mesh.face_edges[f][k];
      if (layout.edge_arch[e] >= 0) continue;
      const int g = mesh.face_neighbours[f][k];
      if (g < f) continue;
      const int v = mesh.faces[f][k], w = mesh.faces[f][(k + 1) % 3];
      const int j = local_face[g], b = corner_at(mesh.faces[g], w);
      mate[3 * i + k] = 3 * j + b, mate[3 * j + b] = 3 * i + k;
      if (outline[v]) corners.join(3 * i + k, 3 * j + (b + 1) % 3);
      if (outline[w]) corners.join(3 * i + (k + 1) % 3, 3 * j + b);
    }
  }
  std::vector<int> by_corner(3 * n, -1), by_vertex(mesh.points.size(), -1);
  chart.triangles.resize(n);
  for (int c = 0; c < 3 * n; ++c) {
    const int v = mesh.faces[patch.faces[c / 3]][c % 3];
    int& id = outline[v] ? by_corner[corners.find(c)] : by_vertex[v];
    if (id < 0) {
      id = static_cast<int>(chart.vertices.size());
      chart.vertices.push_back(v);
    }
    chart.triangles[c / 3][c % 3] = id;
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
        const auto& t = chart.triangles[local_face[f]];
        if (line.empty()) line.push_back(t[k]);
        line.push_back(t[(k + 1) % 3]);
      }
    }
    chart.boundary.push_back(std::move(line));
  }
  return mate;
}

struct RestTriangle {
  Vector2 p[3];
  double cot[3];  // opposite corner k, clamped: Tutte's theorem needs positive weights
  double area;
};

// A triangle at rest as the local step needs it.
struct Frame {
  int corner[3];
  double x[3], y[3];  // gradient of the Dirichlet energy (of cot) at each corner, of the triangle at rest
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
  std::vector<std::uint64_t> order(n);  // rank, then vertex
  for (int v = 0; v < n; ++v) {
    const int rank = params.elimination_rank != nullptr ? (*params.elimination_rank)[chart.vertices[v]] : 0;
    order[v] = static_cast<std::uint64_t>(rank) << 32 | static_cast<unsigned>(v);
  }
  std::sort(order.begin(), order.end());
  std::vector<int> place(n);
  for (int i = 0; i < n; ++i) place[order[i] & 0xffffffffu] = i;
  return place;
}

// A side of one or two triangles, with the sum of their cotangents.
struct ChartEdge {
  int a, b;  // local vertices
  double weight;
};

std::vector<ChartEdge> chart_edges(const PatchChart& chart, const std::vector<RestTriangle>& rest,
                                   const std::vector<int>& mate) {
  std::vector<ChartEdge> edges;
  edges.reserve(2 * rest.size());
  const auto weight = [&](int side) { return rest[side / 3].cot[(side % 3 + 2) % 3]; };
  for (int side = 0; side < static_cast<int>(mate.size()); ++side) {
    const int other = mate[side], i = side / 3, k = side % 3;
    if (other > side) continue;  // counted there
    edges.push_back({chart.triangles[i][k], chart.triangles[i][(k + 1) % 3],
                     weight(side) + (other >= 0 ? weight(other) : 0)});
  }
  return edges;
}

// Factorises a symmetric matrix in the order of its rows, given as its upper triangle: Eigen's own compute()
// copies the matrix three times before it comes to that.
class Solver : private Eigen::SimplicialLDLT<Sparse, Eigen::Upper, Eigen::NaturalOrdering<int>> {
 public:
  void factorise(const Sparse& upper) {
    analyzePattern_preordered(upper, true);
    factorize_preordered<true>(upper);
  }

  // In place, both columns in one pass.
  void solve(Rows2& x) const {
    const int n = static_cast<int>(x.rows());
    const int *begin = m_matrix.outerIndexPtr(), *row = m_matrix.innerIndexPtr();
    const double* value = m_matrix.valuePtr();
    for (int j = 0; j < n; ++j) {
      const Eigen::RowVector2d at = x.row(j);
      for (int k = begin[j]; k < begin[j + 1]; ++k) x.row(row[k]) -= value[k] * at;
    }
    for (int j = n - 1; j >= 0; --j) {
      Eigen::RowVector2d at = x.row(j) / m_diag[j];
      for (int k = begin[j]; k < begin[j + 1]; ++k) at -= value[k] * x.row(row[k]);
      x.row(j) = at;
    }
  }
};

// The matrix with the sum of weights at each vertex on the diagonal and minus the weights beside it, over the
// vertices that have a row (row[v] >= 0); `pin` is added to the last diagonal entry.
Sparse upper_laplacian(int rows, const std::vector<int>& row, const std::vector<ChartEdge>& edges,
                       double pin) {
  Sparse upper(rows, rows);
  std::vector<double> diagonal(rows, 0);
  Eigen::VectorXi size = Eigen::VectorXi::Ones(rows);
  for (const ChartEdge& e : edges) {
    const int a = row[e.a], b = row[e.b];
    if (a >= 0) diagonal[a] += e.weight;
    if (b >= 0) diagonal[b] += e.weight;
    if (a >= 0 && b >= 0) ++size[std::max(a, b)];
  }
  if (rows > 0) diagonal[rows - 1] += pin;
  upper.resizeNonZeros(size.sum());
  int* begin = upper.outerIndexPtr();
  std::vector<int> next(rows);
  for (int c = 0, at = 0; c < rows; ++c) begin[c] = next[c] = at, at += size[c];
  begin[rows] = size.sum();
  const auto put = [&](int r, int c, double value) {
    const int at = next[c]++;
    upper.innerIndexPtr()[at] = r, upper.valuePtr()[at] = value;
  };
  for (const ChartEdge& e : edges)
    if (const int a = row[e.a], b = row[e.b]; a >= 0 && b >= 0)
      put(std::min(a, b), std::max(a, b), -e.weight);
  for (int c = 0; c < rows; ++c) put(c, c, diagonal[c]);
  return upper;
}

std::vector<int> outline_of(const PatchChart& chart) {
  std::vector<int> loop;
  for (const auto& line : chart.boundary)
    for (std::size_t i = 0; i + 1 < line.size(); ++i) loop.push_back(line[i]);
  return loop;
}

// The cotangent Laplacian of the patch with its inner vertices eliminated.
class InnerSolver {
 public:
  InnerSolver(const std::vector<ChartEdge>& edges, const std::vector<int>& place,
              const std::vector<int>& loop)
      : edges_(edges), inner_(place.size(), -1) {
    std::vector<char> on_loop(inner_.size(), 0);
    std::vector<int> order(inner_.size());
    for (int v : loop) on_loop[v] = 1;
    for (std::size_t v = 0; v < order.size(); ++v) order[place[v]] = static_cast<int>(v);
    for (int v : order)
      if (!on_loop[v]) inner_[v] = count_++;
    if (count_ > 0) solver_.factorise(upper_laplacian(count_, inner_, edges, 0));
  }

  // Fills in the inner entries so that the Laplacian of x is `load` there; x is given on the outline.
  void solve(const Rows2& load, Rows2& x) const {
    if (count_ == 0) return;
    Rows2 inside(count_, 2);
    for (std::size_t v = 0; v < inner_.size(); ++v)
      if (inner_[v] >= 0) inside.row(inner_[v]) = load.row(static_cast<int>(v));
    for (const ChartEdge& e : edges_) {
      if (inner_[e.a] >= 0 && inner_[e.b] < 0) inside.row(inner_[e.a]) += e.weight * x.row(e.b);
      if (inner_[e.b] >= 0 && inner_[e.a] < 0) inside.row(inner_[e.b]) += e.weight * x.row(e.a);
    }
    solver_.solve(inside);
    for (std::size_t v = 0; v < inner_.size(); ++v)
      if (inner_[v] >= 0) x.row(static_cast<int>(v)) = inside.row(inner_[v]);
  }

  // The Laplacian of x.
  Rows2 laplacian(const Rows2& x) const {
    Rows2 out = Rows2::Zero(x.rows(), 2);
    for (const ChartEdge& e : edges_) {
      const Eigen::RowVector2d flow = e.weight * (x.row(e.a) - x.row(e.b));
      out.row(e.a) += flow, out.row(e.b) -= flow;
    }
    return out;
  }

 private:
  const std::vector<ChartEdge>& edges_;
  std::vector<int> inner_;  // per local vertex: row, -1 on the outline
  int count_ = 0;
  Solver solver_;
};

// The outline on a circle: with it the inner points never fold over (Tutte).
Rows2 round_outline(const std::vector<RestTriangle>& rest, const std::vector<int>& loop,
                    std::size_t vertices) {
  double area = 0;
  for (const auto& r : rest) area += r.area;
  const double radius = std::sqrt(area / kPi), step = 2 * kPi / static_cast<double>(loop.size());
  Rows2 outline = Rows2::Zero(static_cast<int>(vertices), 2);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const double angle = step * static_cast<double>(i);
    outline.row(loop[i]) = radius * Vector2(std::cos(angle), std::sin(angle)).transpose();
  }
  return outline;
}

// The conformal outline that keeps its lengths (Sawhney and Crane 2017, "Boundary First Flattening"), exact
// where the patch is developable: angles follow from a Poisson problem, lengths change as little as closing
// takes. Nothing where they would have to change by much.
std::optional<Rows2> unrolled_outline(const SurfaceMesh& mesh, const InnerSolver& inner,
                                      const std::vector<RestTriangle>& rest, const PatchChart& chart,
                                      const std::vector<int>& loop) {
  const auto vertices = static_cast<int>(chart.vertices.size());
  std::vector<char> on_loop(vertices, 0);
  for (int v : loop) on_loop[v] = 1;
  Rows2 load = Rows2::Zero(vertices, 2), u = load;
  std::vector<double> angle(vertices, 0);
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const Vector2 &x = rest[i].p[1], &y = rest[i].p[2], z = y - x;
    const double at_first = std::atan2(cross(x, y), x.dot(y)), at_second = std::atan2(cross(x, z), -x.dot(z));
    angle[chart.triangles[i][0]] += at_first;
    angle[chart.triangles[i][1]] += at_second;
    angle[chart.triangles[i][2]] += kPi - at_first - at_second;
  }
  for (int v = 0; v < vertices; ++v)
    if (!on_loop[v]) load(v, 0) = angle[v] - 2 * kPi;
  inner.solve(load, u);
  const Rows2 flux = inner.laplacian(u);

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
  Rows2 outline = Rows2::Zero(vertices, 2);
  Vector2 at = Vector2::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    const double keep = 1 - along[i].dot(pull);
    if (!(keep > 1 - kMostChange && keep < 1 + kMostChange)) return std::nullopt;
    outline.row(loop[i]) = at.transpose();
    at += keep * length[i] * along[i];
  }
  return outline;
}

// Triangles by the rows of their corners: row[v] of local vertex v, or v itself.
std::vector<Frame> frames(const std::vector<RestTriangle>& rest, const PatchChart& chart,
                          const std::vector<int>* row) {
  std::vector<Frame> out(rest.size());
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const RestTriangle& r = rest[i];
    for (int k = 0; k < 3; ++k) {
      const int v = chart.triangles[i][k], next = (k + 1) % 3, last = (k + 2) % 3;
      out[i].corner[k] = row != nullptr ? (*row)[v] : v;
      const Vector2 gradient = r.cot[next] * (r.p[k] - r.p[last]) - r.cot[last] * (r.p[next] - r.p[k]);
      out[i].x[k] = gradient.x(), out[i].y[k] = gradient.y();
    }
  }
  return out;
}

// One local step: the right-hand side, each triangle turned as it lies in x. Returns how well they lie: the
// energy of the map is its Dirichlet energy, less twice this, and a constant.
double local_step(const std::vector<Frame>& triangles, const Rows2& x, Rows2& rhs) {
  rhs.setZero();
  const double* from = x.data();
  double* to = rhs.data();
  double fit = 0;
  for (const Frame& t : triangles) {
    double a = 0, b = 0;  // the turn that fits best, not of unit length yet
    for (int k = 0; k < 3; ++k) {
      const double u = from[2 * t.corner[k]], v = from[2 * t.corner[k] + 1];
      a += t.x[k] * u + t.y[k] * v, b += t.x[k] * v - t.y[k] * u;
    }
    const double length = std::max(std::sqrt(a * a + b * b), 1e-300);
    fit += length;
    a /= length, b /= length;
    for (int k = 0; k < 3; ++k) {
      to[2 * t.corner[k]] += a * t.x[k] - b * t.y[k];
      to[2 * t.corner[k] + 1] += b * t.x[k] + a * t.y[k];
    }
  }
  return fit;
}

double rest_energy(const std::vector<RestTriangle>& rest) {
  double energy = 0;
  for (const RestTriangle& r : rest)
    for (int k = 0; k < 3; ++k) energy += r.cot[k] * (r.p[(k + 2) % 3] - r.p[(k + 1) % 3]).squaredNorm();
  return energy;
}

// From the map given to that of least energy, per local vertex.
Rows2 arap(const std::vector<RestTriangle>& rest, const ChartParams& params, const std::vector<int>& place,
           const PatchChart& chart, const InnerSolver& inner, const Solver& solver, const Rows2& start) {
  const int n = static_cast<int>(place.size());
  const std::vector<Frame> triangles = frames(rest, chart, &place);
  Rows2 x(n, 2), load(n, 2);
  for (int v = 0; v < n; ++v) x.row(place[v]) = start.row(v);
  const double at_rest = rest_energy(rest);
  double dirichlet = start.cwiseProduct(inner.laplacian(start)).sum(), last = 0;
  for (int it = 0; it < params.max_iterations; ++it) {
    const double energy = dirichlet - 2 * local_step(triangles, x, load) + at_rest;
    // Small differences of large sums: what is exact but for these goes on.
    if (it > 0 && energy > kBlurred * at_rest && last - energy < params.stop * last) break;
    last = energy;
    load.row(n - 1) += x.row(n - 1);  // pinned: the only freedom left
    x = load;
    solver.solve(x);
    dirichlet = x.cwiseProduct(load).sum() - x.row(n - 1).squaredNorm();  // of a solution
  }
  for (int v = 0; v < n; ++v) load.row(v) = x.row(place[v]);
  return load;
}

void take_places(const Rows2& map, PatchChart& chart) {
  chart.uv.resize(map.rows());
  for (int v = 0; v < map.rows(); ++v) chart.uv[v] = map.row(v);
}

void measure(const std::vector<RestTriangle>& rest, PatchChart& chart) {
  double area = 0, folded = 0, distortion = 0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const auto& t = chart.triangles[i];
    const RestTriangle& r = rest[i];
    const Vector2 one = chart.uv[t[1]] - chart.uv[t[0]], other = chart.uv[t[2]] - chart.uv[t[0]];
    area += r.area;
    if (cross(one, other) <= 0) folded += r.area;
    if (r.area < 5e-15) continue;
    const Vector2 along = one / r.p[1].x(), across = (other - r.p[2].x() * along) / r.p[2].y();
    // |J|^2 - 2 (s1 + s2) + 2, with s1 + s2 = sqrt(|J|^2 + 2 |det J|)
    const double frob = along.squaredNorm() + across.squaredNorm();
    distortion += r.area * (frob - 2 * std::sqrt(frob + 2 * std::abs(cross(along, across))) + 2);
  }
  chart.folded = folded / std::max(area, 1e-300);
  chart.distortion = distortion / std::max(area, 1e-300);
}

}  // namespace

std::vector<int> elimination_rank(const SurfaceMesh& mesh) {
  const int n = static_cast<int>(mesh.points.size());
  std::vector<Eigen::Triplet<double>> triplets;
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
  const std::vector<int> mate = cut_open(mesh, layout, patch, chart);
  const auto rest = rest_triangles(mesh, patch);
  const std::vector<ChartEdge> edges = chart_edges(chart, rest, mate);
  const std::vector<int> place = elimination_order(params, chart), loop = outline_of(chart);
  const auto n = static_cast<int>(chart.vertices.size());
  const InnerSolver inner(edges, place, loop);
  std::optional<Solver> whole;
  const auto map_to = [&](Rows2 outline, int iterations) {
    Rows2 load = Rows2::Zero(n, 2);
    inner.solve(load, outline);
    const std::vector<Frame> triangles = iterations > 0 ? frames(rest, chart, nullptr) : std::vector<Frame>();
    for (int i = 0; i < iterations; ++i) {
      local_step(triangles, outline, load);
      inner.solve(load, outline);
    }
    take_places(outline, chart);
    measure(rest, chart);
    return outline;
  };
  const auto settle = [&](const Rows2& start) {
    if (!whole) whole.emplace().factorise(upper_laplacian(n, place, edges, 1.0));
    take_places(arap(rest, params, place, chart, inner, *whole, start), chart);
    measure(rest, chart);
  };
  if (const auto unrolled = unrolled_outline(mesh, inner, rest, chart, loop)) {
    const Rows2 start = map_to(*unrolled, kInnerIterations);
    if (chart.folded > 0 || chart.distortion > params.close_enough) settle(start);
    if (chart.folded == 0) return chart;
  }
  settle(map_to(round_outline(rest, loop, chart.vertices.size()), 0));
  return chart;
}

}  // namespace sheetform
