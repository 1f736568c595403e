// What the user has drawn on the mesh, checked, brought to where the search works, and looked for in the
// result.
#pragma once
#include <string>
#include <vector>

#include "sheetform/base/run_context.h"
#include "sheetform/mesh/guides.h"
#include "sheetform/strip/strip_mesh.h"

namespace sheetform {

/// Throws Error kInvalidParameter for strokes that no surface can follow: too few points, numbers that are
/// not finite, radii that are not positive, points farther than 5 % of the diagonal from the mesh, strokes
/// longer than 100 diagonals altogether. where: "guides, seams[1], point 3". One closest point a drawn point.
void check_guides(const UserGuides& guides, const TriangleSoup& mesh, const RunContext& context = {});

/// The guides of one component; `seam`: of each of its strokes, the one of the user that it is a piece of.
struct ComponentGuides {
  UserGuides guides;
  std::vector<int> seam;
};

/// The strokes by component of the mesh; what goes over from one to another is cut there.
std::vector<ComponentGuides> guides_by_component(const std::vector<ComponentGuides>& strokes,
                                                 const SurfaceMesh& mesh, const std::vector<int>& component,
                                                 int count);

/// The strokes on a half with x >= 0: what lies on the other side is mirrored, what crosses the plane is cut
/// there.
std::vector<ComponentGuides> folded(const UserGuides& guides);
/// As they are, each stroke in one piece.
std::vector<ComponentGuides> unfolded(const UserGuides& guides);

/// By edge of a half: on the plane x = 0, and a stroke runs along it.
std::vector<char> drawn_on_plane(const SurfaceMesh& half, const std::vector<SeamStroke>& seams);

/// For people: drawn seams from which the result's seams stay farther than `reach`, and seams of the result
/// inside of regions where none was wanted, with the place. All in the units of the mesh; `mesh` is the
/// repaired input.
std::vector<std::string> unmet_guides(const UserGuides& guides, const SurfaceMesh& mesh,
                                      const StripMesh& strips, double reach, const RunContext& context);

}  // namespace sheetform
