// The first pages of the PDF: what it is, whether the printer has scaled it, how to read the parts, where
// they are, and the lists.
#pragma once
#include <string>
#include <vector>

#include "sheetform/blueprint/pdf_file.h"
#include "sheetform/blueprint/profiles.h"

namespace sheetform {

/// The window of one printed page on a sheet.
struct PdfTile {
  int sheet = 0;
  int row = 0, column = 0;  ///< from the top left
  Vector2 low;              ///< lower left corner on the sheet
  Vector2 size;
  std::string name;  ///< "2-3": row 2, column 3; empty where the sheet has no other page
};

struct PdfPaper {
  double width, height, margin;  ///< mm
};

/// Scale box, a drawn example with the legend, a map of all sheets with part labels and pages (tiles: empty
/// where sheets are not tiled), part list, steps, notes, and what the file was made with. Text never leaves
/// the paper.
void add_cover_pages(const Blueprint& blueprint, const Profile& profile, const PdfPaper& paper,
                     const std::vector<PdfTile>& tiles, PdfFile& file);

}  // namespace sheetform
