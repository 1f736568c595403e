// Straight rulings of one patch: the best triangulation of its outline without inner points (paper 3.3.1
// and 3.5).
//
// The paper picks one of a few families of lines between opposite sides, morphs, and triangulates afterwards.
// Here the outline is sampled once, every chord between two samples is scored by what the morph would have to
// pay for it, and dynamic programming finds the best strip of triangles over all starts, ends and monotone
// pairings at once. All families of the paper (side to side, side to corner, corner fans) are among the
// strips searched, and the search model is the final mesh, so nothing is re-cut afterwards. O(m^2) chords for
// m outline points.
#pragma once
#include <functional>
#include <vector>

#include "sheetform/field/cross_field.h"
#include "sheetform/ruling/chart.h"

namespace sheetform {

/// What rulings should know of the surface, per mesh face.
struct SurfaceGuide {
  std::vector<Vector3> ruling_direction;  ///< of least curvature, in the plane of the face; zero if unknown
  std::vector<double> strength;           ///< 0..1: how much the direction matters (strong anisotropy = 1)
  std::vector<Vector3> normal;            ///< unit
};
SurfaceGuide surface_guide(const SurfaceMesh& mesh, const CurvatureField& curvature);

/// Samples along an arch, as coordinates edge index + fraction; first 0, last edges.size(). At least 2
/// segments, 3 when the arch is closed.
std::vector<double> sample_arch(const SurfaceMesh& mesh, const Arch& arch, double spacing);
Vector3 arch_point(const SurfaceMesh& mesh, const Arch& arch, double at);

/// The sampled outline of a patch, counter-clockwise.
struct PatchPolygon {
  struct Origin {
    int use;     ///< index into patch.boundary of the stretch that starts or continues here
    int sample;  ///< index into the samples of that arch
  };
  std::vector<Vector2> uv;
  std::vector<Vector3> point;  ///< on the surface
  std::vector<Origin> origin;
  std::vector<char> node;  ///< PatchLayout::Node of the point
  int size() const { return static_cast<int>(uv.size()); }
};
PatchPolygon patch_polygon(const SurfaceMesh& mesh, const PatchLayout& layout, const Patch& patch,
                           const PatchChart& chart, const std::vector<std::vector<double>>& arch_samples);

/// Point location in a chart by a grid of cells: O(1) a query, exact inside a triangle, linear extrapolation
/// just outside of the outline.
class ChartRaster {
 public:
  ChartRaster(const SurfaceMesh& mesh, const SurfaceGuide& guide, const Patch& patch, const PatchChart& chart,
              int cells);
  /// Local triangle under or near u, -1 when u is off the patch by more than about a cell.
  int triangle_at(const Vector2& u) const {
    const int cell = cell_of(u);
    return cell < 0 ? -1 : cells_[cell];
  }
  Vector3 lift(int triangle, const Vector2& u) const {
    return maps_[triangle].origin + maps_[triangle].jacobian * (u - maps_[triangle].uv);
  }
  const Vector3& normal(int triangle) const { return maps_[triangle].normal; }
  /// sin^2 of the angle between a flat direction (unit) and that of least curvature, times its strength.
  double misalignment(int triangle, const Vector2& direction) const {
    const Map& map = maps_[triangle];
    const double sine = map.ruling.x() * direction.y() - map.ruling.y() * direction.x();
    return map.strength * sine * sine;
  }
  double cell() const { return cell_; }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  int cell_of(const Vector2& u) const {
    const int x = static_cast<int>((u.x() - low_.x()) * per_cell_),
              y = static_cast<int>((u.y() - low_.y()) * per_cell_);
    return x < 0 || y < 0 || x >= columns_ || y >= rows_ ? -1 : y * columns_ + x;
  }

 private:
  void mark(int triangle, const Vector2& a, const Vector2& b, const Vector2& c);
  struct Map {
    Vector2 uv;
    Vector3 origin, normal;
    Eigen::Matrix<double, 3, 2> jacobian;
    Vector2 ruling;  // flat direction of least curvature, unit or zero
    double strength;
  };
  std::vector<Map> maps_;
  std::vector<int> cells_;
  Vector2 low_;
  double cell_ = 1, per_cell_ = 1;
  int columns_ = 0, rows_ = 0;
};

struct RulingParams {
  double e_max = 0.02;        ///< length at which an error counts as 1
  double twist_weight = 0.2;  ///< per squared radian between the normals at both ends of a ruling
  double align_weight =
      0.5;  ///< per unit of sin^2 to the direction of least curvature where that is pronounced
  double min_height = 1e-3;  ///< flat triangles lower than this are avoided
  double flat_cost = 0;      ///< in addition, of a triangle lower than a five-hundredth of that
  bool keep_inside = true;   ///< chords that leave the raster of the patch are forbidden
};

/// A triangulation of the polygon by a strip.
struct RulingSet {
  struct Chord {
    int a, b;     ///< polygon indices
    double area;  ///< half of the two triangles beside it
  };
  std::vector<std::array<int, 3>> triangles;  ///< counter-clockwise, in the order of the sweep
  std::vector<Chord> chords;                  ///< inner edges, in the order of the sweep
  double predicted_error = 0;                 ///< largest half sagitta over the chords
  double misalignment =
      0;  ///< mean over the area of sin^2 to the direction of least curvature, where that matters
  double cost = 0;
  bool found = false;
};

/// forbidden(a, b): chords that may not be used (polygon indices), may be null. O(m^2).
RulingSet best_rulings(const PatchPolygon& polygon, const ChartRaster& raster, const RulingParams& params,
                       const std::function<bool(int, int)>* forbidden = nullptr);

}  // namespace sheetform
