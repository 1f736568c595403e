// Closest point on a triangle set: a bounding-volume tree, exact to rounding.
#pragma once
#include <limits>
#include <vector>

#include "sheetform/base/run_context.h"
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
/// Degenerate triangles count as the segments or points that they are. The build throws as
/// context.checkpoint() does, and nothing else.
class ClosestPointTree {
 public:
  ClosestPointTree() = default;
  ClosestPointTree(const std::vector<Vector3>& points, const std::vector<std::array<int, 3>>& faces,
                   const RunContext& context = {});
  /// Nearest point within sqrt(bound2); face = -1 if there is none (or the query is not finite). A good bound
  /// makes the query faster. Where a point within sqrt(enough2) has been found, a nearer one is not looked
  /// for.
  ClosestPoint closest(const Vector3& query, double bound2 = std::numeric_limits<double>::infinity(),
                       double enough2 = 0) const;
  bool empty() const { return nodes_.empty(); }
  /// Of the triangles' bounding box; 1 when that is a point.
  double diagonal() const { return 1 / scale_; }

  /// Some of the triangles, near each other: all lie within `radius` of `centre`.
  struct Part {
    Vector3 centre;
    double radius;
    int first, count;  // as in Node
    bool leaf() const { return count > 0; }
  };
  /// The parts at the top of the tree; none of an empty one.
  std::vector<Part> parts() const;
  /// Appends the parts of which one that is no leaf consists.
  void append_parts(const Part& part, std::vector<Part>& to) const;
  /// Triangle i < part.count of a leaf.
  int face_of(const Part& part, int i) const { return triangles_[part.first + i].face; }

 private:
  // Four children side by side, boxes in single precision of normalised coordinates, rounded outward: they
  // only ever serve to skip a child.
  struct Node {
    Eigen::Array4f lo[3], hi[3];
    int first[4];  // node id, or first triangle of a leaf
    int count[4];  // triangles of a leaf; 0: inner child; -1: no child
  };
  struct Triangle {
    Vector3 a, ab, ac;
    double bb, bc, cc;  // dot products of ab and ac
    int face;
    bool thin;  // so thin that its plane means nothing
  };
  struct Builder;
  void test_triangle(const Triangle& t, const Vector3& query, ClosestPoint& best) const;
  std::vector<Node> nodes_;
  std::vector<Triangle> triangles_;
  Vector3 centre_ = Vector3::Zero();
  double scale_ = 1;  // of a model length to a normalised one
};

/// The point of the mesh nearest to `query` that is found from `face` on, from neighbour to neighbour (which
/// share a vertex) as long as one is nearer: what is near along the surface, not the other side of a thin
/// wall. Cost: some ten triangles a step.
ClosestPoint closest_from(const SurfaceMesh& mesh, int face, const Vector3& query);

/// Barycentric coordinates of the point of one triangle, which may be degenerate, that is nearest.
Vector3 nearest_in_triangle(const Vector3& query, const Vector3& a, const Vector3& b, const Vector3& c);
/// Distance of a point to one triangle, which may be degenerate.
double distance_to_triangle(const Vector3& query, const Vector3& a, const Vector3& b, const Vector3& c);

}  // namespace sheetform
