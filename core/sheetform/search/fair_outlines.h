// The last smoothing of the seams of a finished layout: what the search and the morph leave of zigzag goes.
#pragma once
#include <functional>
#include <vector>

#include "sheetform/strip/assemble.h"

namespace sheetform {

/// The curve through these points without the waves shorter than `wavelength`: its ends stay, and so does an
/// arc or a parabola. weight: per point, of staying where it is, relative to the length that it stands for.
/// O(points).
std::vector<Vector3> faired(const std::vector<Vector3>& line, double wavelength,
                            const std::vector<double>& weight);

/// Seams of one layout, smoothed as far as the patches beside them allow. The layout has to be measured after
/// each step; what is found wrong is handed back, and the points that it hangs on keep closer to where they
/// were, step by step, until they stay.
class OutlineFairing {
 public:
  /// Whether a point may go from one place to the other.
  using Allowed = std::function<bool(const Vector3&, const Vector3&)>;
  /// `source` has to live as long. may_move: per arch; ends of arches never move.
  OutlineFairing(const StripSource& source, const std::vector<char>& may_move, Allowed allowed);

  /// The points of `source`, those inside of arches smoothed. Points stay closer that would go where they
  /// may not or turn over a triangle.
  std::vector<Vector3> places();
  /// These points stay closer; false when none of them has moved.
  bool hold(const std::vector<int>& points);
  /// The same of the outlines of these patches.
  bool hold_outlines(const std::vector<int>& patches);

 private:
  void fair(int arch);
  std::vector<int> astray() const;
  std::vector<int> turned_over() const;
  const StripSource& source_;
  Allowed allowed_;
  std::vector<int> held_;     // per point: so many steps; all of them where it may not move
  std::vector<int> arch_of_;  // per point: -1 at the ends of arches
  std::vector<Vector3> points_;
};

}  // namespace sheetform
