#include "sheetform/blueprint/pdf_cover.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "sheetform/blueprint/assembly.h"
#include "sheetform/blueprint/sheet_svg.h"
#include "sheetform/blueprint/stroke_font.h"
#include "sheetform/blueprint/text.h"
#include "sheetform/strip/outline.h"

namespace sheetform {
namespace {

constexpr double kBody = 2.2, kSmall = 1.5, kHeading = 4;  // mm, height of capitals
constexpr double kLine = 2;                                // lines lie that many heights apart
constexpr double kBoxWidth = 100, kBoxHeight = 50;         // of the scale box
constexpr double kSampleWidth = 72;                        // of the drawn example

/// Pages filled from the top; a new one where the room ends.
class Flow {
 public:
  Flow(const PdfPaper& paper, PdfFile& file)
      : paper_(paper), file_(file), page_(paper.width, paper.height), left(std::max(10.0, paper.margin)) {
    y = top();
  }
  PdfPage& page() { return page_; }
  double width() const { return paper_.width - 2 * left; }
  /// Makes sure of that much room below y, on a new page if need be.
  void need(double height) {
    if (y - height >= left || y == top()) return;
    finish();
    page_ = PdfPage(paper_.width, paper_.height);
    y = top();
  }
  void finish() { file_.add_page(std::move(page_)); }
  /// A line of text, broken between words or, where a word is too long, inside of it.
  void paragraph(const std::string& text, double size) {
    for (const std::string& line : broken(text, size, width())) {
      need(kLine * size);
      y -= size, page_.text({left, y}, line, size), y -= (kLine - 1) * size;
    }
  }
  void heading(const std::string& text) {
    need(6 * kHeading);
    y -= kHeading;
    paragraph(text, kHeading);
    y -= 1;
  }
  /// Cells at shares of the width, each cut to the room up to the next.
  void row(const std::vector<std::pair<double, std::string>>& cells) {
    need(kLine * kBody);
    y -= kBody;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const double end = i + 1 < cells.size() ? cells[i + 1].first : 1.0;
      page_.text({left + cells[i].first * width(), y},
                 broken(cells[i].second, kBody, (end - cells[i].first) * width() - 1).front(), kBody);
    }
    y -= (kLine - 1) * kBody;
  }

 private:
  double top() const { return paper_.height - left; }

  static std::vector<std::string> broken(const std::string& text, double size, double room) {
    std::vector<std::string> lines{""};
    std::string word;
    const auto flush = [&] {
      if (helvetica_width(lines.back() + word, size) > room && !lines.back().empty()) lines.emplace_back();
      lines.back() += word;
      word.clear();
    };
    for (const char c : valid_utf8(text)) {
      const bool starts = (static_cast<unsigned char>(c) & 0xC0) != 0x80;
      if (starts && helvetica_width(word + c, size) > room) flush(), lines.emplace_back();
      word += c;
      if (c == ' ') flush();
    }
    flush();
    return lines;
  }

  const PdfPaper& paper_;
  PdfFile& file_;
  PdfPage page_;

 public:
  const double left;
  double y = 0;
};

const char* text_of(Operation operation) {
  switch (operation) {
    case Operation::kText:
      return "names and numbers";
    case Operation::kNotch:
      return "marks that meet the neighbour's";
    case Operation::kScoreMountain:
      return "mountain fold: away from you, seen from the marked side";
    case Operation::kScoreValley:
      return "valley fold: towards you";
    case Operation::kCutInner:
      return "cut, inside first";
    case Operation::kCutOuter:
      return "cut, outlines last";
    case Operation::kGuide:
      break;
  }
  return "not worked: notes";
}

class CoverWriter {
 public:
  CoverWriter(const Blueprint& b, const Profile& profile, const PdfPaper& paper,
              const std::vector<PdfTile>& tiles, PdfFile& file)
      : b_(b), profile_(profile), tiles_(tiles), flow_(paper, file) {}

  void write() {
    flow_.paragraph(b_.origin.model.empty() ? "Blueprint" : b_.origin.model, 5);
    totals();
    scale_box_and_sample();
    legend();
    map();
    part_list();
    steps();
    notes();
    origin();
    flow_.finish();
  }

 private:
  void totals() {
    const Totals t = totals_of(b_, profile_);
    const auto count = [](int n, const std::string& what) {
      return std::to_string(n) + ' ' + what + (n == 1 ? "" : "s");
    };
    flow_.y -= 1;
    flow_.paragraph(count(t.parts, "part") + " on " + count(t.sheets, "sheet") + ", " +
                        count(static_cast<int>(b_.seams.size()), "seam") + ". Cut " +
                        rounded(t.cut / 1000, 2) + " m, score " + rounded(t.score / 1000, 2) + " m, write " +
                        rounded(t.drawn / 1000, 2) + " m, glue " + rounded(t.glue / 1000, 2) + " m: about " +
                        count(static_cast<int>(std::ceil(t.minutes)), "minute") + ". " +
                        rounded(100 * (1 - t.used_share), 0) + " % of the sheets is waste.",
                    kBody);
  }

  // 100 x 50 mm outside, 40 x 20 mm inside: whoever measures them knows whether the printer has scaled.
  void scale_box_and_sample() {
    const bool beside = flow_.width() >= kBoxWidth + 8 + kSampleWidth;
    flow_.y -= 3;
    flow_.need(beside ? kBoxHeight : 2 * kBoxHeight);
    PdfPage& page = flow_.page();
    page.pen("#000000", 0.2);
    const auto box = [&](double dx, double dy, double w, double h) {
      const Vector2 p(flow_.left + dx, flow_.y - dy - h);
      page.line({p, p + Vector2(w, 0), p + Vector2(w, h), p + Vector2(0, h)}, true);
    };
    box(0, 0, kBoxWidth, kBoxHeight), box(30, 15, 40, 20);
    page.text({flow_.left + 3, flow_.y - 46},
              "outer box 100 x 50 mm, inner box 40 x 20 mm: measure before you cut", 1.9);
    if (!beside) flow_.y -= kBoxHeight + 6;
    sample({flow_.left + (beside ? kBoxWidth + 8 : 0), flow_.y - kBoxHeight + 4});
    flow_.y -= kBoxHeight + 4;
  }

  void strokes(Operation operation, const std::vector<Vector2>& points, bool closed) {
    const LayerStyle& style = profile_.of(operation);
    if (!style.drawn) return;
    flow_.page().pen(style.colour, style.width);
    for (const std::vector<Vector2>& dash : dashed(points, closed, style.dash))
      flow_.page().line(dash, false);
  }

  void writing(const std::string& text, double height, const Vector2& at) {
    for (std::vector<Vector2>& line : stroke_text(text, height).lines) {
      for (Vector2& p : line) p += at;
      strokes(Operation::kText, line, false);
    }
  }

  // A part as it is drawn, with everything that can be on one.
  void sample(const Vector2& low) {
    const auto at = [&](double x, double y) { return Vector2(low + Vector2(x, y)); };
    strokes(Operation::kCutOuter, {at(0, 0), at(kSampleWidth, 0), at(66, 40), at(8, 44)}, true);
    for (double x : {18.0, 51.0, 53.0}) strokes(Operation::kNotch, {at(x, 0), at(x, 2.5)}, false);
    strokes(Operation::kScoreMountain, {at(8, 3), at(13, 41)}, false);
    strokes(Operation::kScoreValley, {at(65, 3), at(60, 38)}, false);
    const std::string side = b_.options.marked_face == Face::kOutside ? "A1 OUT" : "A1 IN";
    writing(side, 6, at(20, 19));
    strokes(Operation::kText, {at(20, 17.8), at(20 + stroke_text_width(side, 6), 17.8)}, false);
    writing("B3:12", 3, at(28, 1.4));
  }

  void legend() {
    for (int i : profile_.order) {
      const LayerStyle& style = profile_.layers[i];
      const auto operation = static_cast<Operation>(i);
      if (!style.drawn) continue;
      flow_.need(5);
      flow_.y -= 3;
      strokes(operation, {{flow_.left, flow_.y + 1}, {flow_.left + 25, flow_.y + 1}}, false);
      flow_.page().text({flow_.left + 29, flow_.y},
                        std::string(text_of(operation)) + "   [" + style.layer + "]", kBody);
      flow_.y -= 2;
    }
    const bool outside = b_.options.marked_face == Face::kOutside;
    flow_.y -= 2;
    flow_.row({{0, outside ? "A1 OUT" : "A1 IN"},
               {0.14, std::string("name of the part; the side with the writing is the ") +
                          (outside ? "outside" : "inside") + " of the model"}});
    flow_.row({{0, "B3:12"},
               {0.14, "part B3 is joined to this edge; both edges of this seam carry its number, 12"}});
    flow_.row(
        {{0, "| and | |"}, {0.14, "bring one mark to one mark, two to two: the order tells the direction"}});
  }

  // --- where everything is

  void map() {
    flow_.heading(tiled() ? "Map of the pages: row - column" : "Sheets");
    double widest = 1, tallest = 1;
    for (const BlueprintSheet& s : b_.sheets)
      widest = std::max(widest, s.width), tallest = std::max(tallest, s.height);
    const int count = static_cast<int>(b_.sheets.size()), columns = std::min(count, count > 6 ? 5 : 3);
    const double cell = flow_.width() / columns;
    const double factor = std::min(0.94 * cell / widest, (count > columns ? 60.0 : 100.0) / tallest);
    for (int s = 0; s < count; ++s) {
      if (s % columns == 0) flow_.need(factor * tallest + 8);
      sheet_map(s, {flow_.left + (s % columns) * cell, flow_.y - factor * b_.sheets[s].height}, factor);
      if (s % columns == columns - 1 || s == count - 1) flow_.y -= factor * tallest + 8;
    }
  }

  void sheet_map(int s, const Vector2& corner, double factor) {
    PdfPage& page = flow_.page();
    const BlueprintSheet& sheet = b_.sheets[s];
    const auto frame = [&](const Vector2& low, const Vector2& high) {
      page.line({low, {high.x(), low.y()}, high, {low.x(), high.y()}}, true);
    };
    page.pen("#999999", 0.15);
    for (const PlacedPart& p : sheet.parts) {
      std::vector<Vector2> small = placed(b_.parts[p.part].outline, p.placement);
      for (Vector2& q : small) q = corner + factor * q;
      page.line(small, true);
    }
    page.pen("#000000", 0.2);
    frame(corner, corner + factor * Vector2(sheet.width, sheet.height));
    page.pen("#0066cc", 0.15);
    for (const PdfTile& t : tiles_) {
      if (t.sheet != s || t.name.empty()) continue;
      const Vector2 low = corner + factor * t.low,
                    high = corner + factor * (t.low + t.size).cwiseMin(Vector2(sheet.width, sheet.height));
      frame(low, high);
      const double size = std::clamp(0.12 * (high - low).minCoeff(), 1.2, 4.0);
      page.text({low.x() + 1, high.y() - 1 - size}, t.name, size);
    }
    for (const PlacedPart& p : sheet.parts) {
      const BlueprintPart& part = b_.parts[p.part];
      const Pole pole = pole_of_inaccessibility(part.outline, 0.5);
      const double size = std::clamp(0.5 * factor * pole.radius, 1.0, 2.6);
      const Vector2 at = corner + factor * p.placement(pole.center);
      page.text(at - Vector2(helvetica_width(part.label, size), size) / 2, part.label, size);
    }
    page.text(corner - Vector2(0, 3.5),
              "Sheet " + std::to_string(s + 1) + ": " + rounded(sheet.width, 1) + " x " +
                  rounded(sheet.height, 1) + " mm",
              1.8);
  }

  // Some of the part is on the page.
  static bool shows(const PdfTile& t, const Polygon& outline) {
    const TurnedBox box{t.low + t.size / 2, Vector2::UnitX(), t.size.x() / 2, t.size.y() / 2};
    for (std::size_t i = 0; i < outline.size(); ++i)
      if (meets(box, outline[i], outline[(i + 1) % outline.size()])) return true;
    return contains(outline, box.center);
  }

  bool tiled() const {
    return std::any_of(tiles_.begin(), tiles_.end(), [](const PdfTile& t) { return !t.name.empty(); });
  }

  // "1" or "1 (1-1 1-2)", for every sheet with a copy of the part.
  std::string places_of(int part) const {
    std::string out;
    std::set<int> seen;
    for (std::size_t s = 0; s < b_.sheets.size(); ++s)
      for (const PlacedPart& p : b_.sheets[s].parts) {
        if (p.part != part || !seen.insert(static_cast<int>(s)).second) continue;
        const Polygon outline = placed(b_.parts[part].outline, p.placement);
        std::string pages;
        for (const PdfTile& t : tiles_)
          if (t.sheet == static_cast<int>(s) && !t.name.empty() && shows(t, outline))
            pages += (pages.empty() ? "" : " ") + t.name;
        out += (out.empty() ? "" : ", ") + std::to_string(s + 1) + (pages.empty() ? "" : " (" + pages + ")");
      }
    return out;
  }

  void part_list() {
    flow_.heading("Parts");
    flow_.row({{0, "part"},
               {0.12, "size in mm"},
               {0.34, "area in cm2"},
               {0.48, tiled() ? "sheet (pages)" : "sheet"},
               {0.74, "how often"},
               {0.86, "mirror image"}});
    for (std::size_t p = 0; p < b_.parts.size(); ++p) {
      const BlueprintPart& part = b_.parts[p];
      const Vector2 size = bounds_of(placed(part.outline, flat_turn(part.outline))).size();
      flow_.row({{0, part.label},
                 {0.12, rounded(size.x(), 1) + " x " + rounded(size.y(), 1)},
                 {0.34, rounded(part.area / 100, 2)},
                 {0.48, places_of(static_cast<int>(p))},
                 {0.74, std::to_string(b_.options.copies)},
                 {0.86, part.mirror_of >= 0 ? b_.parts[part.mirror_of].label : ""}});
    }
  }

  void steps() {
    flow_.heading("Assembly");
    int number = 0;
    for (const AssemblyStep& step : assembly_order(b_))
      flow_.paragraph(std::to_string(++number) + ".  " + step_text(b_, step), kBody);
  }

  void notes() {
    if (b_.warnings.empty()) return;
    flow_.heading("Notes");
    for (const std::string& text : b_.warnings) flow_.paragraph(text, kBody);
  }

  // Whoever holds nothing but the paper can make it again.
  void origin() {
    flow_.heading("Made with");
    const BlueprintOrigin& o = b_.origin;
    for (const auto& [name, value] : {std::pair("version", &o.version),
                                      {"job", &o.job},
                                      {"input", &o.input_digest},
                                      {"again", &o.link},
                                      {"decomposition", &o.parameters},
                                      {"blueprint", &o.request}})
      if (!value->empty()) flow_.paragraph(std::string(name) + ": " + *value, kSmall);
  }

  const Blueprint& b_;
  const Profile& profile_;
  const std::vector<PdfTile>& tiles_;
  Flow flow_;
};

}  // namespace

void add_cover_pages(const Blueprint& blueprint, const Profile& profile, const PdfPaper& paper,
                     const std::vector<PdfTile>& tiles, PdfFile& file) {
  CoverWriter(blueprint, profile, paper, tiles, file).write();
}

}  // namespace sheetform
