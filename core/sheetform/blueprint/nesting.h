// Parts onto sheets, close together and never overlapping: bottom-left on a raster, with every part grown by
// half the gap before it is drawn on it. Hollows of strongly curved parts are used.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "sheetform/blueprint/polygon_tools.h"

namespace sheetform {

struct NestOptions {
  double width = 0, height = 0;  ///< mm, of a sheet; height 0: one sheet as high as it takes
  double margin = 5, gap = 3;    ///< mm
};

struct NestItem {
  Polygons footprint;         ///< outer contours and holes; holes are not used for other parts
  std::vector<double> turns;  ///< angles to try, radians
};

struct NestedItem {
  int sheet = -1;  ///< -1: larger than a sheet
  Placement placement;
};

/// Places items one by one. Distances between the footprints of two items on a sheet are never below the gap,
/// those to the edge never below the margin: every cell that the grown footprint can touch is taken (grown by
/// half the gap and by the cell's diagonal). Deterministic.
class Nester {
 public:
  explicit Nester(const NestOptions& options);
  /// On the first sheet with room, a new one if need be; sheet = -1 if it fits on none.
  NestedItem place(const NestItem& item);
  /// On this sheet or not at all.
  std::optional<Placement> place_on(int sheet, const NestItem& item);
  int sheet_count() const { return static_cast<int>(sheets_.size()); }
  /// Upper right corner of what lies on a sheet, margin added.
  Vector2 used(int sheet) const { return sheets_[sheet].used; }

 private:
  struct Run {
    int row, first, last;
  };
  struct Mask {  // a turned item on the raster
    double turn = 0;
    Vector2 low, size;         // of the footprint itself, turned; cells count from `low`
    int left = 0, bottom = 0;  // cell of the raster's (0, 0)
    int rows = 0;
    std::vector<Run> runs;
  };
  struct Spot {
    int x = 0, y = 0;
    double top = 0, right = 0;
    int mask = -1;
  };
  struct Sheet {
    std::vector<std::uint64_t>
        bits;  // levels x rows x words: level k says "one of the next 2^k cells is taken"
    Vector2 used = Vector2::Zero();
    int rows = 0;
  };
  std::optional<Mask> mask_of(const Polygons& footprint, double turn) const;
  std::vector<Mask> masks_of(const NestItem& item) const;
  Sheet empty_sheet() const;
  void grow(Sheet& sheet, int rows) const;
  std::optional<Spot> find(Sheet& sheet, const std::vector<Mask>& masks) const;
  bool find_for(Sheet& sheet, const Mask& mask, Spot& best) const;
  void forbid(const Sheet& sheet, const Run& run, int y, std::vector<std::uint64_t>& forbidden) const;
  void take(Sheet& sheet, const Mask& mask, const Spot& spot) const;
  void summarise_row(Sheet& sheet, int row) const;
  Placement placement_of(const Mask& mask, const Spot& spot) const;
  std::uint64_t* row_of(Sheet& s, int level, int row) const {
    return s.bits.data() + (std::size_t(row) * levels_ + level) * words_;
  }
  const std::uint64_t* row_of(const Sheet& s, int level, int row) const {
    return s.bits.data() + (std::size_t(row) * levels_ + level) * words_;
  }

  NestOptions o_;
  double cell_ = 1;
  int pad_ = 1, columns_ = 0, rows_ = 0, words_ = 0, levels_ = 1;
  std::vector<Sheet> sheets_;
};

}  // namespace sheetform
