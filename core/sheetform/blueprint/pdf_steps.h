// Pictures of the assembly: what is built so far, and the part that joins.
#pragma once
#include "sheetform/blueprint/blueprint.h"
#include "sheetform/blueprint/pdf_file.h"

namespace sheetform {

/// Adds pages of the given size (mm) with six pictures each: the parts built so far in grey, the new one in
/// colour, seen from a side on which it shows. Cost O(steps * (triangles + pixels)).
void add_step_pages(const Blueprint& blueprint, double width, double height, PdfFile& file);

/// A direction (unit, from the model to the eye) from which the part's outside is seen, a little from above.
Vector3 view_of_part(const Blueprint& blueprint, int part);

}  // namespace sheetform
