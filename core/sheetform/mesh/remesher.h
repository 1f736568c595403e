// Isotropic remeshing with kept lines. Internal to mesh/; see prepare.h.
#pragma once
#include <limits>
#include <vector>

#include "sheetform/base/run_context.h"
#include "sheetform/mesh/closest_point.h"
#include "sheetform/mesh/feature_lines.h"
#include "sheetform/mesh/halfedge_mesh.h"

namespace sheetform {

/// One remeshing: construct, run, take the result. Throws Error kInternal when the half-edge kernel refuses
/// the input.
class Remesher {
 public:
  /// most_loss: no vertex goes that would come to lie farther than this off the surface; at most 0.3 of the
  /// length.
  Remesher(const SurfaceMesh& input, const FeatureLines& lines, double length, const RunContext& context,
           double most_loss = std::numeric_limits<double>::infinity());
  /// Vertices come to lie on `surface`; tree: of its faces.
  void run(const SurfaceMesh& surface, const ClosestPointTree& tree);
  /// Instead of run(): only removes edges and heights shorter than 0.8 of the length; all else stays as it
  /// is.
  void clean();
  /// The mesh, and for each of its edges whether it lies on a line inside (a crease).
  SurfaceMesh result(std::vector<char>& crease_edge) const;

 private:
  using Vertex = OpenMesh::VertexHandle;
  using Edge = OpenMesh::EdgeHandle;
  using Half = OpenMesh::HalfedgeHandle;
  using Face = OpenMesh::FaceHandle;
  enum Kind : char { kFree, kOnLine, kCorner };

  void load(const SurfaceMesh& input);
  void split_long();
  void collapse_short(bool first);
  void flip_edges();
  void relax();

  bool is_chord(Edge e) const;
  double longest_allowed(Edge e) const;
  void split(Edge e);
  bool shortens(Half h, const Vector3& p) const;
  double thinnest(Half h, const Vector3& p) const;
  bool keeps_faces(Half h, const Vector3& p) const;
  Half best_collapse(Edge e, bool first);
  bool may_collapse(Half h);
  bool ends_tetrahedron(Half h) const;
  bool keeps_lines(Half h) const;
  bool keeps_shape(Half h) const;
  double loss(Half h) const;
  void collapse(Half h);
  bool should_flip(Edge e) const;
  bool flip_cap(Face f);
  void move_free(Vertex v);
  void move_on_line(Vertex v);
  bool move(Vertex v, const Vector3& to);

  Vertex add_vertex(const Vector3& p, Kind kind);
  const Vector3& point(Vertex v) const { return points_[static_cast<std::size_t>(v.idx())]; }
  double length_of(Edge e) const;
  Vector3 raw_normal(Face f) const;
  Vector3 vertex_normal(Vertex v) const;
  Vector3 on_surface(const Vector3& p, const Vector3& normal) const;
  int& line(Edge e) { return edge_line_[static_cast<std::size_t>(e.idx())]; }
  int line(Edge e) const { return edge_line_[static_cast<std::size_t>(e.idx())]; }
  Kind kind(Vertex v) const { return kinds_[static_cast<std::size_t>(v.idx())]; }
  void pause();  // lets the run be stopped, every so many operations

  HalfedgeMesh mesh_;
  std::vector<Vector3> points_;
  const FeatureLines& lines_;
  const SurfaceMesh* surface_ = nullptr;  // that vertices are put on
  const ClosestPointTree* tree_ = nullptr;
  const double length_;
  const RunContext& context_;
  std::vector<int> edge_line_;
  std::vector<Kind> kinds_;
  double most_loss_;
  std::vector<double> losses_;  // by vertex: bound of how far the removed ones around it lie off
  int operations_ = 0;
  int most_vertices_ = 0;
};

}  // namespace sheetform
