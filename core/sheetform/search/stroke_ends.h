// Drawn seams that end inside of the surface: they go on until they meet something.
#pragma once
#include <vector>

#include "sheetform/layout/layout.h"
#include "sheetform/tracing/tracing.h"

namespace sheetform {

/// Lengthens every drawn seam of the network that ends at nothing: along the cross field to the first line
/// that the way there meets (or back to the seam itself, all around the surface), else the shortest way to
/// another line. The added paths are cuts. `graph`: with the drawn seams among its terminal vertices. Ends
/// for which there is no way stay loose; splitting closes them. One search for each end.
void extend_drawn_ends(const SurfaceMesh& mesh, const TracingGraph& graph, const CrossField& field,
                       PathNetwork& network, RunContext& context);

}  // namespace sheetform
