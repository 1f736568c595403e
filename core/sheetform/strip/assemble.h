// From solved outlines and triangulations to the strip mesh with its flat layout.
#pragma once
#include <vector>

#include "sheetform/strip/strip_mesh.h"

namespace sheetform {

/// A layout in terms of shared points: what the final morph hands over.
struct StripSource {
  struct Patch {
    std::vector<int> outline;  ///< shared points, counter-clockwise, starts at the start of arches[0]
    std::vector<std::array<int, 3>> triangles;  ///< places of `outline`, counter-clockwise, sweep order
    std::vector<std::array<int, 2>> rulings;    ///< places of `outline`: between consecutive triangles
    std::vector<int> corners;                   ///< ascending places of `outline`
    std::vector<int> arches;                    ///< in the order of `outline`
  };
  struct Arch {
    std::vector<int> points;
    std::array<int, 2> patches;
    bool crease = false;
    bool on_plane = false;  ///< on the plane of symmetry x = 0
    bool drawn = false;     ///< by the user
  };
  std::vector<Vector3> points;
  std::vector<Patch> patches;
  std::vector<Arch> arches;
};

/// Unfolds every patch; each lies with its first flat point at the origin (the blueprint places them).
/// O(triangles).
StripMesh assemble_strips(const StripSource& source);

/// Of strips as they were assembled: rulings stay where the sheet has turned by more than half a degree since
/// the one before; on a flat face they would be lines to fold that are no folds. A part that turns by less,
/// but is not plane, keeps its sharpest. O(triangles).
void drop_flat_rulings(StripMesh& strips);

/// Appends the patches of `other` (another component): ids are shifted.
void append(StripMesh& strips, const StripMesh& other, int component);

}  // namespace sheetform
