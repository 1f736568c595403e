// Closest point on a triangle set: a bounding-volume tree, exact to rounding.
#pragma once
#include <limits>
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

struct ClosestPoint {
  Vector3 point = Vector3::Zero();
  Vector3 barycentric = Vector3::Zero();  ///< of `point` in `face`
  int face = -1;                          ///< -1: nothing within the given bound
  double squared_distance = std::numeric_limits<double>::infinity();
};

/// Built once per triangle set; queries are const and thread-safe. Build O(n log n), query O(log n) typical.
/// Ties are broken by the lower face id, so answers do not depend on the tree's shape.
class ClosestPointTree {
 public:
  ClosestPointTree() = default;
  ClosestPointTree(const std::vector<Vector3>& points, const std::vector<std::array<int, 3>>& faces);
  /// Nearest point within sqrt(bound2); face = -1 if there is none.
  ClosestPoint closest(const Vector3& query, double bound2 = std::numeric_limits<double>::infinity()) const;
  bool empty() const { return nodes_.empty(); }

 private:
  struct Node {
    Vector3 lo, hi;
    int begin, end;  // leaf: range of triangles_; inner: children are `begin` and `end`
    bool leaf;
  };
  struct Triangle {
    Vector3 a, b, c;
    int face;
  };
  int build(int begin, int end);
  std::vector<Node> nodes_;
  std::vector<Triangle> triangles_;
};

}  // namespace sheetform
