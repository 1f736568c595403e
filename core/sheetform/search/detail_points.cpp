#include "sheetform/search/detail_points.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "sheetform/mesh/far_vertices.h"

namespace sheetform {
namespace {

constexpr double kLeast = 0.06;  // of the tolerance

bool before(const DetailPoint& a, const DetailPoint& b) {
  return std::make_tuple(a.face, a.point.x(), a.point.y(), a.point.z()) <
         std::make_tuple(b.face, b.point.x(), b.point.y(), b.point.z());
}

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

DetailPoints detail_points(const ComponentInput& input, const ClosestPointTree& tree,
                           const SearchSurface& surface, double e_max, RunContext& context) {
  if (!input.prepared.remeshed && input.whole.faces.empty()) return nullptr;
  std::vector<DetailPoint> details;
  const ClosestPointTree working(surface.mesh.points, surface.mesh.faces, context);
  const double least = kLeast * e_max;
  const std::vector<Vector3> may_be_far = far_from(input, tree, surface, working, least, context);
  for (std::size_t i = 0; i < may_be_far.size(); ++i) {
    if (i % 4096 == 0) context.checkpoint();
    const Vector3& p = may_be_far[i];
    const ClosestPoint hit = working.closest(p);
    if (hit.squared_distance > least * least) details.push_back({p, hit.barycentric, hit.face});
  }
  if (details.empty()) return nullptr;
  std::sort(details.begin(), details.end(), before);
  return std::make_shared<const std::vector<DetailPoint>>(std::move(details));
}

std::vector<DetailPoint> followed(const SurfaceMesh& mesh, const std::vector<char>& moved,
                                  std::vector<DetailPoint> details) {
  for (DetailPoint& d : details) {
    const auto& t = mesh.faces[d.face];
    if (!moved[t[0]] && !moved[t[1]] && !moved[t[2]]) continue;
    const ClosestPoint now = closest_from(mesh, d.face, d.point);
    d.face = now.face, d.barycentric = now.barycentric;
  }
  std::sort(details.begin(), details.end(), before);
  return details;
}

std::vector<int> faces_that_differ(const std::vector<DetailPoint>& one,
                                   const std::vector<DetailPoint>& other) {
  std::vector<int> faces;
  const auto same = [](const DetailPoint& a, const DetailPoint& b) {
    return a.face == b.face && a.point == b.point && a.barycentric == b.barycentric;
  };
  auto a = one.begin(), b = other.begin();
  while (a != one.end() || b != other.end()) {
    const int face = b == other.end() || (a != one.end() && a->face < b->face) ? a->face : b->face;
    const auto beyond = [&](auto from, auto end) {
      return std::find_if(from, end, [&](const DetailPoint& d) { return d.face > face; });
    };
    const auto a_end = beyond(a, one.end()), b_end = beyond(b, other.end());
    if (!std::equal(a, a_end, b, b_end, same)) faces.push_back(face);
    a = a_end, b = b_end;
  }
  return faces;
}

}  // namespace sheetform
