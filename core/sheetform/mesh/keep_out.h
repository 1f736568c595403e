// The regions of a surface where no seam is wanted.
#pragma once
#include <vector>

#include "sheetform/mesh/guides.h"
#include "sheetform/mesh/surface_curve.h"

namespace sheetform {

/// Tubes around brush strokes, taken on one mesh: of the part of the surface inside a tube only what hangs
/// together with its stroke counts, so that the other side of a thin wall stays free.
class KeepOut {
 public:
  KeepOut() = default;
  /// `spacing`: how finely the strokes are followed; a working edge length at most. O(faces log faces), and
  /// closest points for the faces near each brush.
  KeepOut(const SurfaceMesh& mesh, const std::vector<BrushStroke>& brushes, double spacing,
          const RunContext& context);
  bool empty() const { return brushes_.empty(); }

  /// How deep a point near the surface lies inside the regions grown by `margin` (at most two spacings); 0
  /// outside. `brush`: set to the one in which it lies deepest, left alone outside; may be null.
  double depth(const Vector3& point, double margin = 0, int* brush = nullptr) const;
  /// Moved straight out of the regions grown by `margin` (in space: to be projected again).
  Vector3 pushed_out(const Vector3& point, double margin) const;

 private:
  struct Brush {
    ClosestPointTree curve;
    double radius;
    std::vector<int> faces;  ///< within the tube or partly, ascending
  };
  std::vector<int> flooded(const SurfaceMesh& mesh, const std::vector<CurvePoint>& curve,
                           const Brush& brush) const;
  double depth_in(const Brush& brush, const Vector3& point, double margin) const;

  double spacing_ = 0;
  ClosestPointTree surface_;
  std::vector<Brush> brushes_;
};

/// By edge: 1 where an end or the middle lies inside the regions grown by `margin`. Empty without regions.
std::vector<char> edges_inside(const SurfaceMesh& mesh, const KeepOut& keep_out, double margin);

}  // namespace sheetform
