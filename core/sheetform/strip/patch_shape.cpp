#include "sheetform/strip/patch_shape.h"

#include <algorithm>

namespace sheetform {
namespace {

using Pair = std::array<int, 2>;

void gather_vertices(const StripMesh::Patch& patch, PatchShape& s) {
  for (const StripMesh::Triangle& t : patch.triangles)
    for (int k = 0; k < 3; ++k) s.vertices.push_back({t.v[k], t.vt[k]});
  std::sort(s.vertices.begin(), s.vertices.end());
  s.vertices.erase(std::unique(s.vertices.begin(), s.vertices.end()), s.vertices.end());
  for (const StripMesh::Triangle& t : patch.triangles) {
    Triple face;
    for (int k = 0; k < 3; ++k) {
      const auto it = std::lower_bound(s.vertices.begin(), s.vertices.end(), Pair{t.v[k], t.vt[k]});
      face[k] = static_cast<int>(it - s.vertices.begin());
    }
    s.faces.push_back(face);
  }
}

// Follows the border of a manifold with one loop, along the faces' orientation.
void walk_border(PatchShape& s) {
  std::vector<int> next(s.vertices.size(), -1);
  int start = -1;
  for (const EdgeTable::Edge& e : s.table.edges) {
    if (e.count != 1) continue;
    const EdgeTable::Use& u = s.table.use(e, 0);
    next[u.a] = u.b;
    if (start < 0) start = u.a;
  }
  if (start < 0) return;
  int at = start;
  do {
    s.loop.push_back(at);
    at = next[at];
  } while (at != start && at >= 0 && s.loop.size() <= s.vertices.size());
}

void find_inner(PatchShape& s) {
  std::vector<char> rim(s.vertices.size(), 0);
  for (const EdgeTable::Edge& e : s.table.edges)
    if (e.count == 1) rim[e.a] = rim[e.b] = 1;
  for (std::size_t v = 0; v < rim.size(); ++v)
    if (!rim[v]) s.inner.push_back(static_cast<int>(v));
}

}  // namespace

std::vector<int> PatchShape::loop_points() const {
  std::vector<int> out;
  for (int i : loop) out.push_back(vertices[i][0]);
  return out;
}

std::vector<int> PatchShape::loop_uvs() const {
  std::vector<int> out;
  for (int i : loop) out.push_back(vertices[i][1]);
  return out;
}

PatchShape shape_of(const StripMesh::Patch& patch) {
  PatchShape s;
  gather_vertices(patch, s);
  s.table = EdgeTable(s.faces);
  s.topology = topology_of(s.faces, s.table, static_cast<int>(s.vertices.size()));
  const Topology& t = s.topology;
  const auto inner_edges =
      std::count_if(s.table.edges.begin(), s.table.edges.end(), [](const auto& e) { return e.count > 1; });
  s.tree = t.components == 1 && inner_edges == t.faces - 1;
  s.disk = t.components == 1 && t.border_loops == 1 && t.euler() == 1 && t.manifold() && t.oriented();
  if (s.disk) walk_border(s);
  find_inner(s);
  return s;
}

int place_in_loop(const std::vector<int>& listed, const std::vector<int>& loop) {
  const std::size_t n = loop.size();
  if (listed.empty() || listed.size() != n) return -1;
  for (std::size_t start = 0; start < n; ++start) {
    std::size_t along = 0;
    while (along < n && listed[along] == loop[(start + along) % n]) ++along;
    if (along == n) return static_cast<int>(start);
  }
  return -1;
}

void fill_boundary_vt(StripMesh::Patch& patch) {
  patch.boundary_vt.clear();
  const PatchShape s = shape_of(patch);
  if (!s.disk) return;
  const int start = place_in_loop(patch.boundary, s.loop_points());
  const std::vector<int> uvs = s.loop_uvs();
  for (std::size_t i = 0; start >= 0 && i < uvs.size(); ++i)
    patch.boundary_vt.push_back(uvs[(static_cast<std::size_t>(start) + i) % uvs.size()]);
}

double patch_area(const StripMesh& strips, const StripMesh::Patch& patch) {
  double twice = 0;
  for (const StripMesh::Triangle& t : patch.triangles)
    twice += (strips.points[t.v[1]] - strips.points[t.v[0]])
                 .cross(strips.points[t.v[2]] - strips.points[t.v[0]])
                 .norm();
  return twice / 2;
}

}  // namespace sheetform
