// What is written on a part: its label, the numbers of its seams, notches, and the lines that it bends along.
#pragma once
#include "sheetform/blueprint/blueprint.h"

namespace sheetform {

/// Adds labels, seam numbers, notches and rulings to every part of `blueprint` whose outline, flat places and
/// seams are there. No text on another, none outside its part; what has no room is left out and said in
/// `warnings`.
void add_marks(Blueprint& blueprint);

}  // namespace sheetform
