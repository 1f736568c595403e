#include "sheetform/blueprint/joints.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sheetform/blueprint/fold_lines.h"
#include "sheetform/blueprint/seams.h"
#include "sheetform/blueprint/text.h"
#include "sheetform/strip/outline.h"

namespace sheetform {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kClearance = 0.5;   // mm between a tooth and whatever is not its foot
constexpr double kOverlap = 0.05;    // mm that a tooth reaches into its part, so that both unite
constexpr double kKept = 1.0 / 3;    // of a tooth that must remain
constexpr double kNoContact = 2e-3;  // mm that edges of a contour which are no neighbours keep apart
constexpr double kTolerable =
    0.25;                          // mm that thick edges may press into each other: glue and fibres give way
constexpr double kUncut = 1.0;     // mm of a slit that may stay closed at its tip
constexpr double kShortest = 2.0;  // mm of seam that a tooth needs

Vector2 left_of(const Vector2& d) { return {-d.y(), d.x()}; }

/// One tooth of one side of a seam.
struct Tooth {
  int seam, side;
  double from, to;            // mm along the seam
  std::vector<Vector2> foot;  // on the outline
  Polygon shape;              // grown into the part by kOverlap
};

// The stretch of a polyline between two arc lengths, its own corners included.
std::vector<Vector2> stretch_of(const std::vector<Vector2>& line, double from, double to) {
  std::vector<Vector2> out{point_at(line, from).point};
  double s = 0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    s += (line[i + 1] - line[i]).norm();
    if (s > from + 1e-6 && s < to - 1e-6) out.push_back(line[i + 1]);
  }
  out.push_back(point_at(line, to).point);
  return out;
}

Tooth make_tooth(const Seam& seam, int index, int k, const std::vector<Vector2>& side, double from, double to,
                 const BlueprintOptions& o) {
  Tooth t{index, k, from, to, stretch_of(side, from, to), {}};
  const double slope = o.tab_angle >= 90 ? 0 : 1 / std::tan(o.tab_angle * kPi / 180);
  const double depth = slope > 0 ? std::min(o.tab_depth, 0.4 * (to - from) / slope) : o.tab_depth;
  const double sign = seam.left[k] ? -1 : 1;  // outwards, seen along the side
  const auto outward = [&](double s) { return Vector2(sign * left_of(point_at(side, s).direction)); };
  // Inside of the foot first, then the far edge back.
  t.shape = t.foot;
  for (std::size_t i = 0; i < t.shape.size(); ++i) {
    const double s = from + (to - from) * static_cast<double>(i) / static_cast<double>(t.shape.size() - 1);
    t.shape[i] -= kOverlap * outward(s);
  }
  t.shape.push_back(t.foot.back());
  const int steps = std::max(1, static_cast<int>((to - from) / 2));
  for (int i = steps; i >= 0; --i) {
    const double s = from + slope * depth + (to - from - 2 * slope * depth) * i / steps;
    t.shape.push_back(point_at(side, s).point + depth * outward(s));
  }
  t.shape.push_back(t.foot.front());
  if (signed_area(t.shape) < 0) std::reverse(t.shape.begin(), t.shape.end());
  return t;
}

std::vector<Tooth> teeth_of(const Seam& seam, int index, int k, const Blueprint& b) {
  const BlueprintOptions& o = b.options;
  std::vector<Tooth> out;
  const std::vector<Vector2> side = side_of(seam, k, b.flat);
  const int n = std::max(1, static_cast<int>(std::lround(seam.length / o.tab_pitch)));
  const double pitch = seam.length / n, gap = std::min(0.5, 0.1 * pitch);
  for (int i = 0; i < n; ++i) {
    if (o.tabs == TabSides::kAlternate && (i + k) % 2 == 1) continue;
    const double from = i * pitch + gap / 2, to = (i + 1) * pitch - gap / 2;
    if (to - from >= kShortest) out.push_back(make_tooth(seam, index, k, side, from, to, o));
  }
  return out;
}

// Arc length at which a point of a closed outline lies on it.
double place_on(const Polygon& outline, const Vector2& point) {
  double best = 1e300, at = 0, s = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vector2 &a = outline[i], d = outline[(i + 1) % outline.size()] - a;
    const double n = d.squaredNorm(), t = n > 0 ? std::clamp((point - a).dot(d) / n, 0.0, 1.0) : 0.0;
    const double distance = (a + t * d - point).squaredNorm();
    if (distance < best) best = distance, at = s + t * std::sqrt(n);
    s += std::sqrt(n);
  }
  return at;
}

// The outline but for the tooth's foot as a band that the tooth keeps out of; only what is near.
Polygons rest_of_outline(const Polygon& outline, const Tooth& tooth, bool forward) {
  const Bounds box = bounds_of(tooth.shape);
  const double total = length_of(outline) + (outline.front() - outline.back()).norm(), free = 2 * kClearance;
  const double start = place_on(outline, forward ? tooth.foot.front() : tooth.foot.back()) - free;
  const double taken = length_of(tooth.foot) + 2 * free;
  Polygons bands;
  double s = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vector2 &a = outline[i], &b = outline[(i + 1) % outline.size()];
    const double length = (b - a).norm(), begin = s;
    s += length;
    if (!(length > 0) || (a.cwiseMax(b).array() < box.low.array() - free).any() ||
        (a.cwiseMin(b).array() > box.high.array() + free).any())
      continue;
    // What the foot leaves of this edge: before and behind [start, start + taken], in each turn around the
    // outline.
    double from = begin;
    for (int turn = -1; turn <= 1; ++turn) {
      const double low = start + turn * total, high = low + taken;
      if (high <= from || low >= s) continue;
      if (low > from)
        bands.push_back({a + (from - begin) / length * (b - a), a + (low - begin) / length * (b - a)});
      from = high;
    }
    if (from < s) bands.push_back({a + (from - begin) / length * (b - a), b});
  }
  for (Polygon& band : bands) {
    const Vector2 p = band[0], q = band[1], n = kClearance * left_of((q - p).stableNormalized());
    band = {p - n, q - n, q + n, p + n};
  }
  return bands;
}

// The piece that holds the foot's middle; empty if there is none.
Polygons piece_at_foot(const Polygons& pieces, const Tooth& tooth, const Polygon& whole) {
  const Vector2 probe = point_at(tooth.foot, length_of(tooth.foot) / 2).point;
  for (const Polygon& p : pieces) {
    if (signed_area(p) <= 0) continue;
    double near = 1e300;
    for (std::size_t i = 0; i < p.size(); ++i)
      near = std::min(near, point_segment_distance(probe, p[i], p[(i + 1) % p.size()]));
    if ((contains(p, probe) || near < kOverlap * 1.5) && signed_area(p) >= kKept * signed_area(whole))
      return {p};
  }
  return {};
}

/// Teeth and notches of one part.
class PartJoints {
 public:
  PartJoints(Blueprint& blueprint, int part) : b_(blueprint), part_(blueprint.parts[part]) {
    // The inside of the part without a rim as wide as the foot's overlap: a tooth may cover the rim, nothing
    // more.
    core_ = offset({part_.outline}, -2 * kOverlap, Corner::kMitred);
  }

  // Part and tooth are one contour together: no pocket between them, no place where they merely touch.
  bool joins_cleanly(const Polygon& tooth) const {
    const Polygons both = unite({part_.outline, tooth});
    return both.size() == 1 && self_contact(both.front(), kNoContact).i < 0;
  }

  // What is left of a tooth here; empty if too little.
  Polygons fitted(const Tooth& tooth) const {
    Polygons pieces = subtract({tooth.shape}, core_);
    if (const Polygons rest = rest_of_outline(part_.outline, tooth, b_.seams[tooth.seam].left[tooth.side]);
        !rest.empty())
      pieces = subtract(pieces, rest);
    Polygons others;
    for (const Polygons& placed_tooth : taken_)
      others.insert(others.end(), placed_tooth.begin(), placed_tooth.end());
    if (!others.empty()) pieces = subtract(pieces, others);
    pieces = piece_at_foot(pieces, tooth, tooth.shape);
    return !pieces.empty() && joins_cleanly(pieces.front()) ? pieces : Polygons{};
  }

  void take(const Tooth& tooth, const Polygons& pieces, double angle) {
    teeth_.insert(teeth_.end(), pieces.begin(), pieces.end());
    taken_.push_back(offset(pieces, kClearance, Corner::kMitred));
    part_.lines.push_back({angle >= 0 ? Operation::kScoreMountain : Operation::kScoreValley, tooth.foot,
                           false, b_.seams[tooth.seam].number, angle});
  }

  void cut_vee(const Vector2& at, const Vector2& inward, double size) {
    const Vector2 d = 0.5 * (size + kOverlap) * left_of(inward);  // `size` wide at the edge itself
    vees_.push_back({at - kOverlap * inward - d, at - kOverlap * inward + d, at + size * inward});
    if (signed_area(vees_.back()) < 0) std::reverse(vees_.back().begin(), vees_.back().end());
  }

  void finish() {
    if (teeth_.empty() && vees_.empty()) return;
    Polygons all = teeth_;
    all.push_back(part_.outline);
    part_.footprint = unite(all);
    if (!vees_.empty()) part_.footprint = subtract(part_.footprint, vees_);
    // What a v cuts off altogether is waste, no part of the part.
    std::stable_sort(part_.footprint.begin(), part_.footprint.end(),
                     [](const Polygon& x, const Polygon& y) { return signed_area(x) > signed_area(y); });
    std::size_t kept = 1;
    while (kept < part_.footprint.size() && signed_area(part_.footprint[kept]) < 0) ++kept;
    part_.footprint.resize(kept);
  }

 private:
  Blueprint& b_;
  BlueprintPart& part_;
  Polygons core_, teeth_, vees_;
  std::vector<Polygons> taken_;
};

// Both sides of a seam tried; with one side only, the side on which more of the teeth fit.
void add_tabs(Blueprint& b, int index, std::vector<PartJoints>& parts) {
  const Seam& seam = b.seams[index];
  const double angle = (b.options.marked_face == Face::kInside ? -1 : 1) * bend_of(b, seam);
  std::array<std::vector<std::pair<Tooth, Polygons>>, 2> fitted;
  std::array<double, 2> area{};
  for (int k = 0; k < 2; ++k)
    for (Tooth& tooth : teeth_of(seam, index, k, b)) {
      Polygons pieces = parts[seam.parts[k]].fitted(tooth);
      if (pieces.empty()) continue;
      area[k] += area_of(pieces);
      fitted[k].emplace_back(std::move(tooth), std::move(pieces));
    }
  const int better = area[1] > area[0] * (1 + 1e-6) ? 1 : 0;
  for (int k = 0; k < 2; ++k) {
    if (b.options.tabs == TabSides::kOne && k != better) continue;
    for (const auto& [tooth, pieces] : fitted[k]) parts[seam.parts[k]].take(tooth, pieces, angle);
  }
}

void add_vees(Blueprint& b, const Seam& seam, std::vector<PartJoints>& parts) {
  for (int k = 0; k < 2; ++k) {
    const std::vector<Vector2> side = side_of(seam, k, b.flat);
    for (double s : notch_places(seam, b.options.notch_size)) {
      const auto [p, d] = point_at(side, s);
      parts[seam.parts[k]].cut_vee(p, seam.left[k] ? left_of(d) : Vector2(-left_of(d)),
                                   0.6 * b.options.notch_size);
    }
  }
}

// How far the cuts of the part stay from a point of its outline.
double uncut_at(const Blueprint& b, const BlueprintPart& part, const Vector2& tip) {
  double near = 1e300;
  for (const BlueprintLine& line : part.lines) {
    if (line.operation != Operation::kCutOuter && line.operation != Operation::kCutInner) continue;
    for (std::size_t i = 0; i < line.points.size(); ++i)
      near = std::min(near,
                      point_segment_distance(tip, line.points[i], line.points[(i + 1) % line.points.size()]));
  }
  return near - b.options.kerf / 2;
}

}  // namespace

double bend_of(const Blueprint& b, const Seam& seam) {
  const StripMesh& m = b.strips;
  const std::vector<int>& arch = m.arches[seam.arch].vertices;
  double sum = 0, weight = 0;
  for (std::size_t i = 0; i + 1 < arch.size(); ++i) {
    std::array<int, 2> apex{-1, -1};
    for (int k = 0; k < 2; ++k)
      for (const StripMesh::Triangle& t : m.patches[b.parts[seam.parts[k]].patch].triangles)
        for (int c = 0; c < 3; ++c) {
          const bool here = t.vt[c] == seam.vt[k][i] && t.vt[(c + 1) % 3] == seam.vt[k][i + 1];
          const bool turned = t.vt[c] == seam.vt[k][i + 1] && t.vt[(c + 1) % 3] == seam.vt[k][i];
          if (here) apex[0] = t.v[(c + 2) % 3];
          if (turned) apex[1] = t.v[(c + 2) % 3];
        }
    if (apex[0] < 0 || apex[1] < 0) continue;
    const Vector3 &p = m.points[arch[i]], &q = m.points[arch[i + 1]];
    sum += bend_over(p, q, m.points[apex[0]], m.points[apex[1]]) * (q - p).norm();
    weight += (q - p).norm();
  }
  return weight > 0 ? sum / weight : 0;
}

void add_joints(Blueprint& b) {
  const bool tabs = b.options.tabs != TabSides::kNone, vees = b.options.notches == NotchStyle::kVee && !tabs;
  if (!tabs && !vees) return;
  std::vector<PartJoints> parts;
  for (std::size_t p = 0; p < b.parts.size(); ++p) parts.emplace_back(b, static_cast<int>(p));
  for (std::size_t s = 0; s < b.seams.size(); ++s) {
    if (tabs) add_tabs(b, static_cast<int>(s), parts);
    if (vees) add_vees(b, b.seams[s], parts);
  }
  for (PartJoints& part : parts) part.finish();
}

void note_thick_seams(Blueprint& b) {
  std::string list;
  for (const Seam& seam : b.seams) {
    const double angle = bend_of(b, seam),
                 clash = b.options.thickness / 2 * std::tan(std::abs(angle) / 2 * kPi / 180);
    if (clash < kTolerable) continue;
    list += (list.empty() ? "" : ", ") + std::to_string(seam.number) + " (" + rounded(std::abs(angle), 0) +
            " degrees, " + (angle > 0 ? "inside" : "outside") + " edges)";
  }
  if (!list.empty())
    b.warnings.push_back("At " + rounded(b.options.thickness, 2) +
                         " mm of thickness the edges of these seams press on each other; bevel each by half "
                         "the angle: " +
                         list);
}

void note_slits_left(Blueprint& b) {
  std::string list;
  for (const Seam& seam : b.seams)
    for (const auto& [one, other] : {std::pair(seam.vt[0].front(), seam.vt[1].front()),
                                     std::pair(seam.vt[0].back(), seam.vt[1].back())}) {
      if (one != other) continue;
      const double uncut = uncut_at(b, b.parts[seam.parts[0]], b.flat[one]);
      if (uncut > kUncut)
        list += (list.empty() ? "" : ", ") + std::to_string(seam.number) + " (" + rounded(uncut, 1) + " mm)";
    }
  if (!list.empty())
    b.warnings.push_back("A cut " + rounded(b.options.kerf, 2) +
                         " mm wide does not reach the tips of the slits of these seams; cut the rest with a "
                         "knife: " +
                         list);
}

}  // namespace sheetform
