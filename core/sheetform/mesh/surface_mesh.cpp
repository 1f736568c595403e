#include "sheetform/mesh/surface_mesh.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <tuple>

#include "sheetform/base/error.h"

namespace sheetform {
namespace {

struct Side {
  int v0, v1, face, corner;
  bool forward;  // the face runs v0 -> v1
};

// By their lower vertex, which a count of the sides of each finds a place for, then within that.
std::vector<Side> sorted_sides(const std::vector<std::array<int, 3>>& faces, std::size_t vertices) {
  std::vector<std::size_t> place(vertices + 1, 0);
  for (const auto& t : faces)
    for (int k = 0; k < 3; ++k) ++place[static_cast<std::size_t>(std::min(t[k], t[(k + 1) % 3])) + 1];
  std::partial_sum(place.begin(), place.end(), place.begin());
  std::vector<Side> sides(faces.size() * 3);
  for (int f = 0; f < static_cast<int>(faces.size()); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = faces[f][k], b = faces[f][(k + 1) % 3];
      sides[place[static_cast<std::size_t>(std::min(a, b))]++] = {std::min(a, b), std::max(a, b), f, k,
                                                                  a < b};
    }
  auto begin = sides.begin();
  for (std::size_t v = 0; v < vertices; ++v) {
    const auto end = sides.begin() + static_cast<std::ptrdiff_t>(place[v]);
    std::sort(begin, end,
              [](const Side& x, const Side& y) { return std::tie(x.v1, x.face) < std::tie(y.v1, y.face); });
    begin = end;
  }
  return sides;
}

[[noreturn]] void fail(const std::string& what, const std::string& where) {
  throw Error(ErrorCode::kUnsupportedMesh, what, where, "repair the mesh before decomposing it");
}

void build_edges(SurfaceMesh& mesh) {
  const auto sides = sorted_sides(mesh.faces, mesh.points.size());
  mesh.face_edges.assign(mesh.faces.size(), {-1, -1, -1});
  mesh.face_neighbours = mesh.face_edges;
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t j = i;
    while (j < sides.size() && sides[j].v0 == sides[i].v0 && sides[j].v1 == sides[i].v1) ++j;
    const std::string where = "edge " + std::to_string(sides[i].v0) + "-" + std::to_string(sides[i].v1);
    if (sides[i].v0 == sides[i].v1) fail("a face uses a vertex twice", where);
    if (j - i > 2) fail("an edge has more than two faces", where);
    if (j - i == 2 && sides[i].forward == sides[i + 1].forward)
      fail("two neighbours are oriented oppositely", where);
    const int e = mesh.edge_count();
    mesh.edges.push_back({sides[i].v0, sides[i].v1, sides[i].face, j - i == 2 ? sides[i + 1].face : -1});
    for (std::size_t s = i; s < j; ++s) {
      mesh.face_edges[sides[s].face][sides[s].corner] = e;
      mesh.face_neighbours[sides[s].face][sides[s].corner] = mesh.edges[e].other_face(sides[s].face);
    }
    i = j;
  }
}

// Corner of face f at vertex v.
int corner_of(const SurfaceMesh& mesh, int f, int v) {
  for (int k = 0; k < 3; ++k)
    if (mesh.faces[f][k] == v) return k;
  return -1;
}

void build_rings(SurfaceMesh& mesh) {
  const int n = mesh.vertex_count();
  std::vector<int> start(n, -1), valence(n, 0);
  mesh.border_vertex.assign(n, 0);
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k)
      if (start[mesh.faces[f][k]] < 0) start[mesh.faces[f][k]] = f;
  for (const auto& e : mesh.edges) {
    ++valence[e.v0], ++valence[e.v1];
    if (e.border()) mesh.border_vertex[e.v0] = mesh.border_vertex[e.v1] = 1;
  }
  // The ring of a border vertex begins at the face whose outgoing edge (v -> next) is the border edge.
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k)
      if (mesh.edges[mesh.face_edges[f][k]].border()) start[mesh.faces[f][k]] = f;
  mesh.ring_begin.assign(n + 1, 0);
  std::partial_sum(valence.begin(), valence.end(), mesh.ring_begin.begin() + 1);
  mesh.ring_edges.assign(mesh.ring_begin[n], -1);
  for (int v = 0; v < n; ++v) {
    if (start[v] < 0) fail("a vertex belongs to no face", "vertex " + std::to_string(v));
    int at = mesh.ring_begin[v];
    for (int f = start[v], first = f; f >= 0;) {
      const int k = corner_of(mesh, f, v);
      if (at >= mesh.ring_begin[v + 1]) fail("faces meet at a vertex only", "vertex " + std::to_string(v));
      mesh.ring_edges[at++] = mesh.face_edges[f][k];
      const int e = mesh.face_edges[f][(k + 2) % 3];
      const int next = mesh.edges[e].other_face(f);
      if (next < 0 && at < mesh.ring_begin[v + 1]) mesh.ring_edges[at++] = e;
      f = next == first ? -1 : next;
    }
    if (at != mesh.ring_begin[v + 1]) fail("faces meet at a vertex only", "vertex " + std::to_string(v));
  }
}

}  // namespace

int SurfaceMesh::find_edge(int a, int b) const {
  for (const int* e = ring_begin_of(a); e != ring_end_of(a); ++e)
    if (edges[*e].other(a) == b) return *e;
  return -1;
}

SurfaceMesh build_surface_mesh(std::vector<Vector3> points, std::vector<std::array<int, 3>> faces) {
  SurfaceMesh mesh;
  mesh.points = std::move(points);
  mesh.faces = std::move(faces);
  build_edges(mesh);
  build_rings(mesh);
  return mesh;
}

double bounding_box_diagonal(const std::vector<Vector3>& points) {
  if (points.empty()) return 0;
  Vector3 lo = points[0], hi = points[0];
  for (const Vector3& p : points) lo = lo.cwiseMin(p), hi = hi.cwiseMax(p);
  return (hi - lo).norm();
}

std::vector<Vector3> vertex_normals(const SurfaceMesh& mesh) {
  std::vector<Vector3> normals(mesh.points.size(), Vector3::Zero());
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Vector3 n = mesh.face_normal_raw(f);
    for (int v : mesh.faces[f]) normals[v] += n;
  }
  for (Vector3& n : normals) {
    const double length = n.norm();
    n = length > 0 ? Vector3(n / length) : Vector3::UnitZ();
  }
  return normals;
}

double mean_edge_length(const SurfaceMesh& mesh) {
  double sum = 0;
  for (int e = 0; e < mesh.edge_count(); ++e) sum += mesh.edge_length(e);
  return mesh.edges.empty() ? 0 : sum / mesh.edge_count();
}

double surface_area(const SurfaceMesh& mesh) {
  double sum = 0;
  for (int f = 0; f < mesh.face_count(); ++f) sum += mesh.face_normal_raw(f).norm() / 2;
  return sum;
}

std::pair<std::vector<int>, int> face_components(const SurfaceMesh& mesh) {
  std::vector<int> component(mesh.faces.size(), -1), stack;
  int count = 0;
  for (int seed = 0; seed < mesh.face_count(); ++seed) {
    if (component[seed] >= 0) continue;
    stack.assign(1, seed);
    component[seed] = count;
    while (!stack.empty()) {
      const int f = stack.back();
      stack.pop_back();
      for (int e : mesh.face_edges[f]) {
        const int g = mesh.edges[e].other_face(f);
        if (g >= 0 && component[g] < 0) component[g] = count, stack.push_back(g);
      }
    }
    ++count;
  }
  return {component, count};
}

}  // namespace sheetform
