// What the last passes ask of strips: do they keep every promise?
#pragma once
#include <vector>

#include "sheetform/search/attempt.h"
#include "sheetform/search/component.h"
#include "sheetform/strip/certificate.h"
#include "sheetform/strip/height_bound.h"

namespace sheetform {

/// Measures strips of one component against its input; those of a half as what they and their image become.
/// `input`, `tree` (of input.reference), `params` and `context` have to live as long.
class AttemptMeasure {
 public:
  AttemptMeasure(const ComponentInput& input, const ClosestPointTree& tree, const ComponentParams& params,
                 RunContext& context);

  /// The strips of a layout with all that is wrong with them. evaluation: what they were made with. Cost: an
  /// exact two-sided distance.
  Attempt measured(FinishedLayout finished, const EvaluationParams& evaluation) const;
  /// Unknowns that what is beyond the tolerance hangs on.
  std::vector<int> points_beyond(const Attempt& attempt) const;

 private:
  bool is_half() const { return !input_.whole.faces.empty(); }
  const TriangleSoup& against() const { return is_half() ? input_.whole : input_.reference; }
  const ClosestPointTree& tree_against() const { return is_half() ? *input_.whole_tree : tree_; }
  DistanceReport far_places(const StripMesh& strips) const;
  NormalReport tilts(const StripMesh& strips) const;
  void measure_tilt(Attempt& attempt) const;

  const ComponentInput& input_;
  const ClosestPointTree& tree_;
  const ComponentParams& params_;
  RunContext& context_;
  const HeightBound heights_;  // over the input
};

/// By patch, in square diagonals.
std::vector<double> strip_areas(const StripMesh& strips);

}  // namespace sheetform
