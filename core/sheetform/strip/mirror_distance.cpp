#include "sheetform/strip/mirror_distance.h"

#include <algorithm>

#include "sheetform/strip/mirror.h"

namespace sheetform {
namespace {

// The point of the half that each point of the whole is, or is the image of; images follow in the same order.
std::vector<int> points_of_half(const StripMesh& half, const StripMesh& whole) {
  std::vector<int> of(whole.points.size());
  for (std::size_t p = 0; p < half.patches.size(); ++p) {
    const auto& own = half.patches[p].boundary;
    const auto& image = whole.patches[half.patches.size() + p].boundary;
    const std::size_t n = own.size();
    for (std::size_t i = 0; i < n; ++i) of[own[i]] = of[image[(n - i) % n]] = own[i];
  }
  return of;
}

// Per patch of the half: the larger one of its own value and that of its image.
std::vector<double> larger(const std::vector<double>& whole, std::size_t patches) {
  std::vector<double> out(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(patches));
  for (std::size_t p = 0; p < patches; ++p) out[p] = std::max(out[p], whole[patches + p]);
  return out;
}

}  // namespace

DistanceReport find_far_with_image(const TriangleSoup& whole, const ClosestPointTree& tree,
                                   const HeightBound& over_whole, const StripMesh& half, double limit,
                                   RunContext& context) {
  const StripMesh both = with_mirror_image(half);
  DistanceReport report = find_far(whole, tree, over_whole, both, limit, context);
  if (report.patch_error.empty()) return report;
  report.patch_error = larger(report.patch_error, half.patches.size());
  const std::vector<int> of = points_of_half(half, both);
  const auto own = static_cast<int>(half.points.size());
  for (FarPlace& place : report.far) {
    const bool image =
        std::any_of(place.triangle.begin(), place.triangle.end(), [&](int v) { return v >= own; });
    for (int& v : place.triangle) v = of[v];
    if (image) place.on_input.x() *= -1;
  }
  return report;
}

NormalReport measure_normals_with_image(const TriangleSoup& whole, const ClosestPointTree& tree,
                                        const StripMesh& half, int samples, RunContext& context) {
  NormalReport report =
      measure_normals(whole.points, whole.faces, tree, with_mirror_image(half), samples, context);
  report.patch_quantile = larger(report.patch_quantile, half.patches.size());
  return report;
}

}  // namespace sheetform
