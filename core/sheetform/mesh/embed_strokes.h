// Seam strokes as chains of mesh edges.
#pragma once
#include <vector>

#include "sheetform/mesh/guides.h"
#include "sheetform/mesh/prepare.h"

namespace sheetform {

struct EmbeddedStrokes {
  PreparedMesh prepared;         ///< remeshed: its triangles follow the strokes
  std::vector<char> drawn_edge;  ///< by edge of its mesh: on a stroke
  std::vector<int> left_out;     ///< strokes that are too small for the mesh
};

/// Cuts the strokes into the triangles of an evenly triangulated mesh and makes these even again, so that
/// each stroke is a chain of edges within a small share of an edge length of where it was drawn. Strokes may
/// cross themselves, each other, creases. An end less than one and a half edges from a border, crease or
/// other stroke ends there; overshoot of two edges is cut off; stretches along one of these (within three
/// quarters of an edge) are that line's, not drawn again. Cost: of prepare(), and O(n log n) for each stroke.
/// Deterministic.
EmbeddedStrokes embed_strokes(const PreparedMesh& prepared, const std::vector<SeamStroke>& strokes,
                              const RunContext& context);

}  // namespace sheetform
