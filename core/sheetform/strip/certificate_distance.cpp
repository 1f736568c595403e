// The two-sided distance: samples, vertices, and a climb to the top from the farthest of them.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "sheetform/strip/certificate.h"
#include "sheetform/strip/certificate_checks.h"

namespace sheetform {
namespace {

// A climb ends when its step is this fraction of the diagonal: distances change by no more than the step
// does.
constexpr double kFinestStep = 2e-5;
// Climbs start in the faces where the distance found is largest: one for so many samples, within bounds.
constexpr int kSamplesForAClimb = 200, kFewestClimbs = 24, kMostClimbs = 200;
// Where only places beyond a limit are asked for, what is known to be nearer than this share of it is not
// measured exactly.
constexpr double kSettled = 0.85;

/// The surface distances are measured from, in plain arrays.
struct Surface {
  const std::vector<Vector3>& points;
  const std::vector<std::array<int, 3>>& faces;
  double area(int f) const {
    const auto& t = faces[f];
    return (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).norm() / 2;
  }
};

using Sample = certificate::AreaSample;

// Vertices that faces use, each with one of its faces.
std::vector<Sample> vertex_samples(const Surface& s) {
  std::vector<int> face(s.points.size(), -1);
  for (std::size_t f = 0; f < s.faces.size(); ++f)
    for (int v : s.faces[f])
      if (face[v] < 0) face[v] = static_cast<int>(f);
  std::vector<Sample> out;
  for (std::size_t v = 0; v < face.size(); ++v) out.push_back({s.points[v], face[v]});
  return out;
}

std::vector<Sample> midpoint_samples(const Surface& s) {
  std::vector<Sample> out;
  for (std::size_t f = 0; f < s.faces.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = s.faces[f][k], b = s.faces[f][(k + 1) % 3];
      if (a < b) out.push_back({0.5 * (s.points[a] + s.points[b]), static_cast<int>(f)});
    }
  return out;
}

// The point of a triangle with these barycentric coordinates, negative ones raised to zero.
Vector3 clamped_point(const Vector3& a, const Vector3& b, const Vector3& c, Vector3 weights) {
  weights = weights.cwiseMax(0.0);
  weights /= weights.sum();
  return weights[0] * a + weights[1] * b + weights[2] * c;
}

/// Distances from one surface to another, one way.
class OneWay {
 public:
  // settled: a distance known to be below it is not told exactly.
  OneWay(const Surface& from, const ClosestPointTree& tree, int to_faces, double settled,
         const RunContext& context)
      : from_face(from.faces.size(), 0),
        to_face(to_faces, 0),
        farthest(from.faces.size(), Vector3::Zero()),
        farthest_hit(from.faces.size()),
        to_point(to_faces, Vector3::Zero()),
        to_hit(to_faces),
        from_(from),
        tree_(tree),
        settled_(settled),
        context_(context) {}

  // Measures from each sample and gives the mean distance.
  double measure(const std::vector<Sample>& samples) {
    std::vector<ClosestPoint> hits(samples.size());
    constexpr int kChunk = 512;
    const int n = static_cast<int>(samples.size());
    parallel_for(context_, (n + kChunk - 1) / kChunk, [&](int chunk) {
      context_.checkpoint();
      for (int i = chunk * kChunk; i < std::min(n, (chunk + 1) * kChunk); ++i)
        if (samples[i].face >= 0) hits[i] = closest(samples[i].point);
    });
    context_.checkpoint();
    double sum = 0;
    for (int i = 0; i < n; ++i)
      if (samples[i].face >= 0) sum += keep(samples[i].point, samples[i].face, hits[i]);
    return n > 0 ? sum / n : 0;
  }

  // Climbs inside the faces with the largest distances from the farthest point known of each.
  void climb_from_the_top(int samples, double spacing, double finest) {
    std::vector<int> order(from_.faces.size());
    std::iota(order.begin(), order.end(), 0);
    const std::size_t climbs = std::min(
        order.size(),
        static_cast<std::size_t>(std::clamp(samples / kSamplesForAClimb, kFewestClimbs, kMostClimbs)));
    std::partial_sort(
        order.begin(), order.begin() + static_cast<std::ptrdiff_t>(climbs), order.end(),
        [&](int a, int b) { return from_face[a] != from_face[b] ? from_face[a] > from_face[b] : a < b; });
    for (std::size_t i = 0; i < climbs; ++i) {
      if (i % 16 == 0) context_.checkpoint();
      if (from_face[order[i]] > settled_) climb(order[i], spacing, finest);
    }
  }

  double max = 0;
  Vector3 worst = Vector3::Zero();
  std::vector<double> from_face, to_face;  ///< largest distance found from and to each face
  std::vector<Vector3> farthest;           ///< of each face, where from_face is attained
  std::vector<ClosestPoint> farthest_hit;
  std::vector<Vector3> to_point;  ///< where to_face is attained
  std::vector<ClosestPoint> to_hit;

 private:
  ClosestPoint closest(const Vector3& point) const {
    return tree_.closest(point, std::numeric_limits<double>::infinity(), settled_ * settled_);
  }

  double keep(const Vector3& point, int face, const ClosestPoint& hit) {
    const double d = std::sqrt(hit.squared_distance);
    if (d > from_face[face]) from_face[face] = d, farthest[face] = point, farthest_hit[face] = hit;
    if (hit.face >= 0 && d > to_face[hit.face])
      to_face[hit.face] = d, to_point[hit.face] = point, to_hit[hit.face] = hit;
    if (d > max) max = d, worst = point;
    return d;
  }

  // Pattern search along the face's longest side and across it.
  void climb(int face, double step, double finest) {
    const auto& t = from_.faces[face];
    const Vector3 &a = from_.points[t[0]], &b = from_.points[t[1]], &c = from_.points[t[2]];
    Eigen::Matrix<double, 3, 2> sides;
    sides << b - a, c - a;
    const Eigen::Matrix2d gram = sides.transpose() * sides;
    if (!(gram.determinant() > 0)) return;
    const Eigen::Matrix2d inverse = gram.inverse();
    Vector3 along = (b - a).squaredNorm() > (c - a).squaredNorm() ? b - a : c - a;
    if ((c - b).squaredNorm() > along.squaredNorm()) along = c - b;
    along.normalize();
    const Vector3 across = along.cross((b - a).cross(c - a)).normalized();
    for (; step > finest; step /= 2)
      for (bool better = true; better;) {
        better = false;
        for (const Vector3& way : {along, Vector3(-along), across, Vector3(-across)}) {
          const Eigen::Vector2d w = inverse * (sides.transpose() * (farthest[face] + step * way - a));
          const Vector3 trial = clamped_point(a, b, c, {1 - w.sum(), w[0], w[1]});
          const double before = from_face[face];
          better = keep(trial, face, closest(trial)) > before * (1 + 1e-9) || better;
        }
      }
  }

  const Surface& from_;
  const ClosestPointTree& tree_;
  double settled_;
  const RunContext& context_;
};

Vector3 barycentric(const std::vector<Vector3>& points, const std::array<int, 3>& t, const Vector3& p) {
  Eigen::Matrix<double, 3, 2> sides;
  sides << points[t[1]] - points[t[0]], points[t[2]] - points[t[0]];
  const Eigen::Matrix2d gram = sides.transpose() * sides;
  if (!(gram.determinant() > 0)) return {1, 0, 0};
  const Eigen::Vector2d w = gram.inverse() * (sides.transpose() * (p - points[t[0]]));
  return {1 - w.sum(), w[0], w[1]};
}

// Measures, and gives the mean distance too.
std::pair<OneWay, double> measure_one_way(const Surface& from, const ClosestPointTree& tree, int to_faces,
                                          int samples, bool midpoints, double diagonal, double settled,
                                          const RunContext& context) {
  OneWay way(from, tree, to_faces, settled, context);
  const double mean = way.measure(certificate::area_samples(from.points, from.faces, samples));
  if (midpoints) way.measure(midpoint_samples(from));
  way.measure(vertex_samples(from));
  double area = 0;
  for (std::size_t f = 0; f < from.faces.size(); ++f) area += from.area(static_cast<int>(f));
  way.climb_from_the_top(samples, std::sqrt(area / std::max(1, samples)), kFinestStep * diagonal);
  return {std::move(way), mean};
}

}  // namespace

DistanceReport measure_distance(const TriangleSoup& input, const ClosestPointTree& tree,
                                const StripMesh& result, int samples, RunContext& context, double far_limit) {
  std::vector<std::array<int, 3>> faces;
  std::vector<int> patch_of;
  for (std::size_t p = 0; p < result.patches.size(); ++p)
    for (const StripMesh::Triangle& t : result.patches[p].triangles) {
      faces.push_back(t.v);
      patch_of.push_back(static_cast<int>(p));
    }
  DistanceReport report;
  report.patch_error.assign(result.patches.size(), 0);
  if (faces.empty() || input.faces.empty()) return report;
  const Surface in{input.points, input.faces}, out{result.points, faces};
  Eigen::AlignedBox3d box;
  for (const auto& f : input.faces)
    for (int v : f) box.extend(input.points[v]);
  const double diagonal = box.diagonal().norm();
  const double settled = std::isfinite(far_limit) ? kSettled * far_limit : 0;
  const ClosestPointTree result_tree(result.points, faces);
  context.checkpoint();
  const int in_faces = static_cast<int>(input.faces.size()), out_faces = static_cast<int>(faces.size());
  const auto [to, to_mean] =
      measure_one_way(in, result_tree, out_faces, samples, false, diagonal, settled, context);
  const auto [back, back_mean] =
      measure_one_way(out, tree, in_faces, samples, true, diagonal, settled, context);
  report.input_to_result = to.max, report.result_to_input = back.max;
  report.mean = (to_mean + back_mean) / 2;
  report.worst_place = to.max >= back.max ? to.worst : back.worst;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    double& error = report.patch_error[patch_of[f]];
    error = std::max({error, to.to_face[f], back.from_face[f]});
    if (to.to_face[f] > far_limit)
      report.far.push_back({faces[f], to.to_hit[f].barycentric, to.to_point[f], to.to_face[f]});
    if (back.from_face[f] > far_limit)
      report.far.push_back({faces[f], barycentric(result.points, faces[f], back.farthest[f]),
                            back.farthest_hit[f].point, back.from_face[f]});
  }
  return report;
}

}  // namespace sheetform
