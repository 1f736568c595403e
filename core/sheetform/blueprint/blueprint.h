// The blueprint of a result: parts with everything that is cut, scored and written on them, placed on sheets.
// One model for all formats (sheet_svg.h, dxf.h, pdf.h, fold_file.h, part_list.h); made from a stored result
// without decomposing again. Lengths are millimetres, angles degrees.
#pragma once
#include <limits>
#include <string>
#include <vector>

#include "sheetform/blueprint/polygon_tools.h"
#include "sheetform/strip/strip_mesh.h"

namespace sheetform {

/// What a tool does along a line. The order is that in which a machine works: first writes, then scores, then
/// cuts inside, then outside.
enum class Operation {
  kText,           ///< labels and numbers, engraved or drawn
  kNotch,          ///< marks at the edge that meet the neighbour's
  kScoreMountain,  ///< folds away from whom looks at the marked side
  kScoreValley,    ///< folds towards them
  kCutInner,
  kCutOuter,
  kGuide,  ///< sheet frame, scale bar, notes: never worked
};
constexpr int kOperations = 7;

enum class RulingStyle { kNone, kScore, kPerforation, kTicks };
enum class NotchStyle { kNone, kTick, kVee };
enum class TabSides { kNone, kOne, kAlternate, kBoth };
enum class Face { kOutside, kInside };
enum class MeshSurface { kOutside, kMiddle, kInside };
enum class Grain { kAny, kAlongRulings, kAcrossRulings };
enum class Oversize { kRefuse, kSplit };

/// How a blueprint is made. Every field can be given by name in a query (exports.h), within option_limits.h.
struct BlueprintOptions {
  double sheet_width = 0, sheet_height = 0;  ///< mm; 0: one sheet as large as the parts need
  /// mm, printable part of a home printer's page and what neighbouring pages share: sheets without a size of
  /// their own become such pages where every part fits on one, else as wide as several. 0: no pages.
  double page_width = 0, page_height = 0, page_overlap = 0;
  double margin = 5;  ///< mm, free at every edge of a sheet
  double gap = 3;     ///< mm, between any two parts
  int turns = 8;      ///< evenly spaced angles that nesting tries, 1 to 64
  Grain grain =
      Grain::kAny;  ///< the sheet's grain runs along its width; all but kAny leave 0 and 180 degrees
  Oversize oversize = Oversize::kRefuse;  ///< what to do with a part larger than the sheet
  int copies = 1;                         ///< of the whole model, 1 to 100
  Face marked_face = Face::kOutside;  ///< which side is up and carries the marks; kInside mirrors the parts

  double label_height = 8;        ///< mm, of part labels; smaller where a part is too small
  double seam_text_height = 3.5;  ///< mm, of "neighbour:seam"; 0: none
  double smallest_text = 1.6;     ///< mm; what does not fit at this height is left out and said in `warnings`
  NotchStyle notches = NotchStyle::kTick;
  double notch_size = 2.5;  ///< mm, length of a tick, depth of a v
  RulingStyle rulings = RulingStyle::kScore;
  double ruling_step = 5;         ///< degrees of bending that one drawn ruling stands for; 0: every ruling
  double hidden_bend = 1;         ///< degrees; a patch side that bends less altogether gets no lines
  double ruling_clear = 1.5;      ///< mm free at both ends of a score or perforation
  double dash = 2, dash_gap = 2;  ///< mm, of perforations
  double tick_length = 4;         ///< mm, of RulingStyle::kTicks at both ends

  TabSides tabs = TabSides::kNone;
  double tab_depth = 6;   ///< mm
  double tab_angle = 45;  ///< degrees, of a tooth's flanks to the edge
  double tab_pitch = 12;  ///< mm along the seam, one tooth each

  double kerf = 0;       ///< mm, full width of the cut; outer contours grow by half of it, inner ones shrink
  double thickness = 0;  ///< mm of the material; 0: paper
  MeshSurface mesh_surface =
      MeshSurface::kMiddle;  ///< which face of the sheet the decomposed surface is; the middle is drawn
  std::string material;      ///< name in materials.h, empty: none, bending is not checked
  bool hinges = false;       ///< slots across rulings that bend below the material's radius (lattice hinge)

  std::string profile = "makerspace";  ///< colours, layers and widths, profiles.h
  bool reference_bar = true;           ///< a bar of 100 mm on the guide layer of every sheet that has room
};

/// Where a blueprint comes from; goes into every file as text. All may be empty.
struct BlueprintOrigin {
  std::string version, job, model, input_digest, link;
  std::string parameters;    ///< JSON text of the decomposition's parameters
  std::string request = {};  ///< JSON text of the download's format and parameters
};

struct BlueprintLine {
  Operation operation = Operation::kText;
  std::vector<Vector2> points;
  bool closed = false;
  int seam = 0;      ///< number of the seam that it marks, 0: none
  double angle = 0;  ///< degrees of bending that a score stands for, mountain positive
};

/// One stretch where two patches, or a patch with itself, are joined.
struct Seam {
  int number = 0;  ///< as printed, from 1
  int arch = -1;
  std::array<int, 2> parts{};  ///< indices into Blueprint::parts, equal for a part glued to itself
  std::array<std::vector<int>, 2>
      vt;                      ///< both sides from the arch's first vertex to its last, into Blueprint::flat
  std::array<bool, 2> left{};  ///< the part lies to the left of its side, as drawn
  double length = 0;           ///< mm
  std::array<int, 2> code{};   ///< ticks in the two groups of notches; 0: no group there
  std::array<double, 2> at{};  ///< mm from the arch's first vertex to the groups' middles
};

struct BlueprintPart {
  int patch = -1;
  std::string label;
  int component = 0;
  int mirror_of = -1;                          ///< part that is its mirror image
  Polygon outline;                             ///< the patch itself, counter-clockwise
  Polygons footprint;                          ///< what the sheet loses to it: outline and tabs; no kerf
  std::vector<BlueprintLine> lines;            ///< all that is drawn, in the order of Operation
  Vector2 ruling_direction = Vector2::Zero();  ///< mean, unit, sign free; zero: no rulings
  Vector2 level = Vector2::UnitX();            ///< unit, runs along the width of the sheet that it lies on
  double area = 0;                             ///< mm2, of the outline
  double smallest_radius = std::numeric_limits<double>::infinity();  ///< mm, to which it is bent
};

struct PlacedPart {
  int part = 0, copy = 0;
  Placement placement;
};

struct BlueprintSheet {
  double width = 0, height = 0;
  std::vector<PlacedPart> parts;
  std::vector<BlueprintLine> guide;  ///< in sheet coordinates, origin at the lower left
};

struct Blueprint {
  BlueprintOptions options;
  BlueprintOrigin origin;
  StripMesh strips;
  double scale = 1;           ///< mm for one unit of the mesh
  std::vector<Vector2> flat;  ///< every vt in mm, in the coordinates of its part
  std::vector<BlueprintPart> parts;
  std::vector<Seam> seams;
  std::vector<BlueprintSheet> sheets;
  double used_share = 0;              ///< of the sheets' area that lies inside parts
  std::vector<std::string> warnings;  ///< for people
};

/// Makes the blueprint of a sound result (check_structure finds nothing). labels: one a patch. Throws Error
/// kInvalidParameter for options out of range or a part larger than the sheet. Deterministic. Cost: seconds
/// for hundreds of parts, nearly all of it nesting.
Blueprint make_blueprint(const StripMesh& strips, double scale, const std::vector<std::string>& labels,
                         const BlueprintOptions& options, const BlueprintOrigin& origin = {});

/// Throws Error kInvalidParameter (where: the option's name) when an option is out of range.
void validate(const BlueprintOptions& options);

/// What a placed part's line looks like on the sheet.
std::vector<Vector2> placed(const std::vector<Vector2>& points, const Placement& placement);

}  // namespace sheetform
