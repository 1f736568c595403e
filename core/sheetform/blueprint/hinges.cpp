#include "sheetform/blueprint/hinges.h"

#include <algorithm>
#include <cmath>

#include "sheetform/blueprint/fold_lines.h"
#include "sheetform/blueprint/materials.h"
#include "sheetform/blueprint/text.h"

namespace sheetform {
namespace {

constexpr double kMarkClear = 0.8;  // mm between a slot and a letter or notch

using Segment = std::array<Vector2, 2>;

double middle_distance(const Segment& a, const Segment& b) {
  return ((a[0] + a[1]) - (b[0] + b[1])).norm() / 2;
}

/// Slots of one part.
class Lattice {
 public:
  Lattice(Blueprint& blueprint, BlueprintPart& part)
      : part_(part), inside_(part.outline), kerf_(blueprint.options.kerf) {
    const double t = blueprint.options.thickness;
    link_ = t, slot_ = 5 * t, rows_ = std::max(1.0, 0.5 * t + kerf_);
    width_ = std::max(0.3, kerf_ + 0.1);
    for (const BlueprintLine& line : part.lines)
      if (line.operation == Operation::kText || line.operation == Operation::kNotch)
        for (std::size_t i = 0; i + 1 < line.points.size(); ++i)
          marks_.push_back({line.points[i], line.points[i + 1]});
  }

  // Rows of slots between two rulings; `row` counts on from one pair to the next, so that rows stay
  // staggered.
  void fill(const Segment& a, const Segment& b, int& row) {
    const int n = std::max(1, static_cast<int>(std::lround(middle_distance(a, b) / rows_)));
    const double near = (a[0] - b[0]).norm() / n, far = (a[1] - b[1]).norm() / n;
    for (int i = 0; i < n; ++i, ++row) {
      const double f = (i + 0.5) / n;
      add_row({a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1])}, near, far, row);
    }
  }

  // Where slots let the part bend, a score beside them would only weaken it.
  void drop_scores() {
    std::erase_if(part_.lines, [&](const BlueprintLine& line) {
      const bool score =
          line.operation == Operation::kScoreMountain || line.operation == Operation::kScoreValley;
      if (!score || line.seam > 0) return false;
      return std::any_of(slots_.begin(), slots_.end(), [&](const TurnedBox& s) {
        return meets(s.grown(rows_), line.points.front(), line.points.back());
      });
    });
  }

 private:
  // Slots along one line; none where the rows run closer together than half their distance.
  void add_row(const Segment& line, double near, double far, int row) {
    const double length = (line[1] - line[0]).norm();
    if (length < 3 * link_) return;
    const Vector2 d = (line[1] - line[0]) / length;
    const double start = link_ - (row % 2 ? (slot_ + link_) / 2 : 0);
    for (double from = start; from < length - link_; from += slot_ + link_) {
      const double s0 = std::max(from, link_), s1 = std::min(from + slot_, length - link_);
      if (s1 - s0 < link_) continue;
      const double tight = std::min(near + (far - near) * s0 / length, near + (far - near) * s1 / length);
      if (tight < 0.5 * rows_) continue;
      add_slot(line[0] + s0 * d, line[0] + s1 * d, d);
    }
  }

  void add_slot(const Vector2& a, const Vector2& b, const Vector2& d) {
    const TurnedBox box{(a + b) / 2, d, (b - a).norm() / 2, width_ / 2};
    if (!inside_.holds(box.grown(0.9 * link_)) || near_a_slot(box.grown(0.4 * rows_)) ||
        on_a_mark(box.grown(kMarkClear)))
      return;
    slots_.push_back(box);
    Polygon contour = box.grown(-kerf_ / 2).corners();
    std::reverse(contour.begin(), contour.end());  // holes run clockwise
    part_.lines.push_back({Operation::kCutInner, std::move(contour), true, 0, 0});
  }

  bool near_a_slot(const TurnedBox& box) const {
    const double reach = box.half_width + box.half_height;
    return std::any_of(slots_.begin(), slots_.end(), [&](const TurnedBox& s) {
      return (s.center - box.center).norm() <= reach + s.half_width + s.half_height && overlap(s, box);
    });
  }

  bool on_a_mark(const TurnedBox& box) const {
    return std::any_of(marks_.begin(), marks_.end(),
                       [&](const Segment& t) { return meets(box, t[0], t[1]); });
  }

  BlueprintPart& part_;
  Inside inside_;
  double kerf_, link_, slot_, rows_, width_;
  std::vector<TurnedBox> slots_;
  std::vector<Segment> marks_;
};

void say(Blueprint& b, const BlueprintPart& part, double allowed) {
  b.warnings.push_back(
      "Part " + part.label + " bends to a radius of " + rounded(part.smallest_radius, 1) + " mm, " +
      b.options.material + " of " + rounded(b.options.thickness, 2) + " mm wants " + rounded(allowed, 1) +
      " mm: " +
      (b.options.hinges ? "slots are cut there" : "take thinner material, a larger model or hinges"));
}

// mm; 0: any.
double allowed_radius(const Blueprint& b) {
  if (b.options.material.empty()) return 0;
  return smallest_radius(material_named(b.options.material), b.options.thickness);
}

}  // namespace

std::vector<double> bend_radii(const Blueprint& b, int part) {
  const int patch = b.parts[part].patch;
  const double allowed = allowed_radius(b);
  const double reach =
      allowed > 0 ? allowed / 2 : kBendReach * b.scale * bounding_box_diagonal(b.strips.points);
  return bend_radii(b.strips, patch, creases_of(b.strips, patch), b.flat, reach);
}

void add_hinges(Blueprint& b) {
  const double allowed = allowed_radius(b);
  for (std::size_t p = 0; p < b.parts.size(); ++p) {
    BlueprintPart& part = b.parts[p];
    const std::vector<double> radii = bend_radii(b, static_cast<int>(p));
    if (radii.empty()) continue;
    part.smallest_radius = *std::min_element(radii.begin(), radii.end());
    if (part.smallest_radius >= allowed) continue;
    say(b, part, allowed);
    if (!b.options.hinges || b.options.thickness <= 0) continue;
    const std::vector<Segment> lines = flat_rulings(creases_of(b.strips, part.patch), b.flat);
    Lattice lattice(b, part);
    int row = 0;
    for (std::size_t i = 0; i + 1 < lines.size(); ++i)
      if (radii[i] < allowed || radii[i + 1] < allowed) lattice.fill(lines[i], lines[i + 1], row);
    lattice.drop_scores();
  }
}

}  // namespace sheetform
