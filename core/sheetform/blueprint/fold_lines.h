// Where a flat part bends and by how much.
#pragma once
#include <vector>

#include "sheetform/strip/strip_mesh.h"

namespace sheetform {

/// An inner edge of a patch. Angle in degrees seen from outside: mountain (convex) positive, valley negative.
struct Crease {
  std::array<int, 2> v, vt;
  double angle = 0;
  int ruling = -1;               ///< place in Patch::rulings, -1: a diagonal
  std::array<int, 2> triangles;  ///< places in Patch::triangles, left of v[0] -> v[1] first
};
/// All inner edges of a patch, rulings first in their order, then diagonals by vertices.
std::vector<Crease> creases_of(const StripMesh& strips, int patch);

/// The bending of a ruling together with its share of the diagonals in the pieces on both of its sides,
/// degrees.
std::vector<double> ruling_turns(const StripMesh& strips, int patch, const std::vector<Crease>& creases);

/// Turns with the to-and-fro between neighbouring rulings evened out; their sum stays.
std::vector<double> evened_turns(const std::vector<double>& turns);

/// Rulings in the plane in their order, all pointing the same way as far as they can. flat: by Crease::vt.
std::vector<std::array<Vector2, 2>> flat_rulings(const std::vector<Crease>& creases,
                                                 const std::vector<Vector2>& flat);

/// Of the diagonal: the stretch over which bending is measured where no radius is asked for; of a radius that
/// is asked for, half (as the page does).
constexpr double kBendReach = 0.05;

/// Radius of bending at each ruling of a patch, in units of `flat`: a stretch of the sheet around it over
/// what that turns altogether; infinite where it does not turn. The stretch is `reach` long (the ruling's own
/// share, halfway to its neighbours, where that is more; the whole patch where that is less), for single
/// narrow triangles say nothing: they fold to and fro, a sheet bends by what that comes to. Of a single
/// ruling: half the width of the patch over its turn. creases: of the patch.
std::vector<double> bend_radii(const StripMesh& strips, int patch, const std::vector<Crease>& creases,
                               const std::vector<Vector2>& flat, double reach);

/// Rulings that stand for `step` degrees of bending each (several steps where one ruling bends that much).
/// To-and-fro between neighbours is evened out first; then the bending up to any ruling, and what the rulings
/// drawn up to there stand for, differ by little more than half a step. step 0: all rulings with their own
/// turn. A drawn ruling stands for `hidden` degrees at least.
struct DrawnRuling {
  int ruling;
  double angle;
};
std::vector<DrawnRuling> thinned_rulings(const std::vector<double>& turns, double step, double hidden);

/// Dihedral angle over the edge shared by two triangles, in degrees, positive where convex from outside. `a`
/// -> `b` is the edge as the first triangle runs it.
double bend_over(const Vector3& a, const Vector3& b, const Vector3& first_apex, const Vector3& second_apex);

}  // namespace sheetform
