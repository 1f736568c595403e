#include "sheetform/blueprint/pdf.h"

#include <algorithm>
#include <cmath>

#include "sheetform/base/error.h"
#include "sheetform/blueprint/assembly.h"
#include "sheetform/blueprint/option_limits.h"
#include "sheetform/blueprint/pdf_file.h"
#include "sheetform/blueprint/pdf_steps.h"
#include "sheetform/blueprint/sheet_svg.h"
#include "sheetform/blueprint/text.h"

namespace sheetform {
namespace {

constexpr double kCoverWidth = 210, kCoverHeight = 297;  // A4 where pages have no size of their own

struct Tile {
  int sheet, row, column;
  Vector2 low;  // on the sheet
};

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
    const std::vector<Tile> tiles = tiled_ ? tiles_of_all() : std::vector<Tile>{};
    if (o_.cover) add_cover(tiles);
    if (o_.cover) add_lists();
    if (o_.steps)
      add_step_pages(b_, o_.page_width > 0 ? o_.page_width : kCoverWidth,
                     o_.page_width > 0 ? o_.page_height : kCoverHeight, file_);
    if (tiled_) {
      for (const Tile& t : tiles) add_tile(t);
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

  std::vector<Tile> tiles_of_all() const {
    std::vector<Tile> tiles;
    const Vector2 step = window_.array() - o_.overlap;
    for (std::size_t s = 0; s < b_.sheets.size(); ++s) {
      const int columns = tiles_needed(b_.sheets[s].width, window_.x(), o_.overlap),
                rows = tiles_needed(b_.sheets[s].height, window_.y(), o_.overlap);
      for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
          const Tile tile{static_cast<int>(s), row, column, Vector2(column * step.x(), row * step.y())};
          if (anything_on(tile)) tiles.push_back(tile);
        }
    }
    return tiles;
  }

  bool anything_on(const Tile& t) const {
    const TurnedBox box{t.low + window_ / 2, Vector2::UnitX(), window_.x() / 2, window_.y() / 2};
    bool found = false;
    for (int i = 0; i < kOperations && !found; ++i)
      strokes(t.sheet, static_cast<Operation>(i), [&](const std::vector<Vector2>& points, bool closed) {
        for (std::size_t k = 0; k + (closed ? 0 : 1) < points.size() && !found; ++k)
          found = meets(box, points[k], points[(k + 1) % points.size()]);
      });
    return found;
  }

  static std::string name_of(const Tile& t) {
    return std::string(1, static_cast<char>('A' + t.row % 26)) +
           (t.row >= 26 ? std::to_string(t.row / 26) : "") + std::to_string(t.column + 1);
  }

  void add_tile(const Tile& t) {
    PdfPage page(o_.page_width, o_.page_height);
    const Vector2 low = Vector2::Constant(o_.page_margin), high = low + window_;
    page.begin_clip(low, high);
    draw_sheet(t.sheet, low - t.low, page);
    page.end_clip();
    page.pen("#999999", 0.1);
    page.line({low, {high.x(), low.y()}, high, {low.x(), high.y()}}, true);
    // Overlaps that the next tile covers: what lies beyond is printed on both.
    if ((t.low + window_).x() < b_.sheets[t.sheet].width)
      page.line({{high.x() - o_.overlap, low.y()}, {high.x() - o_.overlap, high.y()}}, false);
    if ((t.low + window_).y() < b_.sheets[t.sheet].height)
      page.line({{low.x(), high.y() - o_.overlap}, {high.x(), high.y() - o_.overlap}}, false);
    if (t.column > 0) page.line({{low.x() + o_.overlap, low.y()}, {low.x() + o_.overlap, high.y()}}, false);
    if (t.row > 0) page.line({{low.x(), low.y() + o_.overlap}, {high.x(), low.y() + o_.overlap}}, false);
    page.pen("#000000", 0.2);
    for (double share : {0.25, 0.75})
      for (const Vector2& p : {Vector2(low.x() + o_.overlap / 2, low.y() + share * window_.y()),
                               Vector2(high.x() - o_.overlap / 2, low.y() + share * window_.y()),
                               Vector2(low.x() + share * window_.x(), low.y() + o_.overlap / 2),
                               Vector2(low.x() + share * window_.x(), high.y() - o_.overlap / 2)})
        cross(page, p);
    page.text(low + Vector2(2, window_.y() + 2),
              "Sheet " + std::to_string(t.sheet + 1) + ", page " + name_of(t) + "   (print at 100 %)", 3);
    file_.add_page(std::move(page));
  }

  static void cross(PdfPage& page, const Vector2& p) {
    page.line({p - Vector2(3, 0), p + Vector2(3, 0)}, false);
    page.line({p - Vector2(0, 3), p + Vector2(0, 3)}, false);
  }

  // --- cover
  // ---------------------------------------------------------------------------------------------------------

  double width() const { return tiled_ ? o_.page_width : kCoverWidth; }
  double height() const { return tiled_ ? o_.page_height : kCoverHeight; }

  // A text cut to the room it has.
  static std::string fitted(const std::string& text, double size, double room) {
    std::string out = valid_utf8(text);
    while (!out.empty() && helvetica_width(out, size) > room) {
      out.pop_back();
      while (!out.empty() && (static_cast<unsigned char>(out.back()) & 0xC0) == 0x80) out.pop_back();
    }
    return out;
  }

  void add_cover(const std::vector<Tile>& tiles) {
    PdfPage page(width(), height());
    const double left = std::max(10.0, o_.page_margin), room = width() - 2 * left;
    double y = height() - left - 6;
    const auto row = [&](const std::string& text, double size) {
      page.text({left, y}, fitted(text, size, room), size), y -= 2 * size;
    };
    row(b_.origin.model.empty() ? "Blueprint" : b_.origin.model, 5);
    const Totals t = totals_of(b_, profile_);
    row(std::to_string(t.parts) + " parts on " + std::to_string(t.sheets) + " sheets, " +
            std::to_string(b_.seams.size()) + " seams; cut " + rounded(t.cut / 1000, 2) + " m, score " +
            rounded(t.score / 1000, 2) + " m, glue " + rounded(t.glue / 1000, 2) + " m, about " +
            rounded(std::ceil(t.minutes), 0) + " min",
        2.6);
    row("Marked side: " + std::string(b_.options.marked_face == Face::kOutside ? "outside" : "inside") +
            ".  \"B3:12\" at an edge: join part B3 here, seam 12.",
        2.6);
    row("Marks at the edges meet the neighbour's: one mark meets one, two meet two.", 2.6);
    for (const auto& [name, value] :
         {std::pair("job", &b_.origin.job), {"input", &b_.origin.input_digest}, {"link", &b_.origin.link}})
      if (!value->empty()) row(std::string(name) + ": " + *value, 2.2);
    y -= 4;
    y = add_scale_box(page, left, y);
    y = add_legend(page, left, y);
    if (tiled_) add_map(page, left, y, tiles);
    file_.add_page(std::move(page));
  }

  // 100 x 50 mm outside, 40 x 20 mm inside: whoever measures them knows whether the printer has scaled.
  double add_scale_box(PdfPage& page, double x, double y) const {
    page.pen("#000000", 0.2);
    const auto box = [&](double dx, double dy, double w, double h) {
      const Vector2 p(x + dx, y - dy - h);
      page.line({p, p + Vector2(w, 0), p + Vector2(w, h), p + Vector2(0, h)}, true);
    };
    box(0, 0, 100, 50), box(30, 15, 40, 20);
    page.text({x + 3, y - 46}, "outer box 100 x 50 mm, inner box 40 x 20 mm: measure before you cut", 1.9);
    return y - 58;
  }

  double add_legend(PdfPage& page, double x, double y) const {
    for (int i : profile_.order) {
      const LayerStyle& style = profile_.layers[i];
      if (!style.drawn) continue;
      page.pen(style.colour, style.width);
      for (const auto& dash : dashed({{x, y + 1}, {x + 25, y + 1}}, false, style.dash))
        page.line(dash, false);
      static const char* kText[kOperations] = {"labels",
                                               "marks that meet the neighbour's",
                                               "mountain fold (away from you)",
                                               "valley fold (towards you)",
                                               "cut inside first",
                                               "cut",
                                               "not worked: notes"};
      page.text({x + 29, y}, std::string(kText[i]) + "   [" + style.layer + "]", 2.4);
      y -= 5.5;
    }
    return y - 4;
  }

  // Which page lies where on each sheet.
  void add_map(PdfPage& page, double x, double y, const std::vector<Tile>& tiles) const {
    double widest = 1, tallest = 1;
    for (const BlueprintSheet& s : b_.sheets)
      widest = std::max(widest, s.width), tallest = std::max(tallest, s.height);
    const double room = width() - 2 * x, bottom = std::max(10.0, o_.page_margin);
    const int columns = std::min<int>(3, static_cast<int>(b_.sheets.size()));
    const double factor = std::min(room / columns / (widest * 1.1), (y - bottom) / (1.15 * tallest));
    for (std::size_t s = 0; s < b_.sheets.size(); ++s) {
      const Vector2 corner(
          x + static_cast<double>(s % static_cast<std::size_t>(columns)) * room / columns,
          y - 4 - factor * b_.sheets[s].height -
              static_cast<double>(s / static_cast<std::size_t>(columns)) * (factor * tallest + 8));
      if (corner.y() < bottom) return;  // more sheets than the cover holds
      page.pen("#aaaaaa", 0.1);
      strokes(static_cast<int>(s), Operation::kCutOuter,
              [&](const std::vector<Vector2>& points, bool closed) {
                std::vector<Vector2> small;
                for (const Vector2& p : points) small.push_back(corner + factor * p);
                page.line(small, closed);
              });
      page.pen("#000000", 0.15);
      for (const Tile& t : tiles) {
        if (t.sheet != static_cast<int>(s)) continue;
        const Vector2 low = corner + factor * t.low,
                      high = corner +
                             factor *
                                 (t.low + window_).cwiseMin(Vector2(b_.sheets[s].width, b_.sheets[s].height));
        page.line({low, {high.x(), low.y()}, high, {low.x(), high.y()}}, true);
        page.text(low + Vector2(1, 1), name_of(t), std::clamp(0.12 * (high - low).minCoeff(), 1.2, 4.0));
      }
      page.text(corner - Vector2(0, 4), "Sheet " + std::to_string(s + 1), 2.4);
    }
  }

  // --- lists
  // ---------------------------------------------------------------------------------------------------------

  void add_lists() {
    std::vector<std::string> rows;
    std::vector<int> sheet(b_.parts.size(), 0);
    for (std::size_t s = b_.sheets.size(); s-- > 0;)
      for (const PlacedPart& p : b_.sheets[s].parts) sheet[p.part] = static_cast<int>(s) + 1;
    for (std::size_t p = 0; p < b_.parts.size(); ++p) {
      const BlueprintPart& part = b_.parts[p];
      const Vector2 size = bounds_of(placed(part.outline, flat_turn(part.outline))).size();
      rows.push_back(part.label + "   " + rounded(size.x(), 1) + " x " + rounded(size.y(), 1) + " mm, " +
                     rounded(part.area / 100, 2) + " cm2, sheet " + std::to_string(sheet[p]) +
                     (b_.options.copies > 1 ? ", " + std::to_string(b_.options.copies) + " times" : "") +
                     (part.mirror_of >= 0 ? ", mirror image of " + b_.parts[part.mirror_of].label : ""));
    }
    list("Parts", rows);
    rows.clear();
    for (const AssemblyStep& step : assembly_order(b_)) {
      std::string text = std::to_string(rows.size() + 1) + ".  " + b_.parts[step.part].label;
      for (std::size_t i = 0; i < step.seams.size(); ++i) {
        const Seam& seam = b_.seams[step.seams[i]];
        const int other = seam.parts[0] == step.part ? seam.parts[1] : seam.parts[0];
        text += (i == 0 ? ": join " : ", ") + (other == step.part ? "itself" : b_.parts[other].label) +
                " at " + std::to_string(seam.number);
      }
      rows.push_back(text);
    }
    list("Steps", rows);
    if (!b_.warnings.empty()) list("Notes", b_.warnings);
  }

  void list(const std::string& title, const std::vector<std::string>& rows) {
    const double left = std::max(10.0, o_.page_margin), size = 2.2, step = 4.4;
    const int columns = width() > 180 && title == "Parts" ? 2 : 1;
    const double room = (width() - 2 * left) / columns;
    const int per_column = std::max(1, static_cast<int>((height() - 2 * left - 14) / step));
    for (std::size_t i = 0; i < rows.size(); i += static_cast<std::size_t>(per_column * columns)) {
      PdfPage page(width(), height());
      page.text({left, height() - left - 4}, title, 4);
      for (std::size_t k = i; k < std::min(rows.size(), i + static_cast<std::size_t>(per_column * columns));
           ++k) {
        const auto at = static_cast<int>(k - i);
        page.text({left + (at / per_column) * room, height() - left - 12 - step * (at % per_column)},
                  fitted(rows[k], size, room - 2), size);
      }
      file_.add_page(std::move(page));
    }
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
