#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "sheetform/field/cross_field.h"
#include "sheetform/field/tangent_frame.h"

namespace sheetform {
namespace {

using Matrix5 = Eigen::Matrix<double, 5, 5>;
using Vector5 = Eigen::Matrix<double, 5, 1>;

// Vertex adjacency as one flat array: the ball search is the hot loop of this stage.
struct Adjacency {
  std::vector<int> begin, vertices;
};

Adjacency vertex_adjacency(const SurfaceMesh& mesh) {
  Adjacency result{mesh.ring_begin, std::vector<int>(mesh.ring_edges.size())};
  for (int v = 0; v < mesh.vertex_count(); ++v)
    for (int i = mesh.ring_begin[v]; i < mesh.ring_begin[v + 1]; ++i)
      result.vertices[i] = mesh.edges[mesh.ring_edges[i]].other(v);
  return result;
}

// What every vertex's fit reads; `stamp` belongs to one worker.
struct FitInput {
  const SurfaceMesh& mesh;
  const Adjacency& adjacency;
  const std::vector<char>& barrier;  // vertices on creases: taken in, not passed
  const std::vector<Vector3>& normal;
};

struct Scratch {
  std::vector<int> stamp, ball;
  int now = 0;
};

// Vertices connected to v inside the ball, without v.
void collect_ball(const FitInput& in, int v, double radius, Scratch& scratch) {
  const auto& points = in.mesh.points;
  scratch.ball.assign(1, v);
  scratch.stamp[v] = ++scratch.now;
  for (std::size_t head = 0; head < scratch.ball.size(); ++head) {
    const int at = scratch.ball[head];
    if (in.barrier[at] && at != v) continue;
    for (int i = in.adjacency.begin[at]; i < in.adjacency.begin[at + 1]; ++i) {
      const int w = in.adjacency.vertices[i];
      if (scratch.stamp[w] == scratch.now || (points[w] - points[v]).squaredNorm() > radius * radius)
        continue;
      scratch.stamp[w] = scratch.now;
      if (in.barrier[w] || in.normal[w].dot(in.normal[v]) > 0) scratch.ball.push_back(w);
    }
  }
  scratch.ball.erase(scratch.ball.begin());
}

struct Quadric {
  double a, b, c, d, e;  // height = a x^2 + b xy + c y^2 + d x + e y, in units of the radius
};

// Least squares through the vertex itself. False when the points do not determine a quadric.
bool fit_quadric(const FitInput& in, int v, double radius, const TangentFrame& frame,
                 const std::vector<int>& ball, Quadric& out) {
  if (ball.size() < 6) return false;
  Matrix5 normal_matrix = Matrix5::Zero();
  Vector5 rhs = Vector5::Zero();
  for (int w : ball) {
    const Vector3 p = (in.mesh.points[w] - in.mesh.points[v]) / radius;
    const double x = p.dot(frame.x), y = p.dot(frame.y);
    const Vector5 row{x * x, x * y, y * y, x, y};
    normal_matrix.noalias() += row * row.transpose();
    rhs += row * p.dot(frame.normal);
  }
  const Eigen::LDLT<Matrix5> solver(normal_matrix);
  const auto pivots = solver.vectorD();
  if (!(pivots.minCoeff() > 1e-7 * pivots.maxCoeff())) return false;
  const Vector5 q = solver.solve(rhs);
  out = {q[0], q[1], q[2], q[3], q[4]};
  return true;
}

struct Principal {
  double k[2];        // 1 / radius
  Vector3 direction;  // of k[0], tangent to the quadric
};

// The generalised symmetric problem II w = k I w, by the Cholesky factor of I.
Principal principal_of(const Quadric& q, const TangentFrame& frame) {
  const double scale = -1 / std::sqrt(1 + q.d * q.d + q.e * q.e);  // minus: convex is positive
  Eigen::Matrix2d first, second;
  first << 1 + q.d * q.d, q.d * q.e, q.d * q.e, 1 + q.e * q.e;
  second << 2 * q.a * scale, q.b * scale, q.b * scale, 2 * q.c * scale;
  const Eigen::Matrix2d lower = first.llt().matrixL();
  const Eigen::Matrix2d inverse = lower.inverse();
  const Eigen::Matrix2d shape = inverse * second * inverse.transpose();
  const double mean = (shape(0, 0) + shape(1, 1)) / 2, half = (shape(0, 0) - shape(1, 1)) / 2;
  const double off = (shape(0, 1) + shape(1, 0)) / 2, spread = std::hypot(half, off);
  const double angle = std::atan2(off, half) / 2;  // direction of mean + spread
  const Eigen::Vector2d w = inverse.transpose() * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  const Vector3 lifted = frame.x * w[0] + frame.y * w[1] + frame.normal * (q.d * w[0] + q.e * w[1]);
  return {{mean + spread, mean - spread}, lifted};
}

void store(CurvatureField& out, int v, const Principal& p, double radius) {
  const Vector3& n = out.normal[v];
  const Vector3 large = (p.direction - n * n.dot(p.direction)).normalized();
  const Vector3 small = n.cross(large);
  const bool first_is_max = std::abs(p.k[0]) >= std::abs(p.k[1]);
  out.dir_max[v] = first_is_max ? large : small;
  out.dir_min[v] = first_is_max ? small : large;
  out.k_max[v] = p.k[first_is_max ? 0 : 1] / radius;
  out.k_min[v] = p.k[first_is_max ? 1 : 0] / radius;
}

// Tries larger balls when there are too few points; leaves zeros when nothing can be said.
void estimate(const FitInput& in, int v, double radius, Scratch& scratch, CurvatureField& out) {
  const TangentFrame frame = tangent_frame(out.normal[v]);
  for (int attempt = 0; attempt < 3; ++attempt, radius *= 1.5) {
    collect_ball(in, v, radius, scratch);
    Quadric q{};
    if (!fit_quadric(in, v, radius, frame, scratch.ball, q)) continue;
    store(out, v, principal_of(q, frame), radius);
    return;
  }
}

}  // namespace

CurvatureField principal_curvature(const SurfaceMesh& mesh, const std::vector<char>& crease_edge,
                                   const CurvatureParams& params, RunContext& context) {
  const int n = mesh.vertex_count();
  CurvatureField out;
  out.normal = vertex_normals(mesh);
  out.dir_min.assign(n, Vector3::Zero());
  out.dir_max.assign(n, Vector3::Zero());
  out.k_min.assign(n, 0);
  out.k_max.assign(n, 0);
  std::vector<char> barrier(n, 0);
  for (int e = 0; e < mesh.edge_count(); ++e)
    if (!crease_edge.empty() && crease_edge[e]) barrier[mesh.edges[e].v0] = barrier[mesh.edges[e].v1] = 1;
  const Adjacency adjacency = vertex_adjacency(mesh);
  const FitInput input{mesh, adjacency, barrier, out.normal};
  const double edge = mean_edge_length(mesh);
  const int block = 512, blocks = (n + block - 1) / block;
  parallel_for(context, blocks, [&](int b) {
    context.checkpoint();
    Scratch scratch{std::vector<int>(n, 0), {}, 0};
    for (int v = b * block; v < std::min(n, (b + 1) * block); ++v) {
      // A crease vertex sees two tangent planes: it has no curvature of its own.
      // At the border half of the ball is missing: one ring more steadies the fit.
      if (!barrier[v]) estimate(input, v, edge * (params.radius_edges + mesh.border_vertex[v]), scratch, out);
    }
  });
  return out;
}

}  // namespace sheetform
