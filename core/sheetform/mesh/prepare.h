// The mesh that the search works on: even triangles, creases and borders kept.
#pragma once
#include <limits>
#include <vector>

#include "sheetform/base/run_context.h"
#include "sheetform/mesh/closest_point.h"
#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

struct PreparedMesh {
  SurfaceMesh mesh;
  std::vector<char> crease_edge;  ///< of `mesh`, as detect_creases gives them
  bool remeshed = false;          ///< false: remeshing failed, the input with long edges split stands in
};

/// Edges even enough and triangles fat enough for the search as they are.
bool uniform_enough(const SurfaceMesh& mesh);

/// Edge length of equilateral triangles of which `faces` cover the mesh.
double edge_length_for(const SurfaceMesh& mesh, int faces);

/// The mesh without edges shorter than `height` and, as far as possible, without triangles lower than it;
/// their normals say nothing about creases. Changes the surface by no more than about `height`; topology and
/// borders' corners stay. Returns the input when that fails. For detect_creases on CAD files: 5e-4 of the
/// diagonal.
SurfaceMesh without_slivers(const SurfaceMesh& input, double height, const RunContext& context);

/// Isotropic remeshing (Botsch and Kobbelt 2004: split, collapse, flip, relax, project back) with edges of
/// about `target_edge_length`. Creases and borders stay polylines on the input's polylines, their corners and
/// junctions stay vertices; components, border loops and Euler characteristic stay. Vertices lie on the
/// input. Falls back to the input with its long edges split when anything goes wrong; throws only as
/// context.checkpoint() does. crease_edge: by edge of `input`, empty = none. About 0.1 s for 10 k faces, 1 s
/// from 200 k to 10 k.
PreparedMesh prepare(const SurfaceMesh& input, const std::vector<char>& crease_edge,
                     double target_edge_length, const RunContext& context);
/// The same, with vertices on `surface` (`tree` is of its faces), which `input` may differ from by as little
/// as without_slivers makes it. most_loss: no vertex goes that would come to lie farther off the surface.
PreparedMesh prepare(const SurfaceMesh& input, const std::vector<char>& crease_edge,
                     double target_edge_length, const SurfaceMesh& surface, const ClosestPointTree& tree,
                     const RunContext& context, double most_loss = std::numeric_limits<double>::infinity());

/// The input with a vertex in the middle of every edge that is longer than 1.5 times `length`, again and
/// again: the same surface with smaller faces.
PreparedMesh with_short_edges(const SurfaceMesh& input, const std::vector<char>& crease_edge, double length,
                              const RunContext& context);

}  // namespace sheetform
