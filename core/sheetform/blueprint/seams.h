// Which edge goes where: seams, their numbers, and the codes of their notches.
#pragma once
#include "sheetform/blueprint/blueprint.h"

namespace sheetform {

/// All seams of a result in the order of its arches, numbered from 1; borders are none. flat: every vt in mm.
/// Each seam long enough carries two groups of notches, off its middle, with different counts: turned end for
/// end or shifted, the groups of the two sides do not meet. Counts differ between the seams of one part as
/// far as they last. mirrored: the parts are drawn with the inside up. Throws Error kInternal when an arch is
/// not on the boundaries of the patches that it names.
std::vector<Seam> seams_of(const StripMesh& strips, const std::vector<Vector2>& flat, double notch_size,
                           bool mirrored);

/// A point of a polyline by arc length, with the unit direction there. s is clamped to the polyline.
struct PointOnLine {
  Vector2 point, direction;
};
PointOnLine point_at(const std::vector<Vector2>& line, double s);
double length_of(const std::vector<Vector2>& line);

/// Side k of a seam as a polyline from the arch's first vertex to its last.
std::vector<Vector2> side_of(const Seam& seam, int k, const std::vector<Vector2>& flat);

/// Middles of the single notches of a seam, mm from the arch's first vertex, ascending.
std::vector<double> notch_places(const Seam& seam, double notch_size);

}  // namespace sheetform
