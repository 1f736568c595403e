#include "sheetform/blueprint/part_marks.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "sheetform/blueprint/fold_lines.h"
#include "sheetform/blueprint/seams.h"
#include "sheetform/blueprint/stroke_font.h"
#include "sheetform/strip/outline.h"

namespace sheetform {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kPadding = 0.25;        // of a text's height, kept free around it
constexpr double kShortestFold = 0.5;    // mm; less of a line than that is no fold
constexpr double kTickClear = 0.12;      // of the notch size, between two ticks
constexpr std::size_t kNeighbours = 40;  // rulings drawn before that an end is kept clear of: a whole fan

Vector2 left_of(const Vector2& d) { return {-d.y(), d.x()}; }

// All marks of one part; boxes taken by texts and notches keep later texts away.
class PartMarks {
 public:
  PartMarks(Blueprint& blueprint, int part)
      : b_(blueprint),
        o_(blueprint.options),
        part_(blueprint.parts[part]),
        id_(part),
        inside_(part_.outline),
        creases_(creases_of(blueprint.strips, part_.patch)) {}

  void add() {
    for (const Seam& seam : b_.seams)
      for (int k = 0; k < 2; ++k)
        if (seam.parts[k] == id_) add_notches(seam, k);
    add_label();
    if (o_.seam_text_height > 0)
      for (const Seam& seam : b_.seams)
        for (int k = 0; k < 2; ++k)
          if (seam.parts[k] == id_) add_seam_text(seam, k);
    add_rulings();
    std::stable_sort(
        part_.lines.begin(), part_.lines.end(),
        [](const BlueprintLine& x, const BlueprintLine& y) { return x.operation < y.operation; });
  }

 private:
  void draw(Operation operation, std::vector<Vector2> points, int seam = 0, double angle = 0) {
    part_.lines.push_back({operation, std::move(points), false, seam, angle});
  }

  bool free(const TurnedBox& box) const {
    if (!inside_.holds(box)) return false;
    return std::none_of(taken_.begin(), taken_.end(), [&](const TurnedBox& t) { return overlap(t, box); });
  }

  void write(std::string_view text, double height, const TurnedBox& box, int seam, bool underlined) {
    const StrokeText strokes = stroke_text(text, height);
    const Vector2 origin = box.center - strokes.width / 2 * box.axis - height / 2 * box.up();
    const auto at = [&](const Vector2& p) { return Vector2(origin + p.x() * box.axis + p.y() * box.up()); };
    for (const std::vector<Vector2>& line : strokes.lines) {
      std::vector<Vector2> points;
      for (const Vector2& p : line) points.push_back(at(p));
      draw(Operation::kText, std::move(points), seam);
    }
    // The line below tells 6 from 9 and where the label's foot is.
    if (underlined)
      draw(Operation::kText, {at({0, -0.2 * height}), at({strokes.width, -0.2 * height})}, seam);
    taken_.push_back(box);
  }

  static TurnedBox box_for(double width, double height, const Vector2& center, const Vector2& axis) {
    return {center, axis, width / 2 + kPadding * height, height / 2 + kPadding * height};
  }

  struct Spot {
    Vector2 center, axis;
  };

  // The roomiest place, level before turned, then places along the part with the text across the rulings.
  std::vector<Spot> label_spots() const {
    std::vector<Spot> spots;
    const Pole pole = pole_of_inaccessibility(part_.outline, std::max(0.02 * o_.label_height, 1e-3));
    const Vector2& level = part_.level;
    for (int turn = 0; turn < 12; ++turn) {
      const double a = kPi / 12 * ((turn + 1) / 2) * (turn % 2 ? 1 : -1);
      spots.push_back({pole.center, std::cos(a) * level + std::sin(a) * left_of(level)});
    }
    std::vector<const Crease*> rulings;
    for (const Crease& c : creases_)
      if (c.ruling >= 0) rulings.push_back(&c);
    const std::size_t step = rulings.size() / 24 + 1;
    for (std::size_t i = step / 2; i < rulings.size(); i += step) {
      const Vector2 &a = b_.flat[rulings[i]->vt[0]], &c = b_.flat[rulings[i]->vt[1]];
      Vector2 across = left_of((c - a).normalized());
      if (across.dot(level) < 0) across = -across;
      spots.push_back({0.5 * (a + c), across});
    }
    return spots;
  }

  // Writes the text at the first spot where it fits, as high as possible from `largest` down; the height
  // used, 0: none.
  double write_at_a_spot(const std::string& text, double largest, double smallest,
                         const std::vector<Spot>& spots, bool underlined) {
    for (double height = largest; height >= smallest; height *= 0.85)
      for (const Spot& spot : spots) {
        const TurnedBox box = box_for(stroke_text_width(text, height), (underlined ? 1.4 : 1.0) * height,
                                      spot.center, spot.axis);
        if (!free(box)) continue;
        write(text, height, box, 0, underlined);
        return height;
      }
    return 0;
  }

  // The label, and which side faces out: beside it where that costs little of its size.
  void add_label() {
    if (o_.label_height <= 0) return;
    const std::string side = o_.marked_face == Face::kOutside ? "OUT" : "IN";
    const std::vector<Spot> spots = label_spots();
    label_height_ = write_at_a_spot(part_.label + ' ' + side, o_.label_height,
                                    std::max(o_.smallest_text, 0.6 * o_.label_height), spots, true);
    if (label_height_ > 0) return;
    label_height_ = write_at_a_spot(part_.label, o_.label_height, o_.smallest_text, spots, true);
    if (label_height_ > 0)
      write_at_a_spot(side, 0.7 * label_height_, o_.smallest_text, spots, false);
    else
      b_.warnings.push_back("Part " + part_.label + " is too small for its label");
  }

  // A tick from the edge inwards, or a v cut out of the edge later; both keep texts away.
  void add_notches(const Seam& seam, int k) {
    if (o_.notches == NotchStyle::kNone) return;
    const std::vector<Vector2> side = side_of(seam, k, b_.flat);
    for (double s : notch_places(seam, o_.notch_size)) {
      const auto [p, d] = point_at(side, s);
      const Vector2 in = seam.left[k] ? left_of(d) : Vector2(-left_of(d));
      double length = o_.notch_size;
      const Vector2 root = p + 1e-4 * in;  // off the outline itself
      while (length > 0.1 * o_.notch_size &&
             (inside_.crossed(root, p + 1.2 * length * in) || near_a_tick(p, p + length * in)))
        length /= 2;
      ticks_.push_back({p, p + length * in});
      if (o_.notches == NotchStyle::kTick || o_.tabs != TabSides::kNone)
        draw(Operation::kNotch, {p, p + length * in}, seam.number);
      const bool vee = o_.notches == NotchStyle::kVee && o_.tabs == TabSides::kNone;
      const double half = vee ? 0.3 * o_.notch_size + 0.2 : 0.3;  // the edge of a v is 0.6 of its size wide
      taken_.push_back({p + length / 2 * in, in, length / 2 + 0.2, half});
    }
  }

  bool near_a_tick(const Vector2& a, const Vector2& b) const {
    return std::any_of(ticks_.begin(), ticks_.end(), [&](const std::array<Vector2, 2>& t) {
      return segment_distance(a, b, t[0], t[1]) < kTickClear * o_.notch_size;
    });
  }

  // "neighbour:seam" along the seam with its foot at the edge, as near the seam's middle as it fits.
  void add_seam_text(const Seam& seam, int k) {
    const std::vector<Vector2> side = side_of(seam, k, b_.flat);
    const std::string number = std::to_string(seam.number),
                      full = b_.parts[seam.parts[1 - k]].label + ":" + number;
    // Never as large as the part's own label: nobody shall take a neighbour's name for it.
    const double largest =
        label_height_ > 0 ? std::min(o_.seam_text_height, 0.75 * label_height_) : o_.seam_text_height;
    for (const std::string& text : {full, number})
      for (double height = std::max(largest, o_.smallest_text); height >= o_.smallest_text; height *= 0.8)
        for (double share : {0.5, 0.42, 0.58, 0.15, 0.85, 0.33, 0.67})
          for (double inset : {0.45, 0.9, 1.6, 2.6})
            if (const auto box =
                    seam_box(side, seam.left[k], share * seam.length, inset * height, text, height))
              return write(text, height, *box, seam.number, false);
    b_.warnings.push_back("Part " + part_.label + " has no room for the number of seam " + number);
  }

  std::optional<TurnedBox> seam_box(const std::vector<Vector2>& side, bool left, double s, double inset,
                                    const std::string& text, double height) const {
    const double width = stroke_text_width(text, height);
    const Vector2 a = point_at(side, s - width / 2).point, b = point_at(side, s + width / 2).point,
                  middle = point_at(side, s).point;
    Vector2 along = b - a;
    if (!(along.norm() > 0)) return std::nullopt;
    along = (left ? along : Vector2(-along)).normalized();
    const TurnedBox box = box_for(width, height, middle + (inset + height / 2) * left_of(along), along);
    return free(box) ? std::optional(box) : std::nullopt;
  }

  void add_rulings() {
    if (o_.rulings == RulingStyle::kNone) return;
    const double sign = o_.marked_face == Face::kInside ? -1 : 1;
    std::vector<Fold> folds;
    for (const DrawnRuling& r :
         thinned_rulings(ruling_turns(b_.strips, part_.patch, creases_), o_.ruling_step, o_.hidden_bend)) {
      const Vector2 &a = b_.flat[creases_[r.ruling].vt[0]], &c = b_.flat[creases_[r.ruling].vt[1]];
      const double length = (c - a).norm(), clear = std::min(o_.ruling_clear, 0.25 * length);
      folds.push_back({a, (c - a) / length, clear, length - clear, sign * r.angle});
    }
    for (std::size_t i = 0; i < folds.size(); ++i) keep_apart(folds, i);
    for (const Fold& fold : folds) draw_fold(fold);
  }

  /// A ruling to be drawn, from `from` to `to` along it.
  struct Fold {
    Vector2 start, direction;
    double from, to, angle;
    Vector2 at(double s) const { return start + s * direction; }
  };

  // Where rulings run together their lines would cut the point out: an end goes back until it is clear of
  // those drawn before, but never past a third of its ruling.
  void keep_apart(std::vector<Fold>& folds, std::size_t index) const {
    Fold& fold = folds[index];
    const double room = fold.to - fold.from, step = std::max(room / 64, 1e-6);
    const auto near = [&](const Vector2& p) {
      for (std::size_t k = index > kNeighbours ? index - kNeighbours : 0; k < index; ++k)
        if (point_segment_distance(p, folds[k].at(folds[k].from), folds[k].at(folds[k].to)) < o_.ruling_clear)
          return true;
      return false;
    };
    for (double moved = 0; moved < room / 3 && near(fold.at(fold.from)); moved += step) fold.from += step;
    for (double moved = 0; moved < room / 3 && near(fold.at(fold.to)); moved += step) fold.to -= step;
  }

  // What texts and notches leave of a line: none of them is crossed.
  std::vector<std::array<double, 2>> free_stretches(const Fold& fold) const {
    std::vector<std::array<double, 2>> free{{fold.from, fold.to}};
    const double length = fold.to - fold.from;
    for (const TurnedBox& box : taken_) {
      const auto [enter, leave] = stretch_in(box, fold.at(fold.from), fold.at(fold.to));
      if (enter > leave) continue;
      const double low = fold.from + enter * length, high = fold.from + leave * length;
      std::vector<std::array<double, 2>> rest;
      for (const auto& [a, b] : free) {
        if (low - a >= kShortestFold) rest.push_back({a, std::min(b, low)});
        if (b - high >= kShortestFold) rest.push_back({std::max(a, high), b});
      }
      free = std::move(rest);
    }
    return free;
  }

  void draw_fold(const Fold& fold) {
    const std::vector<std::array<double, 2>> free = free_stretches(fold);
    const Operation operation = fold.angle >= 0 ? Operation::kScoreMountain : Operation::kScoreValley;
    const auto stretch = [&](double from, double to) {
      for (const auto& [a, b] : free) {
        const double low = std::max(from, a), high = std::min(to, b);
        if (high - low >= std::min(kShortestFold, to - from))
          draw(operation, {fold.at(low), fold.at(high)}, 0, fold.angle);
      }
    };
    switch (o_.rulings) {
      case RulingStyle::kScore:
        stretch(fold.from, fold.to);
        break;
      case RulingStyle::kPerforation:
        perforate(fold.from, fold.to, stretch);
        break;
      case RulingStyle::kTicks: {
        const double tick = std::min(o_.tick_length, 0.4 * (fold.to - fold.from));
        stretch(fold.from, fold.from + tick), stretch(fold.to - tick, fold.to);
        break;
      }
      case RulingStyle::kNone:
        break;
    }
  }

  // Real dashes, as many as fit, with a gap of equal length between each two.
  void perforate(double from, double to, const auto& stretch) const {
    const double room = to - from;
    const int dashes = std::max(1, static_cast<int>((room + o_.dash_gap) / (o_.dash + o_.dash_gap)));
    const double dash = dashes == 1 ? std::min(room, o_.dash) : o_.dash;
    const double gap = dashes == 1 ? 0 : (room - dashes * dash) / (dashes - 1);
    const double start = dashes == 1 ? from + (room - dash) / 2 : from;
    for (int i = 0; i < dashes; ++i) stretch(start + i * (dash + gap), start + i * (dash + gap) + dash);
  }

  Blueprint& b_;
  const BlueprintOptions& o_;
  BlueprintPart& part_;
  int id_;
  Inside inside_;
  std::vector<Crease> creases_;
  double label_height_ = 0;
  std::vector<TurnedBox> taken_;
  std::vector<std::array<Vector2, 2>> ticks_;
};

}  // namespace

void add_marks(Blueprint& blueprint) {
  for (std::size_t p = 0; p < blueprint.parts.size(); ++p) PartMarks(blueprint, static_cast<int>(p)).add();
}

}  // namespace sheetform
