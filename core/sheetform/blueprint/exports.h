// One call for every download: a stored result and a query give a file. Nothing is decomposed again.
#pragma once
#include <map>
#include <optional>
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
  kObj,        ///< "obj": OBJ, 3D in mm, place on the sheets as UV
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
  double model_size = 0;  ///< mm, longest side of the model's box; 0: as it was decomposed
  int sheet = 0;          ///< 1, 2...: that sheet alone; 0: all
  std::string part;       ///< label: that part alone (fold, parts-svg, parts-dxf); empty: all
  std::string text;  ///< JSON: the format and every parameter in force, as in a query; goes into the files
};

/// Reads a query such as {"profile": "lightburn", "sheet_size": "a4", "kerf": "0.2"}; the names are those of
/// export_parameters(). Throws Error kInvalidParameter (where: the name) for unknown names and values out of
/// range.
ExportRequest read_export_request(std::string_view format, const std::map<std::string, std::string>& query);

/// Every name that a query may hold: the documentation of the download, and all that a form needs to ask for
/// it.
struct ExportParameter {
  std::string name;
  std::string otherwise;  ///< the default, as in a query
  std::string text;       ///< a sentence for people
  std::string type;       ///< "number", "integer", "choice", "switch" (on, off), "size", "text"
  std::string unit;       ///< of numbers: "mm", "degrees"
  std::string group;      ///< "sheet", "marks", "joints", "file"
  std::optional<double> low = std::nullopt, high = std::nullopt;  ///< of numbers, both allowed
  std::vector<std::string> choices = {};                          ///< words that it takes
  bool open = false;                      ///< takes other values too: numbers in range, WIDTHxHEIGHT in mm
  std::vector<std::string> formats = {};  ///< those that it has an effect on; empty: all
};
/// own: the operator's profiles, which are among the values of "profile".
std::vector<ExportParameter> export_parameters(const std::vector<Profile>& own = {});

/// What a download can be, by the name in a query. Several files come as a zip.
struct ExportFormatText {
  std::string name, media_type, text;
};
const std::vector<ExportFormatText>& export_formats();

/// Sheets by name, mm, width first; "a4-letter" is what A4 and Letter have in common.
struct SheetSize {
  double width, height;
};
const std::vector<std::pair<std::string, SheetSize>>& sheet_presets();

/// Makes the file. own: the operator's profiles. Throws what read_result, make_blueprint and the writers
/// throw, and Error kInvalidParameter when the sheet or part asked for does not exist. Cost: under a second
/// for 100 parts.
Artifact export_result(std::string_view ruled_obj, std::string_view layout_json, const ExportRequest& request,
                       const BlueprintOrigin& origin, const std::vector<Profile>& own = {});

}  // namespace sheetform
