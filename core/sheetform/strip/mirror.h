// A symmetric result from one half of it.
#pragma once
#include "sheetform/strip/strip_mesh.h"

namespace sheetform {

/// The half x >= 0 together with its mirror image in the plane x = 0. Points of arches that lie on the plane
/// are shared, so that such an arch becomes a seam between a patch and its image; every other point has an
/// image with -x exactly, every patch names its image in mirror_of, and its layout is the mirrored one.
/// Points, patches and arches of `half` keep their numbers, images follow in the same order. Components are
/// numbered anew: the two sides are one where they meet on the plane. O(n).
StripMesh with_mirror_image(const StripMesh& half);

/// What a patch over both sides of the plane has to keep.
struct JoinRules {
  int max_sides = 6;
  bool every_node = false;     ///< each node is a corner (no T-junctions)
  bool self_seams = true;      ///< the joined patch may be glued to itself along another seam on the plane
  double corner_reach = 0.03;  ///< length over which directions at the new nodes are taken
  double corner_turn = 45;     ///< degrees: a corner where the outline turns by more
};

/// A seam on the plane that is one straight segment becomes a ruling: the two patches beside it, images of
/// each other, are one patch that is its own image (mirror_of = -1). Left as it is where the joined patch
/// would touch or overlap itself or have too many sides. The order of all other patches and arches stays;
/// lengths are in diagonals of the input.
StripMesh join_images(const StripMesh& whole, const JoinRules& rules);

}  // namespace sheetform
