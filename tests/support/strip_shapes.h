// Results made by hand: patches given as chains of triangles, everything else worked out from them.
#pragma once
#include <vector>

#include "sheetform/strip/strip_mesh.h"

namespace sheetform::shapes {

/// Builds a StripMesh from patches whose triangles hang together in a chain: each shares an edge with the one
/// before. The chain is unfolded into the plane; where it comes back to a point it had left, the point gets a
/// second uv (a tube rolled from one sheet). Arches are worked out between nodes.
class StripBuilder {
 public:
  explicit StripBuilder(std::vector<Vector3> points) { mesh_.points = std::move(points); }
  /// Adds a patch. corners: points at which two sides meet. rulings: inner edges along the sweep.
  int add(const std::vector<std::array<int, 3>>& chain, const std::vector<int>& corners,
          const std::vector<std::array<int, 2>>& rulings, int component = 0);
  /// Adds the strip between two polylines of equal length, from.front() to to.front() first, with `from` on
  /// the right hand of the sweep; a ruling at every step but the ends.
  int add_strip(const std::vector<int>& left, const std::vector<int>& right, const std::vector<int>& corners,
                int component = 0);
  StripMesh finish();

 private:
  void unfold(const std::vector<std::array<int, 3>>& chain, StripMesh::Patch& patch);
  std::vector<int> corner_points_;
  std::vector<std::vector<int>> corners_of_;
  StripMesh mesh_;
};

/// The six faces of a cube of side 2: planar quads, 8 points.
StripMesh cube_faces();
/// The wall of a cylinder as one patch glued to itself along one line.
StripMesh tube(int n, double radius = 1, double height = 2);
/// Two rectangles that share an edge and are bent along it by `degrees` (0: flat); each curved if `bow` is
/// not 0.
StripMesh two_leaves(double degrees, double bow, int n);
/// A cone's wall as one patch glued to itself, its apex inside.
StripMesh cone(int n, double radius = 1, double height = 2);
/// A torus cut along `strips` circles around the tube's direction and once across: every band rolled from a
/// strip of n quads that are split in two (each quad is planar).
StripMesh torus_bands(int strips, int n, double R = 1, double r = 0.4);
/// The same, each band cut into `pieces`: strips * pieces patches of four sides.
StripMesh torus_pieces(int strips, int pieces, int n, double R = 1, double r = 0.4);

/// The surface of a result as a soup: an input that it fits exactly.
TriangleSoup soup_of(const StripMesh& strips);

}  // namespace sheetform::shapes
