#include "sheetform/mesh/far_vertices.h"

#include <algorithm>

namespace sheetform {
namespace {

constexpr int kOftenEnough = 4096;  // balls between two looks at whether to stop

using Part = ClosestPointTree::Part;

bool all_near(const Part& part, const ClosestPointTree& to, double limit) {
  const double room = limit - part.radius;
  return room > 0 && to.closest(part.centre, room * room, room * room).face >= 0;
}

}  // namespace

std::vector<int> far_faces(const ClosestPointTree& own, const ClosestPointTree& to, double limit,
                           const RunContext& context) {
  std::vector<int> found;
  std::vector<Part> open = own.parts();
  for (int looked = 0; !open.empty(); ++looked) {
    if (looked % kOftenEnough == 0) context.checkpoint();
    const Part part = open.back();
    open.pop_back();
    if (all_near(part, to, limit)) continue;
    if (!part.leaf()) own.append_parts(part, open);
    for (int i = 0; i < part.count; ++i) found.push_back(own.face_of(part, i));
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
