#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "sheetform/base/error.h"
#include "sheetform/blueprint/blueprint.h"
#include "sheetform/blueprint/hinges.h"
#include "sheetform/blueprint/joints.h"
#include "sheetform/blueprint/materials.h"
#include "sheetform/blueprint/nesting.h"
#include "sheetform/blueprint/option_limits.h"
#include "sheetform/blueprint/part_marks.h"
#include "sheetform/blueprint/reshape.h"
#include "sheetform/blueprint/seams.h"
#include "sheetform/blueprint/stroke_font.h"
#include "sheetform/blueprint/text.h"
#include "sheetform/strip/outline.h"

namespace sheetform {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kPageMargin = 1;  // mm inside the printable part of a page

// All vts in mm; mirrored for parts that show their inside.
std::vector<Vector2> flat_places(const StripMesh& strips, double scale, bool mirrored) {
  std::vector<Vector2> flat;
  for (const Vector2& uv : strips.uvs) flat.push_back(scale * Vector2(mirrored ? -uv.x() : uv.x(), uv.y()));
  return flat;
}

// Of the rulings in the plane, each turned to agree with those before; zero where there are none.
Vector2 mean_direction(const Blueprint& b, const StripMesh::Patch& patch) {
  std::map<std::array<int, 2>, Vector2> edges;
  for (const StripMesh::Triangle& t : patch.triangles)
    for (int k = 0; k < 3; ++k)
      edges[{t.v[k], t.v[(k + 1) % 3]}] = b.flat[t.vt[(k + 1) % 3]] - b.flat[t.vt[k]];
  Vector2 mean = Vector2::Zero();
  for (const auto& ruling : patch.rulings) {
    const auto edge = edges.find(ruling);
    if (edge != edges.end()) mean += edge->second.dot(mean) < 0 ? Vector2(-edge->second) : edge->second;
  }
  return mean.norm() > 0 ? Vector2(mean.normalized()) : mean;
}

void add_parts(Blueprint& b, const std::vector<std::string>& labels) {
  for (std::size_t p = 0; p < b.strips.patches.size(); ++p) {
    const StripMesh::Patch& patch = b.strips.patches[p];
    BlueprintPart part;
    part.patch = static_cast<int>(p), part.label = labels[p];
    part.component = patch.component, part.mirror_of = patch.mirror_of;
    for (int t : patch.boundary_vt) part.outline.push_back(b.flat.at(t));
    if (part.outline.size() < 3)
      throw Error(ErrorCode::kInternal, "a patch without outline", "patch " + labels[p]);
    part.area = signed_area(part.outline);
    if (part.area < 0) std::reverse(part.outline.begin(), part.outline.end()), part.area = -part.area;
    part.footprint = {part.outline};
    part.ruling_direction = mean_direction(b, patch);
    b.parts.push_back(std::move(part));
  }
}

void add_cuts(Blueprint& b) {
  for (BlueprintPart& part : b.parts) {
    Polygons contours = part.footprint;
    if (b.options.kerf > 0) contours = offset(contours, b.options.kerf / 2, Corner::kMitred);
    for (Polygon& contour : contours) {
      const Operation operation = signed_area(contour) > 0 ? Operation::kCutOuter : Operation::kCutInner;
      part.lines.push_back({operation, std::move(contour), true, 0, 0});
    }
  }
}

// Angles that the grain allows, starting with the part's smallest rectangle lying flat.
std::vector<double> turns_of(const BlueprintPart& part, const BlueprintOptions& o) {
  const Placement flat = flat_turn(part.outline);
  double start = std::atan2(flat.sin, flat.cos);
  int turns = o.turns;
  if (o.grain != Grain::kAny && !part.ruling_direction.isZero()) {
    start = -std::atan2(part.ruling_direction.y(), part.ruling_direction.x()) +
            (o.grain == Grain::kAcrossRulings ? kPi / 2 : 0);
    turns = 2;
  }
  std::vector<double> out;
  for (int k = 0; k < turns; ++k) out.push_back(start + 2 * kPi * k / turns);
  return out;
}

// Largest first: small parts fill what is left between them.
std::vector<int> nesting_order(const std::vector<BlueprintPart>& parts) {
  std::vector<double> size;
  for (const BlueprintPart& part : parts) {
    const Bounds box = bounds_of(part.outline);
    size.push_back(box.size().squaredNorm());
  }
  std::vector<int> order(parts.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int c) { return size[a] > size[c]; });
  return order;
}

// One page for everything: as wide as its largest part, or so that it comes out a little wider than high.
double automatic_width(const Blueprint& b) {
  double widest = 0, area = 0;
  for (const BlueprintPart& part : b.parts) {
    const Placement turn = flat_turn(part.outline);
    Polygon p;
    for (const Vector2& q : part.outline) p.push_back(turn(q));
    widest = std::max(widest, bounds_of(p).size().maxCoeff());
    area += b.options.copies * part.area;
  }
  const double room = std::max(widest * 1.001, std::sqrt(2.2 * area));
  return std::max(room, b.options.reference_bar && room > 60 ? 104.0 : 0.0) + 2 * b.options.margin;
}

[[noreturn]] void refuse_part(const Blueprint& b, const BlueprintPart& part) {
  const Vector2 size = bounds_of(placed(part.outline, flat_turn(part.outline))).size();
  throw Error(ErrorCode::kInvalidParameter,
              "part " + part.label + " (" + rounded(size.x(), 0) + " x " + rounded(size.y(), 0) +
                  " mm) is larger than a sheet of " + rounded(b.options.sheet_width, 1) + " x " +
                  rounded(b.options.sheet_height, 1) + " mm",
              "sheet", "Choose a larger sheet or a smaller scale, or let large parts be split");
}

// A bar of 100 mm with its length written on it, where the sheet has room.
void add_reference_bar(Nester& nester, int sheet, const Blueprint& b, BlueprintSheet& out) {
  const Polygon frame{{0, 0}, {100, 0}, {100, 10}, {0, 10}};
  const NestItem item{{frame}, {0, kPi / 2}};
  const auto place = nester.place_on(sheet, item);
  if (!place) return;
  const auto draw = [&](std::vector<Vector2> points, bool closed) {
    out.guide.push_back({Operation::kGuide, placed(points, *place), closed, 0, 0});
  };
  draw(frame, true);
  for (int i = 1; i < 10; ++i) draw({{10.0 * i, 0}, {10.0 * i, i == 5 ? 4.0 : 2.5}}, false);
  const std::string text = "100 MM  SHEET " + std::to_string(sheet + 1) + "  MARKED SIDE " +
                           (b.options.marked_face == Face::kOutside ? "OUTSIDE" : "INSIDE");
  StrokeText strokes =
      stroke_text(text, std::min(3.0, 3.0 * 96 / std::max(1.0, stroke_text_width(text, 3.0))));
  for (std::vector<Vector2>& line : strokes.lines) {
    for (Vector2& p : line) p += Vector2(2, 5.5);
    draw(line, false);
  }
}

/// Parts in their places, sheet by sheet.
struct Nesting {
  Nester nester;
  std::vector<std::pair<int, PlacedPart>> places;
  int too_large = -1;  ///< a part that fits on no sheet; then nothing is complete
};

Nesting place_all(const Blueprint& b, const NestOptions& sheets) {
  Nesting n{Nester(sheets), {}, -1};
  for (int i : nesting_order(b.parts))
    for (int copy = 0; copy < b.options.copies; ++copy) {
      const NestedItem item = n.nester.place({b.parts[i].footprint, turns_of(b.parts[i], b.options)});
      if (item.sheet < 0) {
        n.too_large = i;
        return n;
      }
      n.places.push_back({item.sheet, {i, copy, item.placement}});
    }
  std::stable_sort(n.places.begin(), n.places.end(), [](const auto& x, const auto& y) {
    return std::array{x.first, x.second.part, x.second.copy} <
           std::array{y.first, y.second.part, y.second.copy};
  });
  return n;
}

// Sheets of the size asked for; pages of a printer where all parts fit on one; else one sheet as large as
// need be, as wide as several pages.
Nesting best_nesting(const Blueprint& b, NestOptions& sheets) {
  const BlueprintOptions& o = b.options;
  const double gap = o.gap + o.kerf;
  sheets = {o.sheet_width, o.sheet_height, o.margin, gap};
  if (o.sheet_width > 0) {
    Nesting n = place_all(b, sheets);
    if (n.too_large >= 0) refuse_part(b, b.parts[n.too_large]);
    return n;
  }
  double width = automatic_width(b);
  if (o.page_width > 0) {
    sheets = {o.page_width, o.page_height, kPageMargin, gap};
    if (Nesting n = place_all(b, sheets); n.too_large < 0) return n;
    const double step = o.page_width - o.page_overlap;
    width = o.page_overlap + step * std::max(1.0, std::ceil((width - o.page_overlap) / step));
  }
  sheets = {width, 0, o.margin, gap};
  return place_all(b, sheets);
}

void nest(Blueprint& b) {
  NestOptions sheets;
  Nesting n = best_nesting(b, sheets);
  double inside = 0, total = 0;
  for (int s = 0; s < n.nester.sheet_count(); ++s) {
    BlueprintSheet sheet;
    for (const auto& [on, part] : n.places)
      if (on == s) sheet.parts.push_back(part), inside += area_of(b.parts[part.part].footprint);
    if (b.options.reference_bar) add_reference_bar(n.nester, s, b, sheet);
    const bool fixed = sheets.height > 0;
    sheet.width = fixed ? sheets.width : n.nester.used(s).x();
    sheet.height = fixed ? sheets.height : n.nester.used(s).y();
    total += sheet.width * sheet.height;
    b.sheets.push_back(std::move(sheet));
  }
  b.used_share = total > 0 ? inside / total : 0;
  for (auto& [sheet, place] : n.places)
    if (place.copy == 0) b.parts[place.part].level = {place.placement.cos, -place.placement.sin};
}

// Thickness and the size of the sheet change the surface itself, before anything is drawn.
std::vector<std::string> reshape(Blueprint& b, const std::vector<std::string>& labels) {
  const BlueprintOptions& o = b.options;
  std::vector<std::string> names = labels;
  if (o.thickness > 0 && o.mesh_surface != MeshSurface::kMiddle) {
    const double inwards = (o.mesh_surface == MeshSurface::kOutside ? -0.5 : 0.5) * o.thickness / b.scale;
    b.strips = moved_surface(b.strips, inwards, names, bounding_box_diagonal(b.strips.points));
  }
  if (o.oversize == Oversize::kSplit && o.sheet_width > 0) {
    const double tabs = o.tabs == TabSides::kNone ? 0 : 2 * o.tab_depth, room = 2 * o.margin + tabs + 0.01;
    split_to_fit(b.strips, names, (o.sheet_width - room) / b.scale, (o.sheet_height - room) / b.scale);
  }
  return names;
}

void require(bool good, const char* option, const std::string& what) {
  if (!good) throw Error(ErrorCode::kInvalidParameter, std::string(option) + " " + what, option);
}

}  // namespace

void validate(const BlueprintOptions& o) {
  require((o.sheet_width > 0) == (o.sheet_height > 0), "sheet", "needs both a width and a height");
  for (const auto& [value, name] :
       std::initializer_list<std::pair<double, const char*>>{{o.sheet_width, "sheet_width"},
                                                             {o.sheet_height, "sheet_height"},
                                                             {o.margin, "margin"},
                                                             {o.gap, "gap"},
                                                             {o.turns, "turns"},
                                                             {o.copies, "copies"},
                                                             {o.label_height, "label_height"},
                                                             {o.seam_text_height, "seam_text_height"},
                                                             {o.smallest_text, "smallest_text"},
                                                             {o.notch_size, "notch_size"},
                                                             {o.ruling_step, "ruling_step"},
                                                             {o.hidden_bend, "hidden_bend"},
                                                             {o.ruling_clear, "ruling_clear"},
                                                             {o.dash, "dash"},
                                                             {o.dash_gap, "dash_gap"},
                                                             {o.tick_length, "tick_length"},
                                                             {o.tab_depth, "tab_depth"},
                                                             {o.tab_angle, "tab_angle"},
                                                             {o.tab_pitch, "tab_pitch"},
                                                             {o.kerf, "kerf"},
                                                             {o.thickness, "thickness"}})
    require_in_range(value, name);
  require(o.sheet_width <= 0 || std::min(o.sheet_width, o.sheet_height) > 2 * o.margin + 1, "margin",
          "leaves no room on the sheet");
  require(o.page_width <= 0 || std::min(o.page_width, o.page_height) > o.page_overlap + 20, "page",
          "leaves no room for a tile: use a larger page, or less margin or overlap");
  if (!o.material.empty()) material_named(o.material);
  require(!o.hinges || (!o.material.empty() && o.thickness > 0), "hinges",
          "need a material and its thickness");
}

std::vector<Vector2> placed(const std::vector<Vector2>& points, const Placement& placement) {
  std::vector<Vector2> out;
  for (const Vector2& p : points) out.push_back(placement(p));
  return out;
}

Blueprint make_blueprint(const StripMesh& strips, double scale, const std::vector<std::string>& labels,
                         const BlueprintOptions& options, const BlueprintOrigin& origin) {
  validate(options);
  if (labels.size() != strips.patches.size())
    throw Error(ErrorCode::kInternal, "one label a patch is needed");
  Blueprint b;
  b.options = options, b.origin = origin, b.strips = strips, b.scale = scale;
  const std::vector<std::string> names = reshape(b, labels);
  const bool mirrored = options.marked_face == Face::kInside;
  b.flat = flat_places(b.strips, scale, mirrored);
  add_parts(b, names);
  b.seams =
      seams_of(b.strips, b.flat, options.notches == NotchStyle::kNone ? 0 : options.notch_size, mirrored);
  add_joints(b);
  if (options.thickness > 0) note_thick_seams(b);
  nest(b);  // before the texts: they are level on the sheet
  add_marks(b);
  add_hinges(b);
  add_cuts(b);
  if (options.kerf > 0) note_slits_left(b);
  return b;
}

}  // namespace sheetform
