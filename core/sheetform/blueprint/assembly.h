// How the parts come together: an order, the list of parts, and what it all costs.
#pragma once
#include <string>
#include <vector>

#include "sheetform/blueprint/profiles.h"

namespace sheetform {

struct AssemblyStep {
  int part = 0;
  std::vector<int> seams;  ///< indices into Blueprint::seams joined now; those of the part with itself come
                           ///< first, from where its two sides hang together (the tip of a slit) outwards
  double joined = 0;       ///< mm of seam
};

/// Each part after the first of its component joins what is already built, the one with most seam length in
/// common first. The last part of a component is the one with the least seam length whose absence leaves the
/// others in one piece: the last seams are short, and the place is reachable from outside until then. Cost
/// O(parts * seams).
std::vector<AssemblyStep> assembly_order(const Blueprint& blueprint);

/// "A3: to A1 at seams 4, 5; to itself at seam 7" for people.
std::string step_text(const Blueprint& blueprint, const AssemblyStep& step);

/// All copies together; lengths in mm.
struct Totals {
  int parts = 0, sheets = 0;
  double cut = 0, score = 0, drawn = 0;  ///< drawn: texts and notches
  double glue = 0;                       ///< seams
  double area = 0;                       ///< mm2 of the parts
  double used_share = 0;                 ///< of the sheets
  double minutes = 0;                    ///< estimate of machine (or hand) time by the profile
};
Totals totals_of(const Blueprint& blueprint, const Profile& profile);

/// Parts (label, size, area, sheet, copies, mirror image, neighbours by seam), seams (number, parts, length,
/// code), steps and totals as JSON.
std::string to_part_list_json(const Blueprint& blueprint, const Profile& profile);
/// The parts alone, a line each, RFC 4180; a cell that a spreadsheet would run is quoted as text.
std::string to_part_list_csv(const Blueprint& blueprint);

}  // namespace sheetform
