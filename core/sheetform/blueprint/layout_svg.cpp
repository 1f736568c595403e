#include "sheetform/blueprint/layout_svg.h"

#include <algorithm>

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

  void line(const char* kind, const char* colour, const std::vector<Vector2>& points, bool closed) {
    out_ += std::string("  <path class=\"") + kind + "\" fill=\"none\" stroke=\"" + colour +
            "\" stroke-width=\"" + rounded(stroke_, kDecimals) + "\" d=\"";
    for (std::size_t i = 0; i < points.size(); ++i) out_ += i == 0 ? "M" : " L", point(points[i]);
    out_ += closed ? " Z\"/>\n" : "\"/>\n";
  }

  void add(const DrawnPart& part) {
    const std::string name = xml_escaped(part.label);
    out_ += " <g id=\"part-" + name + "\" data-patch=\"" + std::to_string(part.patch) + "\">\n";
    for (const auto& [a, b] : part.rulings) line("ruling", "#0000ff", {a, b}, false);
    line("cut", "#ff0000", part.outline, true);
    label(part, name);
    out_ += " </g>\n";
  }

  // In the middle of the part's box, a tenth of its smaller side high.
  void label(const DrawnPart& part, const std::string& name) {
    Vector2 low = part.outline.front(), high = low;
    for (const Vector2& p : part.outline) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const double size = std::min(8.0, 0.3 * (high - low).minCoeff());
    const Vector2 middle = 0.5 * (low + high);
    out_ += "  <text class=\"text\" x=\"" + rounded(middle.x(), kDecimals) + "\" y=\"" +
            rounded(drawing_.height - middle.y() + 0.35 * size, kDecimals) + "\" font-size=\"" +
            rounded(size, kDecimals) +
            "\" font-family=\"sans-serif\" text-anchor=\"middle\" fill=\"#000000\">" + name + "</text>\n";
  }

  const LayoutDrawing& drawing_;
  std::string out_;
  double stroke_;
};

}  // namespace

std::string write_layout_svg(const LayoutDrawing& drawing) { return SvgWriter(drawing).write(); }

}  // namespace sheetform
