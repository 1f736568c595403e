#include <algorithm>
#include <map>

#include "sheetform/mesh/creases.h"

namespace sheetform {
namespace {

constexpr int kMostPasses = 20;
constexpr double kLongShare = 0.3;   // of the outline: a line that a region may be opened along
constexpr double kMostBeyond = 2.1;  // radians between what lies beyond two lines; more: a thin plate's wall

struct Regions {
  std::vector<int> of_face;
  std::vector<double> area, outline;
  bool narrow(int r, double width) const { return 2 * area[r] < width * outline[r]; }
};

Regions regions_between(const SurfaceMesh& mesh, const std::vector<char>& crease) {
  Regions r;
  r.of_face.assign(mesh.faces.size(), -1);
  for (int seed = 0; seed < mesh.face_count(); ++seed) {
    if (r.of_face[seed] >= 0) continue;
    const int id = static_cast<int>(r.area.size());
    r.area.push_back(0), r.outline.push_back(0);
    std::vector<int> stack{seed};
    r.of_face[seed] = id;
    while (!stack.empty()) {
      const int f = stack.back();
      stack.pop_back();
      r.area[id] += mesh.face_normal_raw(f).norm() / 2;
      for (int k = 0; k < 3; ++k) {
        const int e = mesh.face_edges[f][k], next = mesh.face_neighbours[f][k];
        if (next < 0 || crease[e])
          r.outline[id] += mesh.edge_length(e);
        else if (r.of_face[next] < 0)
          r.of_face[next] = id, stack.push_back(next);
      }
    }
  }
  return r;
}

// What two regions have in common.
struct Line {
  double length = 0, turning = 0;
  Vector3 beyond = Vector3::Zero();  // normals of the other region along it
  std::vector<int> edges;
};

std::vector<std::map<int, Line>> lines_around(const SurfaceMesh& mesh, const std::vector<char>& crease,
                                              const Regions& regions) {
  std::vector<std::map<int, Line>> lines(regions.area.size());
  for (int e = 0; e < mesh.edge_count(); ++e) {
    const auto& edge = mesh.edges[e];
    if (edge.border() || !crease[e]) continue;
    const int a = regions.of_face[edge.f0], b = regions.of_face[edge.f1];
    if (a == b) continue;
    const double length = mesh.edge_length(e);
    const Vector3 na = mesh.face_normal_raw(edge.f0), nb = mesh.face_normal_raw(edge.f1);
    for (Line* line : {&lines[a][b], &lines[b][a]}) {
      line->length += length, line->turning += length * angle_between(na, nb);
      line->beyond += length * (line == &lines[a][b] ? nb : na).normalized();
      line->edges.push_back(e);
    }
  }
  return lines;
}

// The line over which a narrow region joins a wide one; null where it has none.
const Line* line_to_open(const std::map<int, Line>& lines, int region, const Regions& regions, double width) {
  const Line* best = nullptr;
  for (const auto& [other, line] : lines) {
    if (line.length < kLongShare * regions.outline[region]) continue;
    for (const auto& [third, next] : lines)
      if (next.length >= kLongShare * regions.outline[region] &&
          angle_between(line.beyond, next.beyond) > kMostBeyond)
        return nullptr;
    if (regions.narrow(other, width)) continue;
    if (best == nullptr || line.turning * best->length < best->turning * line.length) best = &line;
  }
  return best;
}

}  // namespace

std::vector<char> without_narrow_regions(const SurfaceMesh& mesh, std::vector<char> crease, double width) {
  const Regions before = regions_between(mesh, crease);
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const Regions regions = regions_between(mesh, crease);
    const std::vector<std::map<int, Line>> lines = lines_around(mesh, crease, regions);
    bool any = false;
    for (int r = 0; r < static_cast<int>(regions.area.size()); ++r) {
      const Line* line = regions.narrow(r, width) ? line_to_open(lines[r], r, regions, width) : nullptr;
      if (line == nullptr) continue;
      for (int e : line->edges) crease[e] = 0;
      any = true;
    }
    if (!any) break;
  }
  // Lines between two that have joined the same third one.
  const Regions after = regions_between(mesh, crease);
  for (int e = 0; e < mesh.edge_count(); ++e) {
    const auto& edge = mesh.edges[e];
    if (!edge.border() && after.of_face[edge.f0] == after.of_face[edge.f1] &&
        before.of_face[edge.f0] != before.of_face[edge.f1])
      crease[e] = 0;
  }
  return crease;
}

}  // namespace sheetform
