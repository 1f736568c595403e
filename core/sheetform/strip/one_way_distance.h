// The largest distance from one surface to another: branch and bound over its faces.
#pragma once
#include <array>
#include <functional>
#include <vector>

#include "sheetform/mesh/closest_point.h"
#include "sheetform/strip/certificate_checks.h"
#include "sheetform/strip/height_bound.h"

namespace sheetform::certificate {

/// A surface in plain arrays.
struct Surface {
  const std::vector<Vector3>& points;
  const std::vector<std::array<int, 3>>& faces;
};

/// The largest distance found at some faces, and where: few faces of a large mesh are ever asked for.
class Farthest {
 public:
  struct Place {
    double distance = 0;
    Vector3 point = Vector3::Zero();
    ClosestPoint hit;
  };
  explicit Farthest(std::size_t faces) : slot_(faces, -1) {}
  double at(int face) const { return slot_[face] < 0 ? 0 : places_[slot_[face]].distance; }
  /// What is known of a face at which at() is not 0.
  const Place& place(int face) const { return places_[slot_[face]]; }
  void raise(int face, double distance, const Vector3& point, const ClosestPoint& hit);

 private:
  std::vector<int> slot_;
  std::vector<Place> places_;
};

/// Distances from one surface to another, one way. All it is given must outlive it. Results do not depend on
/// the number of threads.
class OneWayDistance {
 public:
  /// tree, heights: of the faces of `to`; the latter may be null where nothing but measure() is called.
  /// enough: what is known to be nearer is not measured exactly.
  OneWayDistance(const Surface& from, const Surface& to, const ClosestPointTree& tree,
                 const HeightBound* heights, double enough, const RunContext& context);

  /// Measures from each sample and gives the mean distance; hits: the closest face of each sample.
  double measure(const std::vector<AreaSample>& samples, std::vector<int>* hits = nullptr);

  struct Goal {
    double finest = 0;   ///< by how much a larger distance may be missed
    double settled = 0;  ///< once none is larger than this, few_splits do
    int splits = 0, few_splits = 0;
  };
  /// Branch and bound for the largest distance: splits parts of the surface that may reach farther than is
  /// known, the most promising first. Cost: a query for each vertex and split.
  void find_largest(const Goal& goal);

  struct Faces {
    OneWayDistance& way;
    const std::vector<int>& faces;  // of its own surface, ascending
  };
  /// The same both ways for places beyond a limit: the worst place beyond it of each face is found to a
  /// thousandth of the limit (a tenth, where it is far beyond). At most about so many splits each way.
  friend void find_beyond(const std::array<Faces, 2>& ways, double limit, int splits,
                          const RunContext& context);

  double max = 0;      ///< largest distance found
  double at_most = 0;  ///< after find_largest(): no point is farther
  Vector3 worst = Vector3::Zero();
  Farthest from_face, to_face;

 private:
  struct Hit {
    int face = -1;  // of the other surface
    double distance = 0;
    Vector3 point = Vector3::Zero();  // of that face
  };
  struct Piece;
  struct Probe;
  class Open;
  ClosestPoint closest(const Vector3& point) const;
  void keep(const Vector3& point, int face, const ClosestPoint& hit);
  std::vector<Hit> hits_of(const std::vector<AreaSample>& samples);
  std::vector<Hit> vertex_hits(const std::vector<int>& faces);
  Piece whole_face(int face, const std::vector<Hit>& vertices) const;
  double bound_of(const Piece& piece) const;
  double height_of(const Piece& piece, double limit) const;
  Probe split(const Piece& piece, std::array<Piece, 2>& halves) const;
  std::vector<Probe> split_all(Open& open, int splits, const std::function<void(int, double)>& found) const;
  int split_in_groups(const std::vector<Hit>& vertices, const Goal& goal, Open& open);
  std::vector<Probe> probes_beyond(const int* faces, int count, const std::vector<Hit>& vertices,
                                   double limit, int splits) const;

  const Surface &from_, &to_;
  const ClosestPointTree& tree_;
  const HeightBound* heights_;
  double enough_;
  const RunContext& context_;
};

void find_beyond(const std::array<OneWayDistance::Faces, 2>& ways, double limit, int splits,
                 const RunContext& context);

}  // namespace sheetform::certificate
