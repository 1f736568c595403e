// The blueprint as PDF: a page a sheet, or tiled over pages of a home printer, with cover, part list and
// assembly steps.
#pragma once
#include <string>

#include "sheetform/blueprint/pdf_steps.h"
#include "sheetform/blueprint/profiles.h"

namespace sheetform {

struct PdfOptions {
  double page_width = 0, page_height = 0;  ///< mm; 0: every page as large as its sheet, nothing is tiled
  double page_margin = 10;                 ///< mm that a printer leaves white
  double overlap = 10;                     ///< mm shared by neighbouring tiles
  bool cover = true;                       ///< scale box, legend, map of the pages, lists of parts and steps
  bool steps = true;                       ///< a picture for each assembly step
  UpAxis up = UpAxis::kZ;                  ///< in these pictures
};

/// Pages are true to scale and ask viewers not to scale. Tiles have a frame, their row and column,
/// and where they go on the neighbour's name and crosses at 25 and 75 % of the edge that come to lie on the
/// neighbour's; tiles on which nothing would be drawn are left out. Throws Error kInvalidParameter
/// for pages without room.
std::string to_pdf(const Blueprint& blueprint, const Profile& profile, const PdfOptions& options);

/// Tiles of one direction: how many it takes to cover `length` with windows of `window`, overlapping by
/// `overlap`.
int tiles_needed(double length, double window, double overlap);

}  // namespace sheetform
