#include "sheetform/search/measure_attempt.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "sheetform/search/patch_tilt.h"
#include "sheetform/strip/mirror_distance.h"
#include "sheetform/strip/patch_shape.h"

namespace sheetform {
namespace {

// Distances beyond the limit are found to a thousandth of it: what is below this share of e_max meets it.
constexpr double kMeasured = 0.998;
// Beyond this multiple of the tolerance rulings become plainer at once.
constexpr double kHard = 1.1;
constexpr double kLeastShare = 0.05;  // a point of a triangle with less of a place is not to blame for it

}  // namespace

AttemptMeasure::AttemptMeasure(const ComponentInput& input, const ClosestPointTree& tree,
                               const ComponentParams& params, RunContext& context)
    : input_(input),
      tree_(tree),
      params_(params),
      context_(context),
      heights_(against().points, against().faces, tree_against().diagonal(), context) {}

Attempt AttemptMeasure::measured(FinishedLayout finished, const EvaluationParams& evaluation) const {
  Attempt attempt;
  attempt.finished = std::move(finished);
  attempt.evaluation = evaluation;
  const std::vector<int>& failing = attempt.finished.failing;
  if (attempt.has_gaps()) {  // around them distances would be those to other patches
    attempt.invalid = failing;
    return attempt;
  }
  attempt.strips = assemble_strips(attempt.finished.source);
  attempt.uneven = spacing_miss(attempt.strips, params_.spacing);
  const auto parts = static_cast<int>(attempt.strips.patches.size());
  std::vector<char> is_invalid(parts, 0);
  parallel_for(context_, parts, [&](int p) {
    is_invalid[p] =
        std::binary_search(failing.begin(), failing.end(), p) || !check_patch(attempt.strips, p, 1.0).empty();
  });
  for (int p = 0; p < parts; ++p)
    if (is_invalid[p]) attempt.invalid.push_back(p);
  DistanceReport d = far_places(attempt.strips);
  attempt.distance = d.hausdorff();
  attempt.miss = attempt.distance / params_.evaluation.e_max;
  attempt.far = std::move(d.far);
  attempt.error = std::move(d.patch_error);
  for (double& error : attempt.error) error /= params_.evaluation.e_max;
  for (int p = 0; p < parts; ++p)
    if (attempt.error[p] > kMeasured && is_invalid[p] == 0) {
      attempt.too_far.push_back(p);
      if (attempt.error[p] > kHard) attempt.hard.push_back(p);
    }
  measure_tilt(attempt);
  return attempt;
}

DistanceReport AttemptMeasure::far_places(const StripMesh& strips) const {
  const double limit = params_.margin * params_.evaluation.e_max;
  return (is_half() ? find_far_with_image : find_far)(against(), tree_against(), heights_, strips, limit,
                                                      context_);
}

NormalReport AttemptMeasure::tilts(const StripMesh& strips) const {
  const TriangleSoup& input = against();
  if (is_half())
    return measure_normals_with_image(input, tree_against(), strips, kCertificateSamples, context_);
  return measure_normals(input.points, input.faces, tree_against(), strips, kCertificateSamples, context_);
}

// Takes the normal deviation into the attempt; while it is not met, all larger patches that exceed it are
// too far.
void AttemptMeasure::measure_tilt(Attempt& attempt) const {
  const double limit = params_.evaluation.normal_deviation * params_.margin;
  if (limit <= 0) return;
  const NormalReport normals = tilts(attempt.strips);
  attempt.miss = std::max(attempt.miss, normals.quantile / limit);
  if (normals.quantile <= limit) return;
  const std::vector<double> area = strip_areas(attempt.strips);
  const double least = kLeastTiltedShare * std::accumulate(area.begin(), area.end(), 0.0);
  for (std::size_t p = 0; p < area.size(); ++p)
    if (area[p] > least && normals.patch_quantile[p] > limit) {
      attempt.too_far.push_back(static_cast<int>(p));
      attempt.error[p] = std::max(attempt.error[p], normals.patch_quantile[p] / limit);
    }
  std::sort(attempt.too_far.begin(), attempt.too_far.end());
  attempt.too_far.erase(std::unique(attempt.too_far.begin(), attempt.too_far.end()), attempt.too_far.end());
}

std::vector<int> AttemptMeasure::points_beyond(const Attempt& attempt) const {
  std::vector<int> points;
  for (const FarPlace& far : attempt.far)
    for (int k = 0; k < 3 && far.distance > kMeasured * params_.evaluation.e_max; ++k)
      if (far.barycentric[k] > kLeastShare) points.push_back(far.triangle[k]);
  return points;
}

std::vector<double> strip_areas(const StripMesh& strips) {
  std::vector<double> areas;
  for (const StripMesh::Patch& patch : strips.patches) areas.push_back(patch_area(strips, patch));
  return areas;
}

}  // namespace sheetform
