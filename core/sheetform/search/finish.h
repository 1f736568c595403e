// The final pass: finer outline samples, rulings as fair as the tolerance allows, chords that no two patches
// share, the last morph (paper 3.5).
#pragma once
#include <memory>
#include <vector>

#include "sheetform/search/evaluator.h"
#include "sheetform/strip/assemble.h"
#include "sheetform/strip/certificate.h"

namespace sheetform {

struct FinishedLayout {
  LayoutEvaluation evaluation;  ///< after the last morph
  StripSource source;           ///< its strips, in the units of the search surface
  std::vector<int> failing;     ///< patches that break a promise: they overlap, or have no valid strips
};

/// One layout on its way to the final strips. evaluation.spacing is that of the final mesh.
///
/// The search tells errors by samples of its own; what a measurement finds beyond the tolerance is handed
/// back with draw_to() and takes part in the next morph, so that the distance that is promised is the one
/// that is minimised.
class FinalPass {
 public:
  /// charts: the evaluator of the search.
  FinalPass(const SearchSurface& surface, const PathNetwork& network, const PatchLayout& layout,
            const EvaluationParams& evaluation, LayoutEvaluator& charts, RunContext& context);

  /// The strips after a morph with all that is known.
  FinishedLayout solve(int rounds);
  /// Places of the last solution that are too far from the input.
  void draw_to(const std::vector<FarPlace>& far);
  /// Rulings of these patches that care less for fairness and more for distance; false when there are none.
  bool plainer(const std::vector<int>& patches);
  const EvaluationCounts& counts() const { return evaluator_.counts(); }

 private:
  using Evaluation = std::shared_ptr<const PatchEvaluation>;
  RulingParams ruling(int level) const;
  void choose_level(int patch, int highest);
  void make_distinct();
  const SearchSurface& surface_;
  const PathNetwork& network_;
  const PatchLayout& layout_;
  /// As the search knows them. Held: what was forgotten there would get other corners here.
  std::vector<Evaluation> searched_;
  LayoutEvaluator evaluator_;
  RunContext& context_;
  std::vector<int> level_;
  std::vector<Evaluation> patches_;
  std::vector<char> hopeless_;
  std::vector<MorphSample> drawn_;
  double pull_;  ///< what places drawn to next weigh, in samples
  bool distinct_ = false;
};

}  // namespace sheetform
