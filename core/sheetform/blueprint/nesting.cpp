#include "sheetform/blueprint/nesting.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace sheetform {
namespace {

constexpr double kCells = 500;            // along the longer side of a sheet
constexpr double kFinest = 0.4;           // mm; finer cells cost time and save nothing a cutter could hold
constexpr double kHalfDiagonal = 0.7072;  // of a cell

Bounds bounds_of_all(const Polygons& polygons) {
  Bounds box = bounds_of(polygons.front());
  for (const Polygon& p : polygons) {
    const Bounds b = bounds_of(p);
    box.low = box.low.cwiseMin(b.low), box.high = box.high.cwiseMax(b.high);
  }
  return box;
}

Polygons moved(const Polygons& polygons, const Placement& placement) {
  Polygons out = polygons;
  for (Polygon& polygon : out)
    for (Vector2& q : polygon) q = placement(q);
  return out;
}

// Where a horizontal line crosses the polygons, ascending.
void crossings_at(const Polygons& polygons, double y, std::vector<double>& out) {
  out.clear();
  for (const Polygon& p : polygons)
    for (std::size_t i = 0, j = p.size() - 1; i < p.size(); j = i++)
      if ((p[i].y() > y) != (p[j].y() > y))
        out.push_back(p[j].x() + (y - p[j].y()) / (p[i].y() - p[j].y()) * (p[i].x() - p[j].x()));
  std::sort(out.begin(), out.end());
}

// Bits of `forbidden` from `first` to `last`: the first that is clear, -1 if all are set.
int first_free(const std::vector<std::uint64_t>& forbidden, int first, int last) {
  for (int x = first; x <= last; x = (x / 64 + 1) * 64) {
    const std::uint64_t free = ~forbidden[x / 64] >> (x % 64);
    if (free == 0) continue;
    x += std::countr_zero(free);
    return x <= last ? x : -1;
  }
  return -1;
}

}  // namespace

Nester::Nester(const NestOptions& options) : o_(options) {
  const double longest = std::max(o_.width, o_.height);
  cell_ = std::max(longest / kCells, std::min(kFinest, longest / 50));
  pad_ = static_cast<int>(std::ceil((o_.gap / 2 + cell_) / cell_)) + 1;
  columns_ = static_cast<int>(std::ceil(o_.width / cell_)) + 2 * pad_;
  rows_ = o_.height > 0 ? static_cast<int>(std::ceil(o_.height / cell_)) + 2 * pad_ : 0;
  words_ = columns_ / 64 + 1;
  while ((1 << levels_) <= columns_) ++levels_;
}

std::optional<Nester::Mask> Nester::mask_of(const Polygons& footprint, double turn) const {
  Mask mask;
  mask.turn = turn;
  Polygons shape = moved(footprint, {std::cos(turn), std::sin(turn), Vector2::Zero()});
  const Bounds bounds = bounds_of_all(shape);
  mask.low = bounds.low, mask.size = bounds.size();
  if (mask.size.x() > o_.width - 2 * o_.margin ||
      (o_.height > 0 && mask.size.y() > o_.height - 2 * o_.margin))
    return std::nullopt;
  shape = moved(shape, {1, 0, -bounds.low});
  const Polygons grown = offset(shape, o_.gap / 2 + kHalfDiagonal * cell_ + 0.01, Corner::kRound);
  const Bounds box = bounds_of_all(grown);
  mask.left = static_cast<int>(std::floor(box.low.x() / cell_)),
  mask.bottom = static_cast<int>(std::floor(box.low.y() / cell_));
  mask.rows = static_cast<int>(std::ceil(box.high.y() / cell_)) - mask.bottom;
  std::vector<double> crossings;
  for (int row = 0; row < mask.rows; ++row) {
    crossings_at(grown, (mask.bottom + row + 0.5) * cell_, crossings);
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
      const int first = static_cast<int>(std::ceil(crossings[i] / cell_ - 0.5)) - mask.left;
      const int last = static_cast<int>(std::floor(crossings[i + 1] / cell_ - 0.5)) - mask.left;
      if (first <= last) mask.runs.push_back({row, first, last});
    }
  }
  // Long runs first: they rule places out soonest.
  std::stable_sort(mask.runs.begin(), mask.runs.end(),
                   [](const Run& a, const Run& b) { return a.last - a.first > b.last - b.first; });
  return mask;
}

std::vector<Nester::Mask> Nester::masks_of(const NestItem& item) const {
  std::vector<Mask> masks;
  for (double turn : item.turns)
    if (auto mask = mask_of(item.footprint, turn)) masks.push_back(std::move(*mask));
  return masks;
}

Nester::Sheet Nester::empty_sheet() const {
  Sheet sheet;
  grow(sheet, rows_);
  return sheet;
}

void Nester::grow(Sheet& sheet, int rows) const {
  if (rows <= sheet.rows) return;
  sheet.rows = rows;
  sheet.bits.resize(static_cast<std::size_t>(rows) * levels_ * words_, 0);
}

NestedItem Nester::place(const NestItem& item) {
  const std::vector<Mask> masks = masks_of(item);
  if (masks.empty()) return {};
  for (int s = 0;; ++s) {
    if (s == sheet_count()) sheets_.push_back(empty_sheet());
    const auto spot = find(sheets_[s], masks);
    if (!spot) continue;  // an empty sheet has room for every mask
    take(sheets_[s], masks[spot->mask], *spot);
    return {s, placement_of(masks[spot->mask], *spot)};
  }
}

std::optional<Placement> Nester::place_on(int sheet, const NestItem& item) {
  const std::vector<Mask> masks = masks_of(item);
  const auto spot = find(sheets_[sheet], masks);
  if (!spot) return std::nullopt;
  take(sheets_[sheet], masks[spot->mask], *spot);
  return placement_of(masks[spot->mask], *spot);
}

std::optional<Nester::Spot> Nester::find(Sheet& sheet, const std::vector<Mask>& masks) const {
  Spot best;
  for (std::size_t m = 0; m < masks.size(); ++m)
    if (find_for(sheet, masks[m], best)) best.mask = static_cast<int>(m);
  return best.mask >= 0 ? std::optional(best) : std::nullopt;
}

// Lowest place, then leftmost; better than `best` when its top is lower. Spots are in cells from the margins'
// corner.
bool Nester::find_for(Sheet& sheet, const Mask& mask, Spot& best) const {
  const int x_high = static_cast<int>(std::floor((o_.width - 2 * o_.margin - mask.size.x()) / cell_));
  const double room = o_.height > 0 ? o_.height - 2 * o_.margin - mask.size.y() : 1e300;
  const int low = mask.left + pad_, high = x_high + mask.left + pad_;
  std::vector<std::uint64_t> forbidden(words_);
  for (int y = 0;; ++y) {
    const double top = y * cell_ + mask.size.y();
    if (y * cell_ > room || (best.mask >= 0 && top >= best.top)) return false;
    const int row = y + mask.bottom + pad_;
    if (o_.height <= 0) grow(sheet, row + mask.rows + 1);
    std::fill(forbidden.begin(), forbidden.end(), 0);
    int x = low;
    for (std::size_t i = 0; i < mask.runs.size() && x >= 0; ++i) {
      forbid(sheet, mask.runs[i], row, forbidden);
      if (i % 16 == 15) x = first_free(forbidden, low, high);
    }
    x = first_free(forbidden, low, high);
    if (x < 0) continue;
    best = {x - low, y, top, (x - low) * cell_ + mask.size.x(), best.mask};
    return true;
  }
}

// Adds the offsets at which the run would lie on a taken cell.
void Nester::forbid(const Sheet& sheet, const Run& run, int y, std::vector<std::uint64_t>& forbidden) const {
  const int row = y + run.row;
  if (row < 0 || row >= sheet.rows) return;
  const int length = run.last - run.first + 1, level = std::bit_width(static_cast<unsigned>(length)) - 1;
  const std::uint64_t* bits = row_of(sheet, std::min(level, levels_ - 1), row);
  for (const int shift : {run.first, run.last + 1 - (1 << level)}) {
    const int words = shift / 64, rest = shift % 64;
    for (int w = 0; w + words < words_; ++w) {
      std::uint64_t v = bits[w + words] >> rest;
      if (rest > 0 && w + words + 1 < words_) v |= bits[w + words + 1] << (64 - rest);
      forbidden[w] |= v;
    }
  }
}

void Nester::take(Sheet& sheet, const Mask& mask, const Spot& spot) const {
  const int left = spot.x + mask.left + pad_, bottom = spot.y + mask.bottom + pad_;
  if (o_.height <= 0) grow(sheet, bottom + mask.rows + 1);
  std::vector<char> touched(static_cast<std::size_t>(std::max(0, mask.rows)), 0);
  for (const Run& run : mask.runs) {
    const int row = bottom + run.row;
    if (row < 0 || row >= sheet.rows) continue;
    std::uint64_t* bits = row_of(sheet, 0, row);
    for (int x = std::max(0, left + run.first); x <= std::min(columns_ - 1, left + run.last); ++x)
      bits[x / 64] |= std::uint64_t{1} << (x % 64);
    touched[run.row] = 1;
  }
  for (int r = 0; r < mask.rows; ++r)
    if (touched[r]) summarise_row(sheet, bottom + r);
  sheet.used = sheet.used.cwiseMax(Vector2(spot.right + 2 * o_.margin, spot.top + 2 * o_.margin));
}

void Nester::summarise_row(Sheet& sheet, int row) const {
  for (int level = 1; level < levels_; ++level) {
    const std::uint64_t* from = row_of(sheet, level - 1, row);
    std::uint64_t* to = row_of(sheet, level, row);
    const int shift = 1 << (level - 1), words = shift / 64, rest = shift % 64;
    for (int w = 0; w < words_; ++w) {
      std::uint64_t v = from[w];
      if (w + words < words_) v |= from[w + words] >> rest;
      if (rest > 0 && w + words + 1 < words_) v |= from[w + words + 1] << (64 - rest);
      to[w] = v;
    }
  }
}

Placement Nester::placement_of(const Mask& mask, const Spot& spot) const {
  const Vector2 corner = Vector2::Constant(o_.margin) + cell_ * Vector2(spot.x, spot.y);
  return {std::cos(mask.turn), std::sin(mask.turn), corner - mask.low};
}

}  // namespace sheetform
