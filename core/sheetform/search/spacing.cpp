#include "sheetform/search/spacing.h"

#include <algorithm>

namespace sheetform {
namespace {

constexpr double kTighter = 1.01;  // a little more than was missed

}  // namespace

double SpacingBounds::divide(double length, double wanted) const {
  if (!any() || !(length > 0)) return wanted;
  double segments = std::max(std::round(length / wanted), 1.0);
  if (least > 0) segments = std::min(segments, std::max(std::floor(length / least), 1.0));
  return length / std::max(segments, std::ceil(length / most));
}

SpacingMiss spacing_miss(const StripMesh& strips, const SpacingBounds& bounds) {
  SpacingMiss miss;
  if (!bounds.any()) return miss;
  for (const StripMesh::Arch& arch : strips.arches) {
    const std::size_t segments = arch.vertices.size() - 1;
    const bool closed = arch.vertices.front() == arch.vertices.back();
    for (std::size_t i = 0; i < segments; ++i) {
      const Vector3 &a = strips.points[arch.vertices[i]], &b = strips.points[arch.vertices[i + 1]];
      const double length = (b - a).norm();
      if (segments > 1 && length > miss.over * bounds.most)
        miss.over = length / bounds.most, miss.over_place = (a + b) / 2;
      if (segments > (closed ? 6 : 2) && length * miss.under < bounds.least)
        miss.under = bounds.least / std::max(length, 1e-300), miss.under_place = (a + b) / 2;
    }
  }
  return miss;
}

SpacingBounds tightened(const SpacingBounds& bounds, const SpacingMiss& miss) {
  SpacingBounds out = bounds;
  if (miss.over > 1) out.most /= kTighter * miss.over;
  if (miss.under > 1) out.least *= kTighter * miss.under;
  return out;
}

}  // namespace sheetform
