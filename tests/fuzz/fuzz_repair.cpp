// Any tangle of faces on a few points (the bytes are corner numbers) becomes a manifold, and goes through all
// that prepares a mesh for the search: slivers, creases, remeshing, symmetry, halves.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "sheetform/base/error.h"
#include "sheetform/mesh/creases.h"
#include "sheetform/mesh/mesh_repair.h"
#include "sheetform/mesh/prepare.h"
#include "sheetform/mesh/symmetry.h"

namespace {

using namespace sheetform;

// 27 points of a lattice, most of them moved a little: both exact coincidences and odd angles occur.
std::vector<Vector3> lattice() {
  std::vector<Vector3> points;
  for (int i = 0; i < 27; ++i) {
    const Vector3 p(i % 3, i / 3 % 3, i / 9);
    points.push_back(i % 4 == 0 ? p
                                : Vector3(p + 0.2 * Vector3(std::sin(i), std::sin(2 * i), std::sin(3 * i))));
  }
  for (int i = 0; i < 5; ++i)
    points.push_back(points[static_cast<std::size_t>(i) * 5] + Vector3(i % 2 == 0 ? 0 : 1e-11, 0, 0));
  return points;
}

void prepare_all(const SurfaceMesh& mesh, bool mirror) {
  const RunContext context;
  const double length = bounding_box_diagonal(mesh.points) / 5;
  const SurfaceMesh clean = without_slivers(mesh, length / 100, context);
  const PreparedMesh prepared = prepare(clean, detect_creases(clean, 40), length, context);
  if (prepared.crease_edge.size() != prepared.mesh.edges.size()) std::abort();
  for (const Vector3& p : prepared.mesh.points)
    if (!p.allFinite()) std::abort();
  if (!mirror) return;  // a hundred times slower than the rest
  const ClosestPointTree tree(mesh.points, mesh.faces);
  for (const SymmetryPlane& plane : detect_symmetry(mesh, tree, context))
    cut_half(mesh, {}, plane.normal, plane.offset);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  TriangleSoup soup;
  soup.points = lattice();
  for (std::size_t i = 0; i + 2 < size && i < 300; i += 3)
    soup.faces.push_back({data[i] % 32, data[i + 1] % 32, data[i + 2] % 32});
  try {
    prepare_all(repair(soup).mesh, size > 0 && data[0] % 64 == 63);
  } catch (const Error& e) {
    if (e.code() == ErrorCode::kInternal) std::abort();
  }
  return 0;
}
