// Reading the strokes that the user has drawn on the mesh (design.md 1.8).
#pragma once
#include <string_view>

#include "sheetform/mesh/guides.h"

namespace sheetform::server {

/// Most strokes of either kind, and most points of all of them.
inline constexpr std::size_t kMostStrokes = 256, kMostStrokePoints = 50'000;

/// JSON: {"seams": [{"points": [[x, y, z], ...], "closed": false}, ...],
///        "keep_out": [{"points": [[x, y, z], ...], "radius": r}, ...]}
/// in units of the mesh; either list may be left out, `closed` is false when it is. Seams have two points at
/// least, closed ones three, keep_out one.
///
/// Throws Error kInvalidParameter; where: "guides", with the stroke and the point. Whether they lie on the
/// mesh is not looked at here (sheetform/guided.h).
UserGuides read_guides(std::string_view bytes);

}  // namespace sheetform::server
