// The two-sided distance: samples, vertices, and a climb to the top from the farthest of them.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "sheetform/mesh/far_vertices.h"
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
};

using Sample = certificate::AreaSample;

// Vertices that faces use, each with one of its faces.
std::vector<Sample> vertex_samples(const Surface& s) {
  std::vector<int> face(s.points.size(), -1);
  for (std::size_t f = 0; f < s.faces.size(); ++f)
    for (int v : s.faces[f])
      if (face[v] < 0) face[v] = static_cast<int>(f);
  std::vector<Sample> out;
  for (std::size_t v = 0; v < face.size(); ++v)
    if (face[v] >= 0) out.push_back({s.points[v], face[v]});
  return out;
}

std::vector<Sample> far_vertex_samples(const Surface& s, const ClosestPointTree& own,
                                       const ClosestPointTree& to, double limit, const RunContext& context) {
  std::vector<Sample> out;
  for (const FarVertex& v : far_vertices(s.faces, own, to, limit, context))
    out.push_back({s.points[v.vertex], v.face});
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

// The largest distance found at some faces, and where: few faces of a large mesh are ever asked for.
class Farthest {
 public:
  struct Place {
    double distance = 0;
    Vector3 point = Vector3::Zero();
    ClosestPoint hit;
  };
  explicit Farthest(std::size_t faces) : slot_(faces, -1) {}
  double at(int face) const { return slot_[face] < 0 ? 0 : places_[slot_[face]].distance; }
  /// What is known of a face at which at() is not 0.
  const Place& place(int face) const { return places_[slot_[face]]; }
  void raise(int face, double distance, const Vector3& point, const ClosestPoint& hit) {
    if (!(distance > at(face))) return;
    if (slot_[face] < 0) slot_[face] = static_cast<int>(places_.size()), places_.emplace_back();
    places_[slot_[face]] = {distance, point, hit};
  }
  /// The `n` faces with the largest distances, of equal ones the lower first; fewer when fewer are known.
  std::vector<int> first(std::size_t n) const {
    std::vector<int> faces;
    for (std::size_t f = 0; f < slot_.size(); ++f)
      if (slot_[f] >= 0) faces.push_back(static_cast<int>(f));
    const auto end = faces.begin() + static_cast<std::ptrdiff_t>(std::min(n, faces.size()));
    std::partial_sort(faces.begin(), end, faces.end(),
                      [&](int a, int b) { return at(a) != at(b) ? at(a) > at(b) : a < b; });
    faces.erase(end, faces.end());
    return faces;
  }

 private:
  std::vector<int> slot_;
  std::vector<Place> places_;
};

/// Distances from one surface to another, one way.
class OneWay {
 public:
  // settled: a distance known to be below it is not told exactly.
  OneWay(const Surface& from, const ClosestPointTree& tree, int to_faces, double settled,
         const RunContext& context)
      : from_face(from.faces.size()),
        to_face(to_faces),
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
        hits[i] = closest(samples[i].point);
    });
    context_.checkpoint();
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += keep(samples[i].point, samples[i].face, hits[i]);
    return n > 0 ? sum / n : 0;
  }

  // Climbs inside the faces with the largest distances from the farthest point known of each.
  void climb_from_the_top(int samples, double spacing, double finest) {
    const auto climbs =
        static_cast<std::size_t>(std::clamp(samples / kSamplesForAClimb, kFewestClimbs, kMostClimbs));
    int done = 0;
    for (int face : from_face.first(climbs)) {
      if (done++ % 16 == 0) context_.checkpoint();
      if (from_face.at(face) > settled_) climb(face, spacing, finest);
    }
  }

  double max = 0;
  Vector3 worst = Vector3::Zero();
  Farthest from_face, to_face;

 private:
  ClosestPoint closest(const Vector3& point) const {
    return tree_.closest(point, std::numeric_limits<double>::infinity(), settled_ * settled_);
  }

  double keep(const Vector3& point, int face, const ClosestPoint& hit) {
    const double d = std::sqrt(hit.squared_distance);
    from_face.raise(face, d, point, hit);
    if (hit.face >= 0) to_face.raise(hit.face, d, point, hit);
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
          const Eigen::Vector2d w =
              inverse * (sides.transpose() * (from_face.place(face).point + step * way - a));
          const Vector3 trial = clamped_point(a, b, c, {1 - w.sum(), w[0], w[1]});
          const double before = from_face.at(face);
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

// What to measure at besides evenly spread samples, and where to stop.
struct Extra {
  std::vector<Sample> vertices, midpoints;
  double finest;   // step of the climbs
  double settled;  // of OneWay
};

// Measures, and gives the mean distance too.
std::pair<OneWay, double> measure_one_way(const Surface& from, const ClosestPointTree& tree, int to_faces,
                                          int samples, const Extra& extra, const RunContext& context) {
  OneWay way(from, tree, to_faces, extra.settled, context);
  double area = 0;
  const double mean = way.measure(certificate::area_samples(from.points, from.faces, samples, &area));
  way.measure(extra.midpoints);
  way.measure(extra.vertices);
  way.climb_from_the_top(samples, std::sqrt(area / std::max(1, samples)), extra.finest);
  return {std::move(way), mean};
}

}  // namespace

DistanceReport measure_distance(const std::vector<Vector3>& points,
                                const std::vector<std::array<int, 3>>& input_faces,
                                const ClosestPointTree& tree, const StripMesh& result, int samples,
                                RunContext& context, double far_limit) {
  std::vector<std::array<int, 3>> faces;
  std::vector<int> patch_of;
  for (std::size_t p = 0; p < result.patches.size(); ++p)
    for (const StripMesh::Triangle& t : result.patches[p].triangles) {
      faces.push_back(t.v);
      patch_of.push_back(static_cast<int>(p));
    }
  DistanceReport report;
  report.patch_error.assign(result.patches.size(), 0);
  if (faces.empty() || input_faces.empty()) return report;
  const Surface in{points, input_faces}, out{result.points, faces};
  const double finest = kFinestStep * tree.diagonal();
  const double settled = std::isfinite(far_limit) ? kSettled * far_limit : 0;
  const ClosestPointTree result_tree(result.points, faces, context);
  context.checkpoint();
  const int in_count = static_cast<int>(input_faces.size()), out_count = static_cast<int>(faces.size());
  const std::vector<Sample> vertices = std::isfinite(far_limit)
                                           ? far_vertex_samples(in, tree, result_tree, settled, context)
                                           : vertex_samples(in);
  const auto [to, to_mean] =
      measure_one_way(in, result_tree, out_count, samples, {vertices, {}, finest, settled}, context);
  const auto [back, back_mean] = measure_one_way(
      out, tree, in_count, samples, {vertex_samples(out), midpoint_samples(out), finest, settled}, context);
  report.input_to_result = to.max, report.result_to_input = back.max;
  report.mean = (to_mean + back_mean) / 2;
  report.worst_place = to.max >= back.max ? to.worst : back.worst;
  for (int f = 0; f < out_count; ++f) {
    double& error = report.patch_error[patch_of[f]];
    const double above = to.to_face.at(f), own = back.from_face.at(f);
    error = std::max({error, above, own});
    if (above > far_limit) {
      const Farthest::Place& p = to.to_face.place(f);
      report.far.push_back({faces[f], p.hit.barycentric, p.point, above});
    }
    if (own > far_limit) {
      const Farthest::Place& p = back.from_face.place(f);
      report.far.push_back({faces[f], barycentric(result.points, faces[f], p.point), p.hit.point, own});
    }
  }
  return report;
}

DistanceReport measure_distance(const TriangleSoup& input, const ClosestPointTree& tree,
                                const StripMesh& result, int samples, RunContext& context, double far_limit) {
  return measure_distance(input.points, input.faces, tree, result, samples, context, far_limit);
}

}  // namespace sheetform
