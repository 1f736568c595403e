#include "refine.h"

#include <cmath>
#include <vector>

#include "sheetform/mesh/creases.h"
#include "sheetform/mesh/mesh_repair.h"
#include "sheetform/mesh/prepare.h"

namespace sheetform::bench {
namespace {

constexpr double kFold = 40;  // degrees: the default of the program

std::vector<char> sharp_edges(const SurfaceMesh& mesh) {
  std::vector<char> sharp = detect_creases(mesh, kFold);
  for (int e = 0; e < mesh.edge_count(); ++e) sharp[e] |= mesh.edges[e].border();
  return sharp;
}

int opposite(const SurfaceMesh& mesh, int f, const SurfaceMesh::Edge& edge) {
  for (int v : mesh.faces[f])
    if (v != edge.v0 && v != edge.v1) return v;
  return edge.v0;
}

Vector3 edge_point(const SurfaceMesh& mesh, const std::vector<char>& sharp, int e) {
  const auto& edge = mesh.edges[e];
  const Vector3 middle = (mesh.points[edge.v0] + mesh.points[edge.v1]) / 2;
  if (sharp[e]) return middle;
  return 0.75 * middle +
         0.125 * (mesh.points[opposite(mesh, edge.f0, edge)] + mesh.points[opposite(mesh, edge.f1, edge)]);
}

Vector3 vertex_point(const SurfaceMesh& mesh, const std::vector<char>& sharp, int v) {
  Vector3 all = Vector3::Zero(), line = Vector3::Zero();
  int count = 0, lines = 0;
  for (const int* e = mesh.ring_begin_of(v); e != mesh.ring_end_of(v); ++e) {
    const Vector3& other = mesh.points[mesh.edges[*e].other(v)];
    all += other, ++count;
    if (sharp[*e]) line += other, ++lines;
  }
  if (lines == 2) return 0.75 * mesh.points[v] + 0.125 * line;
  if (lines > 0) return mesh.points[v];
  const double c = 0.375 + 0.25 * std::cos(2 * M_PI / count), weight = 0.625 - c * c;
  return (1 - weight) * mesh.points[v] + weight / count * all;
}

SurfaceMesh finer(const SurfaceMesh& mesh, const std::vector<char>& sharp) {
  std::vector<Vector3> points;
  std::vector<std::array<int, 3>> faces;
  for (int v = 0; v < mesh.vertex_count(); ++v) points.push_back(vertex_point(mesh, sharp, v));
  for (int e = 0; e < mesh.edge_count(); ++e) points.push_back(edge_point(mesh, sharp, e));
  for (int f = 0; f < mesh.face_count(); ++f) {
    const auto& corner = mesh.faces[f];
    std::array<int, 3> middle{};
    for (int k = 0; k < 3; ++k) middle[k] = mesh.vertex_count() + mesh.face_edges[f][k];
    for (int k = 0; k < 3; ++k) faces.push_back({corner[k], middle[k], middle[(k + 2) % 3]});
    faces.push_back(middle);
  }
  return build_surface_mesh(std::move(points), std::move(faces));
}

// The halves of sharp edges of `mesh`, as edges of finer(mesh).
std::vector<char> sharp_halves(const SurfaceMesh& mesh, const std::vector<char>& sharp,
                               const SurfaceMesh& fine) {
  std::vector<char> halves(fine.edges.size(), 0);
  for (int e = 0; e < fine.edge_count(); ++e) {
    const int middle = fine.edges[e].v1 - mesh.vertex_count();  // the higher of the two
    if (fine.edges[e].v0 < mesh.vertex_count()) halves[e] = sharp[middle];
  }
  return halves;
}

}  // namespace

TriangleSoup refined(const TriangleSoup& soup, int times) {
  SurfaceMesh mesh = repair(soup).mesh;
  std::vector<char> sharp = sharp_edges(mesh);
  for (int i = 0; i < times; ++i) {
    SurfaceMesh fine = finer(mesh, sharp);
    sharp = sharp_halves(mesh, sharp, fine);
    mesh = std::move(fine);
  }
  return {std::move(mesh.points), std::move(mesh.faces)};
}

TriangleSoup remeshed(const TriangleSoup& soup, int faces) {
  const SurfaceMesh mesh = repair(soup).mesh;
  const PreparedMesh prepared = prepare(mesh, detect_creases(mesh, kFold), edge_length_for(mesh, faces), {});
  return {prepared.mesh.points, prepared.mesh.faces};
}

}  // namespace sheetform::bench
