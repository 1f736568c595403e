#include <charconv>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "sheetform/base/error.h"
#include "sheetform/blueprint/exports.h"
#include "sheetform/blueprint/materials.h"
#include "sheetform/blueprint/option_limits.h"
#include "sheetform/blueprint/text.h"

namespace sheetform {
namespace {

/// One parameter of a query: how it is described and how it is read.
struct Entry {
  ExportParameter described;
  std::function<void(ExportRequest&, const std::string&)> read;
  Entry only_for(std::vector<std::string> formats) && {
    described.formats = std::move(formats);
    return std::move(*this);
  }
};

[[noreturn]] void refuse(const std::string& name, const std::string& wanted) {
  throw Error(ErrorCode::kInvalidParameter, name + " takes " + wanted, name,
              "Correct the value or leave it out");
}

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : ", ") + word;
  return out;
}

double number(const std::string& name, const std::string& value) {
  double x = 0;
  const auto [end, code] = std::from_chars(value.data(), value.data() + value.size(), x);
  if (code != std::errc() || end != value.data() + value.size() || !std::isfinite(x))
    refuse(name, "a number");
  require_in_range(x, name);
  return x;
}

int whole(const std::string& name, const std::string& value) {
  const double x = number(name, value);
  if (x != std::floor(x)) refuse(name, "a whole number");
  return static_cast<int>(x);
}

// A number of the part of a request that `in` names: blueprint, pdf or frame.
template <class Options>
Entry real(const char* name, const char* unit, const char* text, Options ExportRequest::*in,
           double Options::*field) {
  const OptionLimits& limits = limits_of(name);
  return {{name, rounded(Options{}.*field, 4), text, "number", unit, "", limits.low, limits.high},
          [=](ExportRequest& r, const std::string& v) { r.*in.*field = number(name, v); }};
}

Entry real(const char* name, const char* unit, const char* text, double BlueprintOptions::*field) {
  return real(name, unit, text, &ExportRequest::blueprint, field);
}

Entry integer(const char* name, const char* text, int BlueprintOptions::*field) {
  const OptionLimits& limits = limits_of(name);
  return {{name, std::to_string(BlueprintOptions{}.*field), text, "integer", "", "", limits.low, limits.high},
          [=](ExportRequest& r, const std::string& v) { r.blueprint.*field = whole(name, v); }};
}

template <class T>
Entry choice(const char* name, const char* text, std::function<T&(ExportRequest&)> field,
             std::vector<std::pair<std::string, T>> values, const char* type = "choice") {
  ExportParameter described{name, "", text, type, "", ""};
  ExportRequest plain;
  for (const auto& [word, value] : values) {
    described.choices.push_back(word);
    if (value == field(plain)) described.otherwise = word;
  }
  const std::string list = joined(described.choices);
  return {std::move(described), [=, values = std::move(values)](ExportRequest& r, const std::string& v) {
            for (const auto& [word, value] : values)
              if (word == v) return void(field(r) = value);
            refuse(name, "one of " + list);
          }};
}

template <class T>
Entry choice(const char* name, const char* text, T BlueprintOptions::*field,
             std::vector<std::pair<std::string, T>> values) {
  return choice<T>(
      name, text, [=](ExportRequest& r) -> T& { return r.blueprint.*field; }, std::move(values));
}

Entry on_or_off(const char* name, const char* text, std::function<bool&(ExportRequest&)> field) {
  return choice<bool>(name, text, std::move(field), {{"on", true}, {"off", false}}, "switch");
}

std::optional<SheetSize> find_size(std::string_view name);

// A preset, WIDTHxHEIGHT in mm, or a word for a size of zero.
Entry size(const char* name, const char* zero, const char* text,
           std::function<void(ExportRequest&, SheetSize)> take) {
  ExportParameter described{name, zero, text, "size", "", ""};
  described.open = true;
  described.choices.push_back(zero);
  for (const auto& preset : sheet_presets()) described.choices.push_back(preset.first);
  const std::string list = joined(described.choices);
  return {std::move(described), [=](ExportRequest& r, const std::string& v) {
            const std::optional<SheetSize> found = v == zero ? SheetSize{0, 0} : find_size(v);
            if (!found) refuse(name, list + " or WIDTHxHEIGHT in mm");
            take(r, *found);
          }};
}

std::vector<Entry> sheet_entries() {
  using O = BlueprintOptions;
  const OptionLimits &sheets = limits_of("sheet"), &sizes = limits_of("model_size");
  return {
      Entry{{"model_size", "0", "Longest side of the finished model; 0: as it was decomposed", "number", "mm",
             "", sizes.low, sizes.high},
            [](ExportRequest& r, const std::string& v) { r.model_size = number("model_size", v); }},
      size("sheet_size", "auto", "Sheet, WIDTHxHEIGHT in mm; auto is one page as large as the parts need",
           [](ExportRequest& r, SheetSize s) {
             r.blueprint.sheet_width = s.width, r.blueprint.sheet_height = s.height;
           }),
      real("margin", "mm", "Free at every edge of a sheet", &O::margin),
      real("gap", "mm", "Between any two parts", &O::gap),
      integer("turns", "Angles that nesting tries", &O::turns),
      choice<Grain>(
          "grain", "Direction of the sheet's grain, which runs along its width, to the rulings", &O::grain,
          {{"any", Grain::kAny}, {"along", Grain::kAlongRulings}, {"across", Grain::kAcrossRulings}}),
      choice<Oversize>("oversize", "What becomes of a part larger than the sheet", &O::oversize,
                       {{"refuse", Oversize::kRefuse}, {"split", Oversize::kSplit}}),
      integer("copies", "Copies of the whole model", &O::copies),
      choice<Face>("face", "Side that is up and carries the marks", &O::marked_face,
                   {{"outside", Face::kOutside}, {"inside", Face::kInside}}),
      Entry{{"sheet",
             "all",
             "One sheet alone, by its number, or all",
             "integer",
             "",
             "",
             sheets.low,
             sheets.high,
             {"all"},
             true},
            [](ExportRequest& r, const std::string& v) { r.sheet = v == "all" ? 0 : whole("sheet", v); }}
          .only_for({"svg", "dxf"}),
      Entry{{"part", "", "One part alone, by its label; empty for all", "text", "", ""},
            [](ExportRequest& r, const std::string& v) { r.part = v; }}
          .only_for({"parts-svg", "parts-dxf", "fold"}),
  };
}

std::vector<Entry> mark_entries() {
  using O = BlueprintOptions;
  return {
      real("label_height", "mm", "Height of part labels; 0: none", &O::label_height),
      real("seam_text_height", "mm", "Height of the neighbour's label at each seam; 0: none",
           &O::seam_text_height),
      real("smallest_text", "mm", "Text that would be smaller is left out", &O::smallest_text),
      choice<NotchStyle>(
          "notches", "Marks at the edges that meet the neighbour's", &O::notches,
          {{"none", NotchStyle::kNone}, {"tick", NotchStyle::kTick}, {"vee", NotchStyle::kVee}}),
      real("notch_size", "mm", "Length of a tick, depth of a vee", &O::notch_size),
      choice<RulingStyle>("rulings", "How the lines along which the parts bend are drawn", &O::rulings,
                          {{"none", RulingStyle::kNone},
                           {"score", RulingStyle::kScore},
                           {"perforation", RulingStyle::kPerforation},
                           {"ticks", RulingStyle::kTicks}}),
      real("ruling_step", "degrees", "Bending that each line drawn stands for; 0: every ruling is drawn",
           &O::ruling_step),
      real("hidden_bend", "degrees", "Bending below which no line is drawn", &O::hidden_bend),
      real("ruling_clear", "mm", "Free at both ends of a line", &O::ruling_clear),
      real("dash", "mm", "Dashes of perforations", &O::dash),
      real("dash_gap", "mm", "Gaps of perforations", &O::dash_gap),
      real("tick_length", "mm", "Ticks at both ends of rulings that are drawn so", &O::tick_length),
  };
}

std::vector<std::string> material_names() {
  std::vector<std::string> names{""};
  for (const Material& m : materials()) names.push_back(m.name);
  return names;
}

std::vector<Entry> joint_entries() {
  using O = BlueprintOptions;
  ExportParameter material{
      "material", "", "Material that is checked for its smallest bending radius; empty: none",
      "choice",   "", ""};
  material.choices = material_names();
  return {
      choice<TabSides>("tabs", "Toothed glue tabs along the seams", &O::tabs,
                       {{"none", TabSides::kNone},
                        {"one", TabSides::kOne},
                        {"alternate", TabSides::kAlternate},
                        {"both", TabSides::kBoth}}),
      real("tab_depth", "mm", "Depth of tabs", &O::tab_depth),
      real("tab_angle", "degrees", "Angle of a tooth's flanks to the edge", &O::tab_angle),
      real("tab_pitch", "mm", "Length of seam for each tooth", &O::tab_pitch),
      real("kerf", "mm", "Full width of the cut; 0 when the machine's program takes care of it", &O::kerf),
      real("thickness", "mm", "Thickness of the material; 0: paper", &O::thickness),
      choice<MeshSurface>("surface", "Which face of the material the model is", &O::mesh_surface,
                          {{"outside", MeshSurface::kOutside},
                           {"middle", MeshSurface::kMiddle},
                           {"inside", MeshSurface::kInside}}),
      {std::move(material),
       [](ExportRequest& r, const std::string& v) {
         if (!v.empty()) material_named(v);
         r.blueprint.material = v;
       }},
      on_or_off("hinges",
                "Slots along rulings that bend below the material's radius; wants material and thickness",
                [](ExportRequest& r) -> bool& { return r.blueprint.hinges; }),
  };
}

std::vector<Entry> file_entries() {
  constexpr auto kPdf = &ExportRequest::pdf;
  constexpr auto kFrame = &ExportRequest::frame;
  ExportParameter profile{"profile", "makerspace", "Colours, layers, widths and order of the operations",
                          "choice",  "",           ""};
  std::vector<Entry> out;
  out.push_back(
      {std::move(profile), [](ExportRequest& r, const std::string& v) { r.blueprint.profile = v; }});
  out.push_back(on_or_off("bar", "A bar of 100 mm on every sheet with room",
                          [](ExportRequest& r) -> bool& { return r.blueprint.reference_bar; }));
  out.push_back(choice<DxfVersion>("dxf", "DXF version",
                                   [](ExportRequest& r) -> DxfVersion& { return r.dxf; },
                                   {{"r12", DxfVersion::kR12}, {"r2000", DxfVersion::kR2000}})
                    .only_for({"dxf", "parts-dxf", "zip"}));
  const std::vector<std::string> pdf{"pdf", "zip"}, frame{"frame", "zip"};
  out.push_back(
      size("page", "sheet", "A page a sheet, or the size of the pages to print on, WIDTHxHEIGHT in mm",
           [](ExportRequest& r, SheetSize s) { r.pdf.page_width = s.width, r.pdf.page_height = s.height; })
          .only_for(pdf));
  out.push_back(real("page_margin", "mm", "What the printer leaves white", kPdf, &PdfOptions::page_margin)
                    .only_for(pdf));
  out.push_back(
      real("page_overlap", "mm", "Shared by neighbouring tiles", kPdf, &PdfOptions::overlap).only_for(pdf));
  out.push_back(
      on_or_off("cover", "Cover with scale box, legend, map and lists", [](ExportRequest& r) -> bool& {
        return r.pdf.cover;
      }).only_for(pdf));
  out.push_back(on_or_off("steps", "A picture for each assembly step", [](ExportRequest& r) -> bool& {
                  return r.pdf.steps;
                }).only_for(pdf));
  out.push_back(choice<UpAxis>("up", "Axis of the model that points up in the pictures",
                               [](ExportRequest& r) -> UpAxis& { return r.pdf.up; },
                               {{"z", UpAxis::kZ},
                                {"y", UpAxis::kY},
                                {"x", UpAxis::kX},
                                {"-z", UpAxis::kMinusZ},
                                {"-y", UpAxis::kMinusY},
                                {"-x", UpAxis::kMinusX}})
                    .only_for(pdf));
  out.push_back(real("frame_radius", "mm", "Radius of the seam frame's rods", kFrame, &FrameOptions::radius)
                    .only_for(frame));
  out.push_back(real("frame_text", "mm", "Height of the numbers on the seam frame; 0: none", kFrame,
                     &FrameOptions::text_height)
                    .only_for(frame));
  out.push_back(
      on_or_off("frame_borders", "Rods along the model's border too", [](ExportRequest& r) -> bool& {
        return r.frame.borders;
      }).only_for(frame));
  return out;
}

const std::vector<Entry>& entries() {
  static const std::vector<Entry> all = [] {
    std::vector<Entry> out;
    const std::pair<const char*, std::vector<Entry> (*)()> groups[] = {
        {"sheet", sheet_entries}, {"marks", mark_entries}, {"joints", joint_entries}, {"file", file_entries}};
    for (const auto& [name, group] : groups)
      for (Entry& e : group()) {
        e.described.group = name;
        if (e.described.type == "number") e.described.text += " (" + e.described.unit + ")";
        out.push_back(std::move(e));
      }
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
      {"obj", ExportFormat::kObj},
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

// A preset or "600x400" in mm.
std::optional<SheetSize> find_size(std::string_view name) {
  for (const auto& [word, size] : sheet_presets())
    if (word == name) return size;
  const std::size_t x = name.find('x');
  if (x == std::string_view::npos) return std::nullopt;
  const auto read = [](std::string_view word, double& value) {
    const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
    return code == std::errc() && end == word.data() + word.size() && value >= 10 && value <= 20000;
  };
  SheetSize size{};
  const bool good = read(name.substr(0, x), size.width) && read(name.substr(x + 1), size.height);
  return good ? std::optional(size) : std::nullopt;
}

// Everything in force, so that the file can be made again whatever the defaults will be then.
std::string request_json(std::string_view format, const std::map<std::string, std::string>& query) {
  nlohmann::ordered_json j = {{"format", std::string(format)}};
  for (const Entry& e : entries()) {
    const auto given = query.find(e.described.name);
    j[e.described.name] = given == query.end() ? e.described.otherwise : given->second;
  }
  return j.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace

const std::vector<std::pair<std::string, SheetSize>>& sheet_presets() {
  static const std::vector<std::pair<std::string, SheetSize>> presets = {
      {"a4", {210, 297}},          {"a3", {297, 420}},          {"a2", {420, 594}},
      {"a1", {594, 841}},          {"a0", {841, 1189}},         {"letter", {215.9, 279.4}},
      {"legal", {215.9, 355.6}},   {"tabloid", {279.4, 431.8}}, {"a4-letter", {210, 279.4}},
      {"12x12in", {304.8, 304.8}}, {"12x24in", {304.8, 609.6}}, {"300x200", {300, 200}},
      {"600x300", {600, 300}},     {"600x400", {600, 400}},     {"700x500", {700, 500}},
      {"900x600", {900, 600}},     {"1200x600", {1200, 600}},   {"1220x610", {1220, 610}}};
  return presets;
}

std::vector<ExportParameter> export_parameters(const std::vector<Profile>& own) {
  std::vector<ExportParameter> out;
  for (const Entry& e : entries()) {
    out.push_back(e.described);
    if (e.described.name != "profile") continue;
    for (const std::vector<Profile>* list : {&own, &built_in_profiles()})
      for (const Profile& p : *list) out.back().choices.push_back(p.name);
  }
  return out;
}

const std::vector<ExportFormatText>& export_formats() {
  static const std::vector<ExportFormatText> formats = {
      {"svg", "image/svg+xml", "Sheets to cut, true to scale (SVG)"},
      {"dxf", "image/vnd.dxf", "Sheets to cut, in millimetres (DXF)"},
      {"parts-svg", "image/svg+xml", "One file a part (SVG)"},
      {"parts-dxf", "image/vnd.dxf", "One file a part, as online shops want it (DXF)"},
      {"pdf", "application/pdf", "Sheets to print, with cover, parts list and assembly steps (PDF)"},
      {"fold", "application/json", "Crease pattern and folded form (FOLD)"},
      {"obj", "model/obj", "Model with the sheets as texture (OBJ)"},
      {"frame", "model/stl", "Frame of rods along the seams, to print in 3D (STL)"},
      {"parts-json", "application/json", "Parts with areas, lengths and order of assembly (JSON)"},
      {"parts-csv", "text/csv", "Parts as a table (CSV)"},
      {"zip", "application/zip", "All of these and the result in one archive (ZIP)"}};
  return formats;
}

ExportRequest read_export_request(std::string_view format, const std::map<std::string, std::string>& query) {
  ExportRequest request;
  request.format = format_named(format);
  for (const auto& [name, value] : query) {
    const Entry* found = nullptr;
    for (const Entry& e : entries())
      if (e.described.name == name) found = &e;
    if (!found)
      throw Error(ErrorCode::kInvalidParameter, "there is no parameter of this name",
                  name.empty() ? "query" : name, "Leave it out");
    found->read(request, value);
  }
  validate(request.blueprint);
  request.text = request_json(format, query);
  return request;
}

}  // namespace sheetform
