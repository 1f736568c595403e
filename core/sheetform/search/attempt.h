// What one run of the last passes ended in.
#pragma once
#include <algorithm>
#include <iterator>
#include <vector>

#include "sheetform/search/finish.h"
#include "sheetform/search/spacing.h"
#include "sheetform/strip/certificate.h"

namespace sheetform {

/// The layout as strips, and what is still wrong with it. Patches by id, ascending.
struct Attempt {
  FinishedLayout finished;
  EvaluationParams evaluation;
  SpacingMiss uneven;  ///< against the bounds asked for
  StripMesh strips;
  std::vector<int> invalid;   ///< patches that break a strict promise
  std::vector<int> too_far;   ///< valid patches beyond the tolerance
  std::vector<int> hard;      ///< those of them beyond it by more than the next morph makes good
  std::vector<double> error;  ///< by patch, in tolerances; empty where nothing was measured
  std::vector<FarPlace> far;  ///< what the next morph should know
  double distance = 0;
  double miss = 0;  ///< of ComponentResult

  std::size_t bad() const { return invalid.size() + too_far.size(); }
  bool good() const { return bad() == 0; }
  /// Whether a patch has no strips at all; then nothing is measured.
  bool has_gaps() const {
    const auto& patches = finished.source.patches;
    return std::any_of(patches.begin(), patches.end(), [](const auto& p) { return p.triangles.empty(); });
  }
  /// Those that are too far by at least half as much as the worst of them: the others may do once these are
  /// mended, as what pulls at one place pulls at its neighbours.
  std::vector<int> farthest() const {
    double worst = 0;
    for (int p : too_far) worst = std::max(worst, error[p]);
    std::vector<int> out;
    std::copy_if(too_far.begin(), too_far.end(), std::back_inserter(out),
                 [&](int p) { return worst <= 1 || error[p] >= (1 + worst) / 2; });
    return out;
  }
};

}  // namespace sheetform
