// One patch cut open: its triangles hang together only where they share both the point and the uv of an edge.
#pragma once
#include <vector>

#include "sheetform/strip/strip_mesh.h"
#include "sheetform/strip/topology.h"

namespace sheetform {

/// A vertex of the patch cut open is a pair (point, uv); on a seam of the patch with itself a point has
/// several.
struct PatchShape {
  std::vector<std::array<int, 2>> vertices;  ///< (index into points, index into uvs), ascending
  std::vector<Triple> faces;                 ///< by index into `vertices`
  EdgeTable table;                           ///< of faces
  Topology topology;
  bool disk = false;  ///< one piece, one border loop, chi = 1, manifold, consistently oriented
  bool tree = false;  ///< its dual graph
  std::vector<int>
      loop;  ///< of a disk: its border once around, counter-clockwise, as indices into `vertices`
  std::vector<int> inner;  ///< vertices that are not on the border

  std::vector<int> loop_points() const;  ///< `loop` as indices into points
  std::vector<int> loop_uvs() const;     ///< `loop` as indices into uvs
};

/// Needs indices in range, nothing else. Cost O(t log t) for t triangles.
PatchShape shape_of(const StripMesh::Patch& patch);

/// The place of `loop` from which `listed` runs along it, -1 if it does not. Both closed, first not repeated.
int place_in_loop(const std::vector<int>& listed, const std::vector<int>& loop);

/// Of its triangles in space, in square units of the points.
double patch_area(const StripMesh& strips, const StripMesh::Patch& patch);

/// Fills boundary_vt of `patch` from its triangles; empty when `boundary` is not the border of a disk.
void fill_boundary_vt(StripMesh::Patch& patch);

}  // namespace sheetform
