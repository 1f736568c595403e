// Tabs and cut notches: what joining adds to the outline of a part and takes from it.
#pragma once
#include "sheetform/blueprint/blueprint.h"

namespace sheetform {

/// Adds toothed tabs along seams and takes v notches out, as the options say: part.footprint becomes the
/// outline with both, every tab's foot a score. A tooth never reaches into its own part, another tooth or
/// across a narrow bay; where it would it is cut back, and left out when less than a third of it remains. The
/// footprint of a part is one outer contour. Needs outlines, flat places and seams. A part without tabs and
/// notches keeps its outline bit for bit.
void add_joints(Blueprint& blueprint);

/// Mean bend of the surface over a seam, degrees, mountain (seen from outside) positive: the way in which its
/// tabs are folded. Cost O(edges of the seam * triangles of its parts).
double bend_of(const Blueprint& blueprint, const Seam& seam);

/// Says in `warnings` which seams want bevelled edges: two sheets of thickness t that meet at an angle f
/// press into each other by t / 2 * tan(f / 2) each when the middle of the material is the surface.
void note_thick_seams(Blueprint& blueprint);

/// Says in `warnings` which slits (seams of a part with itself that end inside of it) are narrower than the
/// cut towards their tips by more than a millimetre of their length, and how much of them is left to cut by
/// hand. After the cuts.
void note_slits_left(Blueprint& blueprint);

}  // namespace sheetform
