// One call for every download: a stored result and a query give a file. Nothing is decomposed again.
#pragma once
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sheetform/blueprint/blueprint.h"
#include "sheetform/blueprint/dxf.h"
#include "sheetform/blueprint/pdf.h"
#include "sheetform/blueprint/profiles.h"
#include "sheetform/blueprint/result_writer.h"
#include "sheetform/blueprint/seam_frame.h"

namespace sheetform {

/// What a download is. Several sheets or parts come as a zip.
enum class ExportFormat {
  kSvg,        ///< "svg": sheets
  kDxf,        ///< "dxf": sheets
  kPartsSvg,   ///< "parts-svg": one file a part
  kPartsDxf,   ///< "parts-dxf"
  kPdf,        ///< "pdf"
  kFold,       ///< "fold"
  kFrame,      ///< "frame": seam frame as STL
  kPartList,   ///< "parts-json"
  kPartTable,  ///< "parts-csv"
  kAll,        ///< "zip": all of them
};

struct ExportRequest {
  ExportFormat format = ExportFormat::kSvg;
  BlueprintOptions blueprint;
  PdfOptions pdf;
  FrameOptions frame;
  DxfVersion dxf = DxfVersion::kR12;
  int sheet = 0;     ///< 1, 2...: that sheet alone; 0: all
  std::string part;  ///< label: that part alone (fold, parts-svg, parts-dxf); empty: all
};

/// Reads a query such as {"profile": "lightburn", "sheet_size": "a4", "kerf": "0.2"}. Names are those of the
/// fields of BlueprintOptions, PdfOptions (page: a preset or "WxH", page_margin, page_overlap, cover, steps),
/// FrameOptions (frame_radius, frame_text, frame_borders), "sheet_size" (a preset, "WxH" in mm, or "auto"),
/// "sheet", "part", "dxf"
/// ("r12" or "r2000"). Throws Error kInvalidParameter (where: the name) for unknown names and values out of
/// range.
ExportRequest read_export_request(std::string_view format, const std::map<std::string, std::string>& query);

/// Every name that a query may hold, with a default and a sentence for people: the documentation of the
/// download.
struct ExportParameter {
  std::string name, otherwise, text;
  std::vector<std::string> choices;  ///< words that it takes; empty: numbers or free text
  bool open = false;                 ///< takes other values than `choices` too
};
const std::vector<ExportParameter>& export_parameters();

/// Size of a preset in mm, width first (a0 to a4, letter, legal, tabloid, 600x300 and the like, "a4-letter"
/// is what A4 and Letter have in common). Throws Error kInvalidParameter naming the presets.
struct SheetSize {
  double width, height;
};
SheetSize sheet_size_named(std::string_view name);
const std::vector<std::pair<std::string, SheetSize>>& sheet_presets();

/// Makes the file. own: the operator's profiles. Throws what read_result, make_blueprint and the writers
/// throw, and Error kInvalidParameter when the sheet or part asked for does not exist. Cost: under a second
/// for 100 parts.
Artifact export_result(std::string_view ruled_obj, std::string_view layout_json, const ExportRequest& request,
                       const BlueprintOrigin& origin, const std::vector<Profile>& own = {});

}  // namespace sheetform
