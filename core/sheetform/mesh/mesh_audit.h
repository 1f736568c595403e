// What is wrong with a soup and where, and what repair did about it.
#pragma once
#include <string>
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// Most places that are kept of one kind of finding.
inline constexpr std::size_t kMarkedPlaces = 20;

/// One kind of finding with its number and the first places.
struct AuditFinding {
  std::string kind;  ///< stable name, e.g. "non-manifold-edge", "duplicate-face", "unused-vertex",
                     ///< "opposite-orientation"
  int count = 0;
  std::string
      text;  ///< for people, says also what was done: "3 edges with more than two faces were cut open"
  std::vector<Vector3> places;  ///< where, units of the mesh; at least one, kMarkedPlaces at most
};

struct MeshAudit {
  int vertices = 0, faces = 0;           ///< of the file, after fan triangulation
  int components = 0, border_loops = 0;  ///< of the repaired mesh
  int euler = 0;
  bool uniform = true;                 ///< edge lengths fit for the search without remeshing
  std::vector<AuditFinding> findings;  ///< in the order in which they were repaired
};

}  // namespace sheetform
