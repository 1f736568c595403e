#include "sheetform/blueprint/layout_svg.h"

#include <algorithm>
#include <cmath>

#include "sheetform/blueprint/polygon_tools.h"
#include "sheetform/blueprint/stroke_font.h"
#include "sheetform/blueprint/text.h"

namespace sheetform {
namespace {

constexpr int kDecimals = 5;  // 10 nm: below what any check or cutter sees

class SvgWriter {
 public:
  explicit SvgWriter(const LayoutDrawing& drawing) : drawing_(drawing) {
    // A hair line on a normal page; thinner where the whole page is tiny.
    stroke_ = std::min(0.1, 2e-3 * std::max(drawing.width, drawing.height));
  }

  std::string write() {
    const std::string w = rounded(drawing_.width, kDecimals), h = rounded(drawing_.height, kDecimals);
    out_ = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" +
           w + "mm\" height=\"" + h + "mm\" viewBox=\"0 0 " + w + ' ' + h + "\">\n";
    for (const DrawnPart& part : drawing_.parts) add(part);
    return out_ + "</svg>\n";
  }

 private:
  void point(const Vector2& p) {
    append_rounded(out_, p.x(), kDecimals);
    out_ += ' ';
    append_rounded(out_, drawing_.height - p.y(), kDecimals);
  }

  void begin(const char* kind, const char* colour) {
    out_ += std::string("  <path class=\"") + kind + "\" fill=\"none\" stroke=\"" + colour +
            "\" stroke-width=\"" + rounded(stroke_, kDecimals) + "\" d=\"";
  }

  void draw(const std::vector<Vector2>& points) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      out_ += i == 0 ? "M" : " L";
      point(points[i]);
    }
  }

  void line(const char* kind, const char* colour, const std::vector<Vector2>& points, bool closed) {
    begin(kind, colour);
    draw(points);
    out_ += closed ? " Z\"/>\n" : "\"/>\n";
  }

  void add(const DrawnPart& part) {
    const std::string name = xml_escaped(part.label);
    out_ += " <g id=\"part-" + name + "\" data-patch=\"" + std::to_string(part.patch) + "\">\n";
    for (const auto& [a, b] : part.rulings) line("ruling", "#0000ff", {a, b}, false);
    line("cut", "#ff0000", part.outline, true);
    label(part);
    out_ += " </g>\n";
  }

  // In single strokes at the roomiest place, as high as the circle around it holds, 8 mm at most.
  void label(const DrawnPart& part) {
    Vector2 low = part.outline.front(), high = low;
    for (const Vector2& p : part.outline) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const Pole pole = pole_of_inaccessibility(part.outline, 0.01 * (high - low).maxCoeff());
    const double width = stroke_text_width(part.label, 1);
    const double size = std::min(8.0, 1.7 * pole.radius / std::hypot(width, 1));
    const StrokeText text = stroke_text(part.label, size);
    if (text.lines.empty() || !(size > 0)) return;
    begin("text", "#000000");
    for (const std::vector<Vector2>& line : text.lines) {
      std::vector<Vector2> points;
      for (const Vector2& p : line) points.push_back(pole.center + p - Vector2(text.width, text.height) / 2);
      out_ += &line == &text.lines.front() ? "" : " ";
      draw(points);
    }
    out_ += "\"/>\n";
  }

  const LayoutDrawing& drawing_;
  std::string out_;
  double stroke_;
};

}  // namespace

std::string write_layout_svg(const LayoutDrawing& drawing) { return SvgWriter(drawing).write(); }

}  // namespace sheetform
