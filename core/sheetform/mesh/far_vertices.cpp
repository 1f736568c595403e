#include "sheetform/mesh/far_vertices.h"

#include <algorithm>

#include "sheetform/base/parallel_groups.h"

namespace sheetform {
namespace {

constexpr int kGroup = 64;  // balls that a thread looks at in one go

using Part = ClosestPointTree::Part;

bool all_near(const Part& part, const ClosestPointTree& to, double limit) {
  const double room = limit - part.radius;
  return room > 0 && to.closest(part.centre, room * room, room * room).face >= 0;
}

}  // namespace

std::vector<int> far_faces(const ClosestPointTree& own, const ClosestPointTree& to, double limit,
                           const RunContext& context) {
  std::vector<int> found;
  for (std::vector<Part> open = own.parts(), next; !open.empty(); open.swap(next), next.clear()) {
    const auto n = static_cast<int>(open.size());
    std::vector<char> near(open.size());
    parallel_in_groups(context, n, kGroup, [&](int i) { near[i] = all_near(open[i], to, limit); });
    for (int i = 0; i < n; ++i) {
      if (near[i]) continue;
      if (!open[i].leaf()) own.append_parts(open[i], next);
      for (int k = 0; k < open[i].count; ++k) found.push_back(own.face_of(open[i], k));
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<FarVertex> far_vertices(const std::vector<std::array<int, 3>>& faces, const ClosestPointTree& own,
                                    const ClosestPointTree& to, double limit, const RunContext& context) {
  std::vector<FarVertex> found;
  for (int f : far_faces(own, to, limit, context))
    for (int v : faces[f]) found.push_back({v, f});
  std::sort(found.begin(), found.end(), [](const FarVertex& a, const FarVertex& b) {
    return a.vertex != b.vertex ? a.vertex < b.vertex : a.face < b.face;
  });
  found.erase(std::unique(found.begin(), found.end(),
                          [](const FarVertex& a, const FarVertex& b) { return a.vertex == b.vertex; }),
              found.end());
  return found;
}

}  // namespace sheetform
