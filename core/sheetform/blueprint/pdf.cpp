#include "sheetform/blueprint/pdf.h"

#include <algorithm>
#include <cmath>

#include "sheetform/base/error.h"
#include "sheetform/blueprint/option_limits.h"
#include "sheetform/blueprint/pdf_cover.h"
#include "sheetform/blueprint/pdf_file.h"
#include "sheetform/blueprint/sheet_svg.h"

namespace sheetform {
namespace {

constexpr double kCoverWidth = 210, kCoverHeight = 297;  // A4 where pages have no size of their own

class PdfWriter {
 public:
  PdfWriter(const Blueprint& blueprint, const Profile& profile, const PdfOptions& options)
      : b_(blueprint), profile_(profile), o_(options), tiled_(options.page_width > 0) {
    window_ = Vector2(o_.page_width - 2 * o_.page_margin, o_.page_height - 2 * o_.page_margin);
    if (tiled_ && !(window_.minCoeff() >= o_.overlap + 20))
      throw Error(ErrorCode::kInvalidParameter, "the page leaves no room for a tile", "page",
                  "Use a larger page, or less margin or overlap");
    for (int i : profile.order) layer_[i] = file_.add_layer(profile.layers[i].layer);
  }

  std::string write() {
    const std::vector<PdfTile> tiles = tiled_ ? tiles_of_all() : std::vector<PdfTile>{};
    const PdfPaper paper{tiled_ ? o_.page_width : kCoverWidth, tiled_ ? o_.page_height : kCoverHeight,
                         o_.page_margin};
    if (o_.cover) add_cover_pages(b_, profile_, paper, tiles, file_);
    if (o_.steps) add_step_pages(b_, paper.width, paper.height, o_.up, file_);
    if (tiled_) {
      for (const PdfTile& t : tiles) add_tile(t);
    } else {
      for (std::size_t s = 0; s < b_.sheets.size(); ++s) add_sheet(static_cast<int>(s));
    }
    const std::string title = b_.origin.model.empty() ? "sheetform blueprint" : b_.origin.model;
    file_.set_info("Title", title), file_.set_info("Creator", "sheetform " + b_.origin.version),
        file_.set_info("Subject", origin_json(b_));
    return file_.write();
  }

 private:
  // Calls draw(points, closed, style) for every stroke of an operation on a sheet, dashes resolved.
  template <class Draw>
  void strokes(int sheet, Operation operation, const Draw& draw) const {
    const BlueprintSheet& s = b_.sheets[sheet];
    const LayerStyle& style = profile_.of(operation);
    if (!style.drawn) return;
    const auto one = [&](const BlueprintLine& line, const std::vector<Vector2>& points) {
      if (style.dash.empty()) return draw(points, line.closed);
      for (const std::vector<Vector2>& dash : dashed(points, line.closed, style.dash)) draw(dash, false);
    };
    if (operation == Operation::kGuide)
      for (const BlueprintLine& line : s.guide) one(line, line.points);
    for (const PlacedPart& p : s.parts)
      for (const BlueprintLine& line : b_.parts[p.part].lines)
        if (line.operation == operation) one(line, placed(line.points, p.placement));
  }

  void draw_sheet(int sheet, const Vector2& shift, PdfPage& page) {
    for (int i : profile_.order) {
      const auto operation = static_cast<Operation>(i);
      page.begin_layer(layer_[i]);
      page.pen(profile_.layers[i].colour, profile_.layers[i].width);
      strokes(sheet, operation, [&](const std::vector<Vector2>& points, bool closed) {
        std::vector<Vector2> moved;
        for (const Vector2& p : points) moved.push_back(p + shift);
        page.line(moved, closed);
      });
      page.end_layer();
    }
  }

  void add_sheet(int sheet) {
    PdfPage page(b_.sheets[sheet].width, b_.sheets[sheet].height);
    draw_sheet(sheet, Vector2::Zero(), page);
    file_.add_page(std::move(page));
  }

  // --- tiles
  // ---------------------------------------------------------------------------------------------------------

  std::vector<PdfTile> tiles_of_all() const {
    std::vector<PdfTile> tiles;
    const Vector2 step = window_.array() - o_.overlap;
    for (std::size_t s = 0; s < b_.sheets.size(); ++s) {
      const int columns = tiles_needed(b_.sheets[s].width, window_.x(), o_.overlap),
                rows = tiles_needed(b_.sheets[s].height, window_.y(), o_.overlap);
      for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
          const PdfTile tile{static_cast<int>(s),
                             row,
                             column,
                             Vector2(column * step.x(), (rows - 1 - row) * step.y()),
                             window_,
                             rows * columns == 1 ? "" : name_of(row, column)};
          if (anything_on(tile)) tiles.push_back(tile);
        }
    }
    return tiles;
  }

  bool anything_on(const PdfTile& t) const {
    const TurnedBox box{t.low + window_ / 2, Vector2::UnitX(), window_.x() / 2, window_.y() / 2};
    bool found = false;
    for (int i = 0; i < kOperations && !found; ++i)
      strokes(t.sheet, static_cast<Operation>(i), [&](const std::vector<Vector2>& points, bool closed) {
        for (std::size_t k = 0; k + (closed ? 0 : 1) < points.size() && !found; ++k)
          found = meets(box, points[k], points[(k + 1) % points.size()]);
      });
    return found;
  }

  // Row 1 is the top one. Not with a letter: that is how parts are named.
  static std::string name_of(int row, int column) {
    return std::to_string(row + 1) + '-' + std::to_string(column + 1);
  }

  void add_tile(const PdfTile& t) {
    PdfPage page(o_.page_width, o_.page_height);
    const Vector2 low = Vector2::Constant(o_.page_margin), high = low + window_;
    page.begin_clip(low, high);
    draw_sheet(t.sheet, low - t.low, page);
    page.end_clip();
    page.pen("#999999", 0.1);
    page.line({low, {high.x(), low.y()}, high, {low.x(), high.y()}}, true);
    const bool alone = t.name.empty();
    page.text(low + Vector2(2, window_.y() + 2),
              "Sheet " + std::to_string(t.sheet + 1) + (alone ? "" : ", page " + t.name) +
                  "   print at 100 %" +
                  (alone ? "" : "; what lies beyond a dashed line is on the next page too"),
              2.4);
    mark_overlaps(t, low, high, page);
    file_.add_page(std::move(page));
  }

  // Where a page goes on: a dashed line, the neighbour's name, and two crosses that come to lie on the
  // neighbour's.
  void mark_overlaps(const PdfTile& t, const Vector2& low, const Vector2& high, PdfPage& page) const {
    const BlueprintSheet& sheet = b_.sheets[t.sheet];
    const double d = o_.overlap, text = std::min(2.0, 0.4 * d);
    const auto border = [&](const Vector2& a, const Vector2& b, const Vector2& inwards,
                            const std::string& name) {
      page.pen("#999999", 0.1);
      for (const auto& dash : dashed({a + d * inwards, b + d * inwards}, false, {3, 2}))
        page.line(dash, false);
      page.pen("#000000", 0.2);
      for (double share : {0.25, 0.75}) cross(page, a + share * (b - a) + d / 2 * inwards);
      const Vector2 middle = (a + b) / 2 + d / 2 * inwards;
      page.text(middle - Vector2(helvetica_width(name, text), text) / 2, name, text);
    };
    if (d <= 0) return;
    if ((t.low + window_).x() < sheet.width)
      border({high.x(), low.y()}, high, {-1, 0}, name_of(t.row, t.column + 1));
    if (t.column > 0) border(low, {low.x(), high.y()}, {1, 0}, name_of(t.row, t.column - 1));
    if (t.row > 0) border({low.x(), high.y()}, high, {0, -1}, name_of(t.row - 1, t.column));
    if (t.low.y() > 0) border(low, {high.x(), low.y()}, {0, 1}, name_of(t.row + 1, t.column));
  }

  static void cross(PdfPage& page, const Vector2& p) {
    page.line({p - Vector2(3, 0), p + Vector2(3, 0)}, false);
    page.line({p - Vector2(0, 3), p + Vector2(0, 3)}, false);
  }

  const Blueprint& b_;
  const Profile& profile_;
  const PdfOptions& o_;
  bool tiled_;
  Vector2 window_ = Vector2::Zero();
  PdfFile file_;
  std::array<int, kOperations> layer_{};
};

}  // namespace

int tiles_needed(double length, double window, double overlap) {
  if (length <= window) return 1;
  return 1 + static_cast<int>(std::ceil((length - window) / (window - overlap) - 1e-9));
}

std::string to_pdf(const Blueprint& blueprint, const Profile& profile, const PdfOptions& options) {
  require_in_range(options.page_width, "page_width"), require_in_range(options.page_height, "page_height");
  require_in_range(options.page_margin, "page_margin"), require_in_range(options.overlap, "page_overlap");
  if ((options.page_width > 0) != (options.page_height > 0))
    throw Error(ErrorCode::kInvalidParameter, "a page needs both a width and a height", "page");
  return PdfWriter(blueprint, profile, options).write();
}

}  // namespace sheetform
