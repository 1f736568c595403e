#include "sheetform/blueprint/sheet_svg.h"

#include <map>
#include <nlohmann/json.hpp>

#include "sheetform/blueprint/text.h"

namespace sheetform {
namespace {

constexpr int kDecimals = 4;

class SheetSvg {
 public:
  SheetSvg(const Blueprint& blueprint, int sheet, const Profile& profile)
      : b_(blueprint), sheet_(blueprint.sheets.at(sheet)), number_(sheet), profile_(profile) {}

  std::string write() {
    head();
    for (int i : profile_.order) {
      const auto operation = static_cast<Operation>(i);
      if (!profile_.of(operation).drawn) continue;
      const std::string name = to_string(operation);
      out_ += " <g inkscape:groupmode=\"layer\" inkscape:label=\"" +
              xml_escaped(profile_.of(operation).layer) + "\" id=\"" + name + "\">\n";
      if (operation == Operation::kGuide) guide();
      for (const PlacedPart& part : sheet_.parts) add_part(part, operation, name);
      out_ += " </g>\n";
    }
    return out_ + "</svg>\n";
  }

 private:
  void head() {
    const std::string w = rounded(sheet_.width, kDecimals), h = rounded(sheet_.height, kDecimals);
    out_ =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
        "xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" width=\"" +
        w + "mm\" height=\"" + h + "mm\" viewBox=\"0 0 " + w + ' ' + h + "\">\n <title>" +
        xml_escaped(b_.origin.model) + " sheet " + std::to_string(number_ + 1) + " of " +
        std::to_string(b_.sheets.size()) + "</title>\n <metadata>" + xml_escaped(origin_json(b_)) +
        "</metadata>\n";
  }

  void path(const std::string& attributes, const std::vector<std::vector<Vector2>>& lines, bool closed,
            const LayerStyle& style, double angle) {
    out_ += "   <path" + attributes + " fill=\"none\" stroke=\"" + style.colour + "\" stroke-width=\"" +
            rounded(style.width, kDecimals) + '"';
    if (profile_.angle_as_opacity && angle != 0)
      out_ += " opacity=\"" + rounded(std::abs(angle) / 180, 4) + '"';
    out_ += " d=\"";
    for (const std::vector<Vector2>& line : lines)
      for (std::size_t i = 0; i < line.size(); ++i) {
        out_ += i == 0 ? (&line == &lines.front() ? "M" : " M") : " L";
        append_rounded(out_, line[i].x(), kDecimals);
        out_ += ' ';
        append_rounded(out_, sheet_.height - line[i].y(), kDecimals);
      }
    out_ += closed ? " Z\"/>\n" : "\"/>\n";
  }

  void draw(const BlueprintLine& line, const std::vector<Vector2>& points, const LayerStyle& style) {
    std::string attributes;
    if (line.angle != 0) attributes = " data-angle=\"" + rounded(line.angle, 2) + '"';
    if (style.dash.empty()) return path(attributes, {points}, line.closed, style, line.angle);
    path(attributes, dashed(points, line.closed, style.dash), false, style, line.angle);
  }

  void guide() {
    for (const BlueprintLine& line : sheet_.guide) draw(line, line.points, profile_.of(Operation::kGuide));
  }

  // Texts and notches of one seam are one path: a label stays one thing to click on.
  void add_part(const PlacedPart& placed_part, Operation operation, const std::string& name) {
    const BlueprintPart& part = b_.parts[placed_part.part];
    const LayerStyle& style = profile_.of(operation);
    std::map<int, std::vector<std::vector<Vector2>>> by_seam;
    std::string& out = out_;
    const std::size_t before = out.size();
    const std::string copy = placed_part.copy == 0 ? "" : "-" + std::to_string(placed_part.copy + 1);
    out += "  <g id=\"" + name + '-' + xml_escaped(part.label) + copy + "\" data-part=\"" +
           xml_escaped(part.label) + "\" data-patch=\"" + std::to_string(part.patch) + "\" data-op=\"" +
           name + "\">\n";
    const std::size_t begun = out.size();
    for (const BlueprintLine& line : part.lines) {
      if (line.operation != operation) continue;
      const std::vector<Vector2> points = placed(line.points, placed_part.placement);
      if (operation == Operation::kText || operation == Operation::kNotch)
        by_seam[line.seam].push_back(points);
      else
        draw(line, points, style);
    }
    for (const auto& [seam, lines] : by_seam)
      path(seam > 0 ? " data-seam=\"" + std::to_string(seam) + '"' : "", lines, false, style, 0);
    if (out.size() == begun)
      out.resize(before);
    else
      out += "  </g>\n";
  }

  const Blueprint& b_;
  const BlueprintSheet& sheet_;
  int number_;
  const Profile& profile_;
  std::string out_;
};

}  // namespace

std::string to_svg(const Blueprint& blueprint, int sheet, const Profile& profile) {
  return SheetSvg(blueprint, sheet, profile).write();
}

std::string origin_json(const Blueprint& b) {
  const BlueprintOrigin& o = b.origin;
  nlohmann::ordered_json j = {
      {"generator", "sheetform " + o.version}, {"job", o.job},   {"model", o.model},
      {"input_digest", o.input_digest},        {"link", o.link}, {"profile", b.options.profile},
      {"scale_mm_per_unit", b.scale}};
  const auto from_text = [](const std::string& text) {
    const auto value = nlohmann::ordered_json::parse(text, nullptr, false);
    return value.is_discarded() ? nlohmann::ordered_json(nullptr) : value;
  };
  j["parameters"] = from_text(o.parameters), j["export"] = from_text(o.request);
  return j.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace sheetform
