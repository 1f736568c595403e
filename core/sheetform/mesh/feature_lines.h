// Creases and borders as polylines between corners: what remeshing must keep. Internal to mesh/.
#pragma once
#include <vector>

#include "sheetform/mesh/closest_point.h"
#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

struct FeatureLines {
  std::vector<int> edge_line;  ///< of each edge: its line, -1 for none
  std::vector<char> corner;    ///< of each vertex: a line ends or turns sharply here, or a short loop is held
                               ///< open; it has to stay
  std::vector<ClosestPointTree> segments;  ///< of each line, as triangles without area

  /// Nearest point of a line.
  Vector3 project(int line, const Vector3& query) const { return segments[line].closest(query).point; }
};

/// scale: bends are judged over this distance, so that jags that are finer do not count as corners. Loops of
/// a few scales have three corners at least.
FeatureLines feature_lines(const SurfaceMesh& mesh, const std::vector<char>& crease_edge, double scale);

}  // namespace sheetform
