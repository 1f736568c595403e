// Pictures of the assembly: what is built so far, and the part that joins.
#pragma once
#include "sheetform/blueprint/blueprint.h"
#include "sheetform/blueprint/pdf_file.h"

namespace sheetform {

/// The model's axis that points up in the pictures.
enum class UpAxis { kX, kY, kZ, kMinusX, kMinusY, kMinusZ };

/// Adds pages of the given size (mm) with six pictures each: the parts built so far in grey, the new one in
/// colour with its label, those that it joins with theirs, the numbers of the seams, and what is to come as
/// thin lines. The view changes only where the new part would hardly show. Cost O(steps * (triangles +
/// pixels)).
void add_step_pages(const Blueprint& blueprint, double width, double height, UpAxis up, PdfFile& file);

}  // namespace sheetform
