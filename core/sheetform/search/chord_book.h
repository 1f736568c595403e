// Edges that chords may not be: three faces would meet there.
#pragma once
#include <algorithm>
#include <cstddef>
#include <set>
#include <utility>
#include <vector>

#include "sheetform/ruling/rulings.h"

namespace sheetform {

/// Chords must be edges of their own: not an arch edge, not the chord of another patch (or of the other side
/// of a seam), or three faces would meet there. Nor may both ends lie on the plane of symmetry: there the
/// chord would meet its mirror image. Points go by their unknown: the same on both sides of a seam.
class ChordBook {
 public:
  using Pair = std::pair<int, int>;
  static Pair ordered(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

  /// on_plane: by unknown; empty = none is. Has to live as long.
  explicit ChordBook(const std::vector<char>& on_plane) : on_plane_(on_plane) {}
  void take_edge(int a, int b) { used_.insert(ordered(a, b)); }
  void take_line(const std::vector<int>& points) {
    for (std::size_t i = 0; i + 1 < points.size(); ++i) take_edge(points[i], points[i + 1]);
  }
  /// Chords of a patch that may not be; unknowns: by polygon point.
  std::set<Pair> conflicts(const RulingSet& rulings, const std::vector<int>& unknowns) const {
    std::set<Pair> bad, own;
    for (const auto& c : rulings.chords) {
      const Pair pair = ordered(unknowns[c.a], unknowns[c.b]);
      if (pair.first == pair.second || in_plane(pair) || used_.count(pair) || !own.insert(pair).second)
        bad.insert(pair);
    }
    return bad;
  }
  void take(const RulingSet& rulings, const std::vector<int>& unknowns) {
    for (const auto& c : rulings.chords) take_edge(unknowns[c.a], unknowns[c.b]);
  }

 private:
  bool in_plane(const Pair& p) const {
    return !on_plane_.empty() && on_plane_[p.first] && on_plane_[p.second];
  }

  const std::vector<char>& on_plane_;
  std::set<Pair> used_;
};

}  // namespace sheetform
