// The two-sided distance: evenly spread samples for its mean, branch and bound for its largest.
#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>

#include "sheetform/mesh/far_vertices.h"
#include "sheetform/strip/certificate.h"
#include "sheetform/strip/one_way_distance.h"

namespace sheetform {
namespace {

using certificate::Farthest;
using certificate::OneWayDistance;
using certificate::Strips;
using certificate::Surface;

// The largest distance is found to this fraction of the diagonal.
constexpr double kFinest = 2e-5;
// Splits each way, once what was promised is proven: enough to find the largest distance at 2 %.
constexpr int kFewSplits = 20000;
// Where only places beyond a limit are asked for, what is known to be nearer than this share of it is not
// measured exactly.
constexpr double kSettled = 0.6;

// Samples each way that often show that all is not within the limit; once a place so far beyond it is known,
// the others need not all be found, and so many splits each way do.
constexpr int kGlances = 4000, kSplitsOnceFar = 2000;
constexpr double kFarBeyond = 1.04;

Vector3 barycentric(const std::vector<Vector3>& points, const std::array<int, 3>& t, const Vector3& p) {
  Eigen::Matrix<double, 3, 2> sides;
  sides << points[t[1]] - points[t[0]], points[t[2]] - points[t[0]];
  const Eigen::Matrix2d gram = sides.transpose() * sides;
  if (!(gram.determinant() > 0)) return {1, 0, 0};
  const Eigen::Vector2d w = gram.inverse() * (sides.transpose() * (p - points[t[0]]));
  return {1 - w.sum(), w[0], w[1]};
}

DistanceReport report_of(const StripMesh& result, const Strips& strips, const OneWayDistance& to,
                         const OneWayDistance& back, double far_limit) {
  DistanceReport report;
  report.input_to_result = to.max, report.result_to_input = back.max;
  report.at_most = std::max(to.at_most, back.at_most);
  report.worst_place = to.max >= back.max ? to.worst : back.worst;
  report.patch_error.assign(result.patches.size(), 0);
  for (int f = 0; f < static_cast<int>(strips.faces.size()); ++f) {
    double& error = report.patch_error[strips.patch_of[f]];
    const double above = to.to_face.at(f), own = back.from_face.at(f);
    error = std::max({error, above, own});
    if (above > far_limit) {
      const Farthest::Place& p = to.to_face.place(f);
      report.far.push_back({strips.faces[f], p.hit.barycentric, p.point, above});
    }
    if (own > far_limit) {
      const Farthest::Place& p = back.from_face.place(f);
      report.far.push_back(
          {strips.faces[f], barycentric(result.points, strips.faces[f], p.point), p.hit.point, own});
    }
  }
  return report;
}

std::vector<int> all_of(const std::vector<std::array<int, 3>>& faces) {
  std::vector<int> out(faces.size());
  std::iota(out.begin(), out.end(), 0);
  return out;
}

}  // namespace

DistanceReport certificate::measure_distance(const std::vector<Vector3>& points,
                                             const std::vector<std::array<int, 3>>& faces,
                                             const ClosestPointTree& tree, const StripMesh& result,
                                             int samples, RunContext& context, double promised,
                                             SampleHits& hits) {
  const Strips strips(result);
  if (strips.faces.empty() || faces.empty()) return {};
  const Surface in{points, faces}, out{result.points, strips.faces};
  const ClosestPointTree result_tree(result.points, strips.faces, context);
  context.checkpoint();
  std::optional<HeightBound> over_input, over_result;
  const std::array<std::function<void()>, 4> needed{
      [&] { over_input.emplace(points, faces, tree.diagonal(), context); },
      [&] { hits.on_input = area_samples(points, faces, samples); },
      [&] { hits.on_result = area_samples(result.points, strips.faces, samples); },
      [&] { over_result.emplace(result.points, strips.faces, result_tree.diagonal(), context); }};
  parallel_for(context, static_cast<int>(needed.size()), [&](int i) { needed[i](); });
  OneWayDistance to(in, out, result_tree, &*over_result, 0, context),
      back(out, in, tree, &*over_input, 0, context);
  const double mean_to = to.measure(hits.on_input, &hits.to_result),
               mean_back = back.measure(hits.on_result, &hits.to_input);
  for (OneWayDistance* way : {&to, &back})
    way->find_largest({.finest = kFinest * tree.diagonal(),
                       .settled = promised,
                       .splits = kCertificateSplits,
                       .few_splits = kFewSplits});
  DistanceReport report = report_of(result, strips, to, back, std::numeric_limits<double>::infinity());
  report.mean = (mean_to + mean_back) / 2;
  return report;
}

DistanceReport measure_distance(const std::vector<Vector3>& points,
                                const std::vector<std::array<int, 3>>& faces, const ClosestPointTree& tree,
                                const StripMesh& result, int samples, RunContext& context, double promised) {
  certificate::SampleHits hits;
  return certificate::measure_distance(points, faces, tree, result, samples, context, promised, hits);
}

DistanceReport measure_distance(const TriangleSoup& input, const ClosestPointTree& tree,
                                const StripMesh& result, int samples, RunContext& context, double promised) {
  return measure_distance(input.points, input.faces, tree, result, samples, context, promised);
}

DistanceReport find_far(const TriangleSoup& input, const ClosestPointTree& tree,
                        const HeightBound& over_input, const StripMesh& result, double limit,
                        RunContext& context) {
  const Strips strips(result);
  if (strips.faces.empty() || input.faces.empty()) return {};
  const Surface in{input.points, input.faces}, out{result.points, strips.faces};
  const ClosestPointTree result_tree(result.points, strips.faces, context);
  context.checkpoint();
  const double enough = kSettled * limit;
  const HeightBound over_result(result.points, strips.faces, result_tree.diagonal(), context);
  OneWayDistance to(in, out, result_tree, &over_result, enough, context),
      back(out, in, tree, &over_input, enough, context);
  to.measure(certificate::area_samples(in.points, in.faces, kGlances));
  back.measure(certificate::area_samples(out.points, out.faces, kGlances));
  const int splits = std::max(to.max, back.max) > kFarBeyond * limit ? kSplitsOnceFar : kCertificateSplits;
  const std::vector<int> from_input = far_faces(tree, result_tree, limit, context),
                         from_result = all_of(strips.faces);
  certificate::find_beyond({{{to, from_input}, {back, from_result}}}, limit, splits, context);
  return report_of(result, strips, to, back, limit);
}

}  // namespace sheetform
