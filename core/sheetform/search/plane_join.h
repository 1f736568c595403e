// Patches that go on across the plane of symmetry in their own mirror image.
#pragma once
#include "sheetform/search/evaluator.h"

namespace sheetform {

/// Whether the patch may be joined to its mirror image along its straight arch (true when it has none): no
/// other arch on the plane meets that one, where there are others the joined patch may be glued to itself,
/// its chart lies on one side of the segment, and the joined patch keeps max_sides. Flat layouts are tested
/// again once the morph is known.
bool fits_its_image(const SearchSurface& surface, const PatchLayout& layout, const Patch& patch,
                    const PatchPolygon& polygon, const std::vector<int>& corners,
                    const EvaluationParams& params);

}  // namespace sheetform
