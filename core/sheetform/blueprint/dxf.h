// Sheets and single parts as DXF: closed polylines, layers by profile, units in the header.
#pragma once
#include <string>

#include "sheetform/blueprint/profiles.h"

namespace sheetform {

enum class DxfVersion {
  kR12,    ///< AC1009: POLYLINE; what old CAM and cutters read
  kR2000,  ///< AC1015: LWPOLYLINE
};

/// One sheet, lower left corner at the origin, y up, $INSUNITS millimetres. Everything is by layer; no
/// splines, no texts: letters are polylines. Where it comes from stands in a comment (999).
std::string to_dxf(const Blueprint& blueprint, int sheet, const Profile& profile, DxfVersion version);

/// One part alone, as online shops want it; its lower left corner at the origin.
std::string part_to_dxf(const Blueprint& blueprint, int part, const Profile& profile, DxfVersion version);

}  // namespace sheetform
