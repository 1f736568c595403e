// The discretized ruled surfaces: the result in 3D together with its isometric flat layout.
#pragma once
#include <array>
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// Every patch is a triangulated polygon without inner vertices: exactly developable (paper 3.5).
/// Lengths, also of `uvs`, are in units of the uploaded mesh. See contract.md for the meaning of each field.
struct StripMesh {
  struct Triangle {
    std::array<int, 3> v;   ///< into points, counter-clockwise seen from outside
    std::array<int, 3> vt;  ///< into uvs, counter-clockwise
  };
  struct Patch {
    std::vector<Triangle> triangles;
    std::vector<int> boundary;                ///< indices into points, counter-clockwise, first not repeated
    std::vector<int> boundary_vt;             ///< the uv of each place of `boundary`
    std::vector<int> corners;                 ///< ascending places in `boundary`
    std::vector<int> arches;                  ///< in the order of `boundary`
    std::vector<std::array<int, 2>> rulings;  ///< inner edges by point index, ordered along the sweep
    int component = 0;                        ///< of the input
    int mirror_of = -1;                       ///< patch id of the mirror image, -1 if none
  };
  struct Arch {
    std::vector<int> vertices;   ///< indices into points from node to node; a closed loop repeats its first
    std::array<int, 2> patches;  ///< {p, q}; q = -1 on the surface's border, p = q on a seam of p with itself
    bool crease = false;
    bool on_plane = false;  ///< lies on the plane of symmetry
    bool drawn = false;     ///< a seam that the user has drawn
  };
  std::vector<Vector3> points;
  std::vector<Vector2> uvs;  ///< one for each (patch, vertex), on a seam with itself one for each side
  std::vector<Patch> patches;
  std::vector<Arch> arches;
};

}  // namespace sheetform
