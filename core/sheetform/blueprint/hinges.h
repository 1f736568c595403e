// Bending tighter than the material: where it happens, and slots that make it possible there.
#pragma once
#include "sheetform/blueprint/blueprint.h"

namespace sheetform {

/// Radius of bending at each ruling of a part in mm (fold_lines.h), infinite where it does not bend.
std::vector<double> bend_radii(const Blueprint& blueprint, int part);

/// Fills smallest_radius of every part; with a material named, says in `warnings` which parts bend tighter
/// than it can; with options.hinges, cuts a lattice of slots along the rulings there (links one thickness
/// wide, slots five long, rows half a thickness apart; boxes.py's flex). Slots keep one thickness clear of
/// the outline.
void add_hinges(Blueprint& blueprint);

}  // namespace sheetform
