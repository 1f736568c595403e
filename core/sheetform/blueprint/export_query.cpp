#include <charconv>
#include <cmath>
#include <functional>

#include "sheetform/base/error.h"
#include "sheetform/blueprint/exports.h"
#include "sheetform/blueprint/materials.h"
#include "sheetform/blueprint/text.h"

namespace sheetform {
namespace {

/// One parameter of a query: how it is read, what it is otherwise.
struct Entry {
  ExportParameter described;
  std::function<void(ExportRequest&, const std::string&)> read;
};

[[noreturn]] void refuse(const std::string& name, const std::string& wanted) {
  throw Error(ErrorCode::kInvalidParameter, name + " takes " + wanted, name,
              "Correct the value or leave it out");
}

double number(const std::string& name, const std::string& value) {
  double x = 0;
  const auto [end, code] = std::from_chars(value.data(), value.data() + value.size(), x);
  if (code != std::errc() || end != value.data() + value.size() || !std::isfinite(x))
    refuse(name, "a number");
  return x;
}

double number_between(const std::string& name, const std::string& value, double low, double high) {
  const double x = number(name, value);
  if (!(x >= low && x <= high)) refuse(name, "a number from " + rounded(low, 3) + " to " + rounded(high, 3));
  return x;
}

Entry real(const char* name, const char* text, double BlueprintOptions::*field) {
  return {{name, rounded(BlueprintOptions{}.*field, 4), text, {}},
          [name, field](ExportRequest& r, const std::string& v) { r.blueprint.*field = number(name, v); }};
}

Entry integer(const char* name, const char* text, int BlueprintOptions::*field) {
  return {{name, std::to_string(BlueprintOptions{}.*field), text, {}},
          [name, field](ExportRequest& r, const std::string& v) {
            const double x = number(name, v);
            if (x != std::floor(x) || std::abs(x) > 1e6) refuse(name, "a whole number");
            r.blueprint.*field = static_cast<int>(x);
          }};
}

bool truth(const std::string& name, const std::string& value) {
  if (value == "on" || value == "true" || value == "1") return true;
  if (value == "off" || value == "false" || value == "0") return false;
  refuse(name, "on or off");
}

template <class T>
Entry choice(const char* name, const char* text, T BlueprintOptions::*field,
             std::vector<std::pair<std::string, T>> values) {
  std::string list, otherwise;
  std::vector<std::string> words;
  for (const auto& [word, value] : values) {
    words.push_back(word);
    list += (list.empty() ? "" : ", ") + word;
    if (value == BlueprintOptions{}.*field) otherwise = word;
  }
  const std::string described = std::string(text) + ": " + list;
  return {{name, otherwise, described, words},
          [name, field, values = std::move(values), list](ExportRequest& r, const std::string& v) {
            for (const auto& [word, value] : values)
              if (word == v) return void(r.blueprint.*field = value);
            refuse(name, "one of " + list);
          }};
}

Entry other(const char* name, const char* otherwise, const char* text,
            std::function<void(ExportRequest&, const std::string&)> read) {
  return {{name, otherwise, text, {}}, std::move(read)};
}

Entry with_choices(Entry entry, std::vector<std::string> choices, bool open = false) {
  entry.described.choices = std::move(choices);
  entry.described.open = open;
  return entry;
}

Entry on_or_off(const char* name, const char* otherwise, const char* text,
                std::function<void(ExportRequest&, bool)> set) {
  return with_choices(other(name, otherwise, text,
                            [name = std::string(name), set = std::move(set)](
                                ExportRequest& r, const std::string& v) { set(r, truth(name, v)); }),
                      {"on", "off"});
}

/// `first` and the presets; other sizes are taken too.
std::vector<std::string> sizes_and(const char* first) {
  std::vector<std::string> words{first};
  for (const auto& preset : sheet_presets()) words.push_back(preset.first);
  return words;
}

std::vector<std::string> profile_names() {
  std::vector<std::string> words;
  for (const Profile& p : built_in_profiles()) words.push_back(p.name);
  return words;
}

std::vector<std::string> material_names() {
  std::vector<std::string> words;
  for (const Material& m : materials()) words.push_back(m.name);
  return words;
}

std::vector<Entry> sheet_entries() {
  return {
      with_choices(
          other("sheet_size", "auto",
                "Sheet: a preset, WIDTHxHEIGHT in mm, or auto for one page as large as the parts need",
                [](ExportRequest& r, const std::string& v) {
                  const SheetSize size = v == "auto" ? SheetSize{0, 0} : sheet_size_named(v);
                  r.blueprint.sheet_width = size.width, r.blueprint.sheet_height = size.height;
                }),
          sizes_and("auto"), true),
      real("margin", "mm free at every edge of a sheet", &BlueprintOptions::margin),
      real("gap", "mm between any two parts", &BlueprintOptions::gap),
      integer("turns", "Angles that nesting tries, 1 to 64", &BlueprintOptions::turns),
      choice<Grain>(
          "grain", "Direction of the sheet's grain to the rulings", &BlueprintOptions::grain,
          {{"any", Grain::kAny}, {"along", Grain::kAlongRulings}, {"across", Grain::kAcrossRulings}}),
      choice<Oversize>("oversize", "What becomes of a part larger than the sheet",
                       &BlueprintOptions::oversize,
                       {{"refuse", Oversize::kRefuse}, {"split", Oversize::kSplit}}),
      integer("copies", "Copies of the whole model", &BlueprintOptions::copies),
      choice<Face>("face", "Side that is up and carries the marks", &BlueprintOptions::marked_face,
                   {{"outside", Face::kOutside}, {"inside", Face::kInside}}),
      other("sheet", "all", "Number of one sheet alone",
            [](ExportRequest& r, const std::string& v) {
              if (v == "all") return void(r.sheet = 0);
              const double x = number("sheet", v);
              if (x != std::floor(x) || x < 1 || x > 1e6) refuse("sheet", "a number from 1, or all");
              r.sheet = static_cast<int>(x);
            }),
      other("part", "", "Label of one part alone",
            [](ExportRequest& r, const std::string& v) { r.part = v; }),
  };
}

std::vector<Entry> mark_entries() {
  return {
      real("label_height", "mm, height of part labels; 0: none", &BlueprintOptions::label_height),
      real("seam_text_height", "mm, height of the neighbour's label at each seam; 0: none",
           &BlueprintOptions::seam_text_height),
      real("smallest_text", "mm; text that would be smaller is left out", &BlueprintOptions::smallest_text),
      choice<NotchStyle>(
          "notches", "Marks at the edges that meet the neighbour's", &BlueprintOptions::notches,
          {{"none", NotchStyle::kNone}, {"tick", NotchStyle::kTick}, {"vee", NotchStyle::kVee}}),
      real("notch_size", "mm", &BlueprintOptions::notch_size),
      choice<RulingStyle>("rulings", "How the lines along which the parts bend are drawn",
                          &BlueprintOptions::rulings,
                          {{"none", RulingStyle::kNone},
                           {"score", RulingStyle::kScore},
                           {"perforation", RulingStyle::kPerforation},
                           {"ticks", RulingStyle::kTicks}}),
      real("ruling_step", "Degrees of bending for each line drawn; 0: every ruling",
           &BlueprintOptions::ruling_step),
      real("hidden_bend", "Degrees below which no line is drawn", &BlueprintOptions::hidden_bend),
      real("ruling_clear", "mm free at both ends of a line", &BlueprintOptions::ruling_clear),
      real("dash", "mm, of perforations", &BlueprintOptions::dash),
      real("dash_gap", "mm, of perforations", &BlueprintOptions::dash_gap),
      real("tick_length", "mm, of rulings drawn as ticks", &BlueprintOptions::tick_length),
  };
}

std::vector<Entry> joint_entries() {
  return {
      choice<TabSides>("tabs", "Toothed glue tabs along the seams", &BlueprintOptions::tabs,
                       {{"none", TabSides::kNone},
                        {"one", TabSides::kOne},
                        {"alternate", TabSides::kAlternate},
                        {"both", TabSides::kBoth}}),
      real("tab_depth", "mm", &BlueprintOptions::tab_depth),
      real("tab_angle", "Degrees of a tooth's flanks to the edge", &BlueprintOptions::tab_angle),
      real("tab_pitch", "mm along the seam for each tooth", &BlueprintOptions::tab_pitch),
      real("kerf", "mm, full width of the cut; 0 when the machine's program takes care of it",
           &BlueprintOptions::kerf),
      real("thickness", "mm of the material", &BlueprintOptions::thickness),
      choice<MeshSurface>("surface", "Which face of the material the model is",
                          &BlueprintOptions::mesh_surface,
                          {{"outside", MeshSurface::kOutside},
                           {"middle", MeshSurface::kMiddle},
                           {"inside", MeshSurface::kInside}}),
      with_choices(other("material", "", "Material that is checked for its smallest bending radius",
                         [](ExportRequest& r, const std::string& v) { r.blueprint.material = v; }),
                   material_names()),
      on_or_off("hinges", "off", "Slots along rulings that bend below the material's radius: on or off",
                [](ExportRequest& r, bool v) { r.blueprint.hinges = v; }),
  };
}

std::vector<Entry> file_entries() {
  return {
      with_choices(
          other(
              "profile", "makerspace",
              "Colours, layers and widths: makerspace, lightburn, boxes, ponoko, silhouette, inventor, astm, "
              "origami, print, or the operator's own",
              [](ExportRequest& r, const std::string& v) { r.blueprint.profile = v; }),
          profile_names(), true),
      on_or_off("bar", "on", "A bar of 100 mm on every sheet with room: on or off",
                [](ExportRequest& r, bool v) { r.blueprint.reference_bar = v; }),
      with_choices(other("dxf", "r12", "DXF version: r12, r2000",
                         [](ExportRequest& r, const std::string& v) {
                           if (v != "r12" && v != "r2000") refuse("dxf", "r12 or r2000");
                           r.dxf = v == "r12" ? DxfVersion::kR12 : DxfVersion::kR2000;
                         }),
                   {"r12", "r2000"}),
      with_choices(
          other("page", "sheet", "PDF: sheet for a page a sheet, or a page size over which sheets are tiled",
                [](ExportRequest& r, const std::string& v) {
                  const SheetSize size = v == "sheet" ? SheetSize{0, 0} : sheet_size_named(v);
                  r.pdf.page_width = size.width, r.pdf.page_height = size.height;
                }),
          sizes_and("sheet"), true),
      other("page_margin", "10", "PDF: mm that the printer leaves white",
            [](ExportRequest& r, const std::string& v) {
              r.pdf.page_margin = number_between("page_margin", v, 0, 100);
            }),
      other("page_overlap", "10", "PDF: mm shared by neighbouring tiles",
            [](ExportRequest& r, const std::string& v) {
              r.pdf.overlap = number_between("page_overlap", v, 0, 100);
            }),
      on_or_off("cover", "on", "PDF: cover with scale box, legend, map and lists: on or off",
                [](ExportRequest& r, bool v) { r.pdf.cover = v; }),
      on_or_off("steps", "on", "PDF: a picture for each assembly step: on or off",
                [](ExportRequest& r, bool v) { r.pdf.steps = v; }),
      other("frame_radius", "1.5", "Frame: mm, radius of the rods",
            [](ExportRequest& r, const std::string& v) {
              r.frame.radius = number_between("frame_radius", v, 0.05, 50);
            }),
      other("frame_text", "5", "Frame: mm, height of the seam numbers; 0: none",
            [](ExportRequest& r, const std::string& v) {
              r.frame.text_height = number_between("frame_text", v, 0, 100);
            }),
      on_or_off("frame_borders", "on", "Frame: rods along the model's border: on or off",
                [](ExportRequest& r, bool v) { r.frame.borders = v; }),
  };
}

const std::vector<Entry>& entries() {
  static const std::vector<Entry> all = [] {
    std::vector<Entry> out;
    for (auto* group : {sheet_entries, mark_entries, joint_entries, file_entries})
      for (Entry& e : group()) out.push_back(std::move(e));
    return out;
  }();
  return all;
}

ExportFormat format_named(std::string_view name) {
  static const std::vector<std::pair<std::string_view, ExportFormat>> formats = {
      {"svg", ExportFormat::kSvg},
      {"dxf", ExportFormat::kDxf},
      {"parts-svg", ExportFormat::kPartsSvg},
      {"parts-dxf", ExportFormat::kPartsDxf},
      {"pdf", ExportFormat::kPdf},
      {"fold", ExportFormat::kFold},
      {"frame", ExportFormat::kFrame},
      {"parts-json", ExportFormat::kPartList},
      {"parts-csv", ExportFormat::kPartTable},
      {"zip", ExportFormat::kAll}};
  std::string known;
  for (const auto& [word, format] : formats) {
    if (word == name) return format;
    known += (known.empty() ? "" : ", ") + std::string(word);
  }
  refuse("format", "one of " + known);
}

// "600x400" in mm.
bool parse_size(std::string_view text, SheetSize& out) {
  const std::size_t x = text.find('x');
  if (x == std::string_view::npos) return false;
  const auto read = [](std::string_view word, double& value) {
    const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
    return code == std::errc() && end == word.data() + word.size() && value >= 10 && value <= 20000;
  };
  return read(text.substr(0, x), out.width) && read(text.substr(x + 1), out.height);
}

}  // namespace

const std::vector<std::pair<std::string, SheetSize>>& sheet_presets() {
  static const std::vector<std::pair<std::string, SheetSize>> presets = {
      {"a4", {210, 297}},          {"a3", {297, 420}},          {"a2", {420, 594}},
      {"a1", {594, 841}},          {"a0", {841, 1189}},         {"letter", {215.9, 279.4}},
      {"legal", {215.9, 355.6}},   {"tabloid", {279.4, 431.8}}, {"a4-letter", {210, 279.4}},
      {"12x12in", {304.8, 304.8}}, {"12x24in", {304.8, 609.6}}};
  return presets;
}

SheetSize sheet_size_named(std::string_view name) {
  std::string known;
  for (const auto& [word, size] : sheet_presets()) {
    if (word == name) return size;
    known += word + ", ";
  }
  SheetSize size{};
  if (!parse_size(name, size)) refuse("sheet_size", known + "or WIDTHxHEIGHT in mm");
  return size;
}

const std::vector<ExportParameter>& export_parameters() {
  static const std::vector<ExportParameter> all = [] {
    std::vector<ExportParameter> out;
    for (const Entry& e : entries()) out.push_back(e.described);
    return out;
  }();
  return all;
}

ExportRequest read_export_request(std::string_view format, const std::map<std::string, std::string>& query) {
  ExportRequest request;
  request.format = format_named(format);
  for (const auto& [name, value] : query) {
    const Entry* found = nullptr;
    for (const Entry& e : entries())
      if (e.described.name == name) found = &e;
    if (!found)
      throw Error(ErrorCode::kInvalidParameter, "there is no parameter of this name", name, "Leave it out");
    found->read(request, value);
  }
  validate(request.blueprint);
  return request;
}

}  // namespace sheetform
