#include "sheetform/search/detail_points.h"

#include <algorithm>
#include <cmath>

#include "sheetform/mesh/far_vertices.h"

namespace sheetform {
namespace {

constexpr double kLeast = 0.06;  // of the tolerance

// Vertices of the input that may be farther than `least` from the working mesh. Of a half those on the side
// of its image too, mirrored.
std::vector<Vector3> far_from(const ComponentInput& input, const ClosestPointTree& tree,
                              const SearchSurface& surface, const ClosestPointTree& working, double least,
                              RunContext& context) {
  std::vector<Vector3> far;
  if (input.whole.faces.empty()) {
    for (const FarVertex& f : far_vertices(input.reference.faces, tree, working, least, context))
      far.push_back(input.reference.points[f.vertex]);
    return far;
  }
  const SurfaceMesh both = with_mirror_image(surface.mesh, surface.plane);
  const ClosestPointTree tree_of_both(both.points, both.faces, context);
  for (const FarVertex& f :
       far_vertices(input.whole.faces, *input.whole_tree, tree_of_both, least, context)) {
    const Vector3& p = input.whole.points[f.vertex];
    far.emplace_back(std::abs(p.x()), p.y(), p.z());
  }
  return far;
}

}  // namespace

std::vector<DetailPoint> detail_points(const ComponentInput& input, const ClosestPointTree& tree,
                                       const SearchSurface& surface, double e_max, RunContext& context) {
  std::vector<DetailPoint> details;
  if (!input.prepared.remeshed && input.whole.faces.empty()) return details;
  const ClosestPointTree working(surface.mesh.points, surface.mesh.faces, context);
  const double least = kLeast * e_max;
  const std::vector<Vector3> may_be_far = far_from(input, tree, surface, working, least, context);
  for (std::size_t i = 0; i < may_be_far.size(); ++i) {
    if (i % 4096 == 0) context.checkpoint();
    const Vector3& p = may_be_far[i];
    const ClosestPoint hit = working.closest(p);
    if (hit.squared_distance > least * least) details.push_back({p, hit.barycentric, hit.face});
  }
  std::stable_sort(details.begin(), details.end(),
                   [](const DetailPoint& a, const DetailPoint& b) { return a.face < b.face; });
  return details;
}

}  // namespace sheetform
