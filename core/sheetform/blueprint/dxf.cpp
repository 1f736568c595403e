#include "sheetform/blueprint/dxf.h"

#include <algorithm>
#include <set>

#include "sheetform/blueprint/sheet_svg.h"
#include "sheetform/blueprint/text.h"

namespace sheetform {
namespace {

constexpr int kDecimals = 6;

struct Stroke {
  std::string layer;
  std::vector<Vector2> points;
  bool closed;
};

/// Group codes and values, the handles of R2000 counted up.
class DxfWriter {
 public:
  DxfWriter(DxfVersion version, double width, double height)
      : r2000_(version == DxfVersion::kR2000), width_(width), height_(height) {}

  std::string write(const std::vector<LayerStyle>& layers, const std::vector<Stroke>& strokes,
                    const std::string& comment) {
    header(comment);
    if (r2000_) section("CLASSES"), end_section();
    tables(layers);
    blocks();
    section("ENTITIES");
    for (const Stroke& s : strokes) entity(s);
    end_section();
    if (r2000_) objects();
    text(0, "EOF");
    // The next free handle is only known now.
    if (r2000_) out_.replace(out_.find(kSeed), std::string(kSeed).size(), hex(next_));
    return std::move(out_);
  }

 private:
  static constexpr const char* kSeed = "@SEED@";

  void text(int code, const std::string& value) { out_ += std::to_string(code) + "\r\n" + value + "\r\n"; }
  void integer(int code, int value) { text(code, std::to_string(value)); }
  void number(int code, double value) {
    std::string s = rounded(value, kDecimals);
    if (s.find('.') == std::string::npos) s += ".0";
    text(code, s);
  }
  void point(const Vector2& p) { number(10, p.x()), number(20, p.y()); }
  static std::string hex(int value) {
    std::string s;
    for (int v = value; v > 0; v /= 16) s.insert(s.begin(), "0123456789ABCDEF"[v % 16]);
    return s;
  }
  std::string handle() { return hex(next_++); }
  void section(const char* name) { text(0, "SECTION"), text(2, name); }
  void end_section() { text(0, "ENDSEC"); }

  void header(const std::string& comment) {
    std::string line = comment;
    std::replace_if(
        line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
    for (std::size_t at = 0; at < line.size(); at += 250)
      text(999, line.substr(at, 250));  // R12 lines end at 255
    section("HEADER");
    text(9, "$ACADVER"), text(1, r2000_ ? "AC1015" : "AC1009");
    if (r2000_) text(9, "$HANDSEED"), text(5, kSeed);
    text(9, "$INSUNITS"), integer(70, 4);
    text(9, "$MEASUREMENT"), integer(70, 1);
    text(9, "$LUNITS"), integer(70, 2);
    text(9, "$EXTMIN"), number(10, 0), number(20, 0), number(30, 0);
    text(9, "$EXTMAX"), number(10, width_), number(20, height_), number(30, 0);
    text(9, "$LIMMIN"), number(10, 0), number(20, 0);
    text(9, "$LIMMAX"), number(10, width_), number(20, height_);
    end_section();
  }

  // Begins a table; R2000 tables own their entries by handle.
  std::string table(const char* name, int entries) {
    text(0, "TABLE"), text(2, name);
    std::string id;
    if (r2000_) id = handle(), text(5, id), text(330, "0"), text(100, "AcDbSymbolTable");
    integer(70, entries);
    return id;
  }
  void end_table() { text(0, "ENDTAB"); }
  std::string record(const char* type, const std::string& owner, const char* subclass) {
    text(0, type);
    if (!r2000_) return {};
    const std::string id = handle();
    text(std::string(type) == "DIMSTYLE" ? 105 : 5, id), text(330, owner), text(100, "AcDbSymbolTableRecord"),
        text(100, subclass);
    return id;
  }

  void tables(const std::vector<LayerStyle>& layers) {
    section("TABLES");
    if (r2000_) {
      const std::string id = table("VPORT", 1);
      record("VPORT", id, "AcDbViewportTableRecord");
      text(2, "*ACTIVE"), integer(70, 0);
      number(10, 0), number(20, 0), number(11, 1), number(21, 1), number(12, width_ / 2),
          number(22, height_ / 2);
      number(40, std::max(1.0, height_)), number(41, std::max(0.1, width_ / std::max(1.0, height_)));
      end_table();
    }
    std::string id = table("LTYPE", r2000_ ? 3 : 1);
    for (const char* name : {"BYBLOCK", "BYLAYER", "CONTINUOUS"}) {
      if (!r2000_ && std::string(name) != "CONTINUOUS") continue;
      record("LTYPE", id, "AcDbLinetypeTableRecord");
      text(2, name), integer(70, 0), text(3, ""), integer(72, 65), integer(73, 0), number(40, 0);
    }
    end_table();
    layer_table(layers);
    id = table("STYLE", 1);
    record("STYLE", id, "AcDbTextStyleTableRecord");
    text(2, "STANDARD"), integer(70, 0), number(40, 0), number(41, 1), number(50, 0), integer(71, 0),
        number(42, 2.5), text(3, "txt"), text(4, "");
    end_table();
    if (r2000_) more_tables();
    end_section();
  }

  void layer_table(const std::vector<LayerStyle>& layers) {
    const std::string id = table("LAYER", static_cast<int>(layers.size()) + 1);
    record("LAYER", id, "AcDbLayerTableRecord");
    text(2, "0"), integer(70, 0), integer(62, 7), text(6, "CONTINUOUS");
    for (const LayerStyle& layer : layers) {
      record("LAYER", id, "AcDbLayerTableRecord");
      text(2, layer.layer), integer(70, 0), integer(62, layer.aci), text(6, "CONTINUOUS");
    }
    end_table();
  }

  // Tables that R2000 wants although they say nothing.
  void more_tables() {
    for (const char* name : {"VIEW", "UCS"}) table(name, 0), end_table();
    std::string id = table("APPID", 1);
    record("APPID", id, "AcDbRegAppTableRecord");
    text(2, "ACAD"), integer(70, 0);
    end_table();
    id = table("DIMSTYLE", 1);
    text(100, "AcDbDimStyleTable");
    record("DIMSTYLE", id, "AcDbDimStyleTableRecord");
    text(2, "STANDARD"), integer(70, 0);
    end_table();
    id = table("BLOCK_RECORD", 2);
    model_space_ = record("BLOCK_RECORD", id, "AcDbBlockTableRecord");
    text(2, "*Model_Space");
    paper_space_ = record("BLOCK_RECORD", id, "AcDbBlockTableRecord");
    text(2, "*Paper_Space");
    end_table();
  }

  void blocks() {
    section("BLOCKS");
    if (r2000_) block("*Model_Space", model_space_), block("*Paper_Space", paper_space_);
    end_section();
  }

  void block(const char* name, const std::string& owner) {
    text(0, "BLOCK"), text(5, handle()), text(330, owner), text(100, "AcDbEntity"), text(8, "0"),
        text(100, "AcDbBlockBegin");
    text(2, name), integer(70, 0), number(10, 0), number(20, 0), number(30, 0), text(3, name), text(1, "");
    text(0, "ENDBLK"), text(5, handle()), text(330, owner), text(100, "AcDbEntity"), text(8, "0"),
        text(100, "AcDbBlockEnd");
  }

  void entity(const Stroke& s) {
    if (r2000_) {
      text(0, "LWPOLYLINE"), text(5, handle()), text(330, model_space_), text(100, "AcDbEntity"),
          text(8, s.layer), text(100, "AcDbPolyline");
      integer(90, static_cast<int>(s.points.size())), integer(70, s.closed ? 1 : 0), number(43, 0);
      for (const Vector2& p : s.points) point(p);
      return;
    }
    text(0, "POLYLINE"), text(8, s.layer), integer(66, 1), number(10, 0), number(20, 0), number(30, 0),
        integer(70, s.closed ? 1 : 0);
    for (const Vector2& p : s.points) text(0, "VERTEX"), text(8, s.layer), point(p), number(30, 0);
    text(0, "SEQEND"), text(8, s.layer);
  }

  void objects() {
    section("OBJECTS");
    const std::string root = handle(), groups = handle();
    text(0, "DICTIONARY"), text(5, root), text(330, "0"), text(100, "AcDbDictionary"), integer(281, 1),
        text(3, "ACAD_GROUP"), text(350, groups);
    text(0, "DICTIONARY"), text(5, groups), text(330, root), text(100, "AcDbDictionary"), integer(281, 1);
    end_section();
  }

  bool r2000_;
  double width_, height_;
  std::string out_, model_space_, paper_space_;
  int next_ = 0x20;
};

void add(const BlueprintLine& line, const std::vector<Vector2>& points, const Profile& profile,
         std::vector<Stroke>& out) {
  const LayerStyle& style = profile.of(line.operation);
  if (style.dash.empty()) return void(out.push_back({style.layer, points, line.closed}));
  for (std::vector<Vector2>& dash : dashed(points, line.closed, style.dash))
    out.push_back({style.layer, std::move(dash), false});
}

// Layers that are drawn, each once.
std::vector<LayerStyle> layers_of(const Profile& profile) {
  std::vector<LayerStyle> layers;
  std::set<std::string> seen{"0"};
  for (int i : profile.order)
    if (profile.layers[i].drawn && seen.insert(profile.layers[i].layer).second)
      layers.push_back(profile.layers[i]);
  return layers;
}

}  // namespace

std::string to_dxf(const Blueprint& b, int sheet, const Profile& profile, DxfVersion version) {
  const BlueprintSheet& s = b.sheets.at(sheet);
  std::vector<Stroke> strokes;
  for (int i : profile.order) {
    const auto operation = static_cast<Operation>(i);
    if (!profile.of(operation).drawn) continue;
    if (operation == Operation::kGuide)
      for (const BlueprintLine& line : s.guide) add(line, line.points, profile, strokes);
    for (const PlacedPart& part : s.parts)
      for (const BlueprintLine& line : b.parts[part.part].lines)
        if (line.operation == operation) add(line, placed(line.points, part.placement), profile, strokes);
  }
  return DxfWriter(version, s.width, s.height).write(layers_of(profile), strokes, origin_json(b));
}

std::string part_to_dxf(const Blueprint& b, int part, const Profile& profile, DxfVersion version) {
  const BlueprintPart& p = b.parts.at(part);
  const Placement turn = flat_turn(p.outline);
  Polygon all;
  for (const BlueprintLine& line : p.lines)
    for (const Vector2& q : line.points) all.push_back(turn(q));
  const Bounds box = bounds_of(all);
  const Placement place{turn.cos, turn.sin, -box.low};
  std::vector<Stroke> strokes;
  for (int i : profile.order)
    for (const BlueprintLine& line : p.lines)
      if (static_cast<int>(line.operation) == i && profile.layers[i].drawn)
        add(line, placed(line.points, place), profile, strokes);
  return DxfWriter(version, box.size().x(), box.size().y())
      .write(layers_of(profile), strokes, origin_json(b));
}

}  // namespace sheetform
