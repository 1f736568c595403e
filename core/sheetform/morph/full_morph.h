// The paper's own morph: the surface is cut along its rulings for a while, and six quadratic terms move it
// towards straight rulings, closed seams and smooth outlines in one solve (paper 3.3.2, eq. 1 to 5).
//
// The reduced morph (morph.h) makes straightness and seams exact and has a hundredth of the unknowns. This is
// the reference that it is held against, and can replace it: arch_points are what the reduced morph returns.
//
// How the text was read where it leaves room (method.md 0.3):
// - The index sets printed under eq. 3 and eq. 4 are swapped: planarity acts on B and I, the seams on B.
// - A vertex of B or I that lies on a ruling is held by eq. 1 and 2, not by eq. 3 ("the remaining vertices").
// - A seam counts once per pair of copies; where three or more patches meet, once per pair along each arch.
// - "Three consecutive rules" in E_flat: the middle vertex, and the points of the rulings before and after
//   that lie on the perpendicular to its ruling in the chart; those are interpolated between two vertices.
//   So the three are collinear when flat, and a plane costs nothing.
// - E_smooth weighs the two neighbours by their distances, as eq. 2 does: samples and mesh vertices alternate
//   along an arch, and equal weights would slide them.
#pragma once
#include <array>
#include <utility>
#include <vector>

#include "sheetform/base/run_context.h"
#include "sheetform/field/cross_field.h"
#include "sheetform/ruling/rulings.h"

namespace sheetform {

/// A place on a patch's outline: which stretch, and where along its arch (edge index + fraction in the arch's
/// own direction, as sample_arch gives it).
struct OutlinePlace {
  int use = 0;
  double at = 0;
};

/// A ruling: straight in the chart, from outline to outline.
struct RulingLine {
  OutlinePlace from, to;
};

/// One patch as the full morph takes it.
struct RuledPatch {
  const PatchChart* chart = nullptr;  ///< null: the patch takes no part
  std::vector<RulingLine> lines;      ///< in the order of the sweep; should not cross each other
};

/// The chords of a strip as ruling lines. arch_samples: those that `polygon` was made of.
std::vector<RulingLine> ruling_lines(const Patch& patch, const PatchPolygon& polygon,
                                     const RulingSet& rulings,
                                     const std::vector<std::vector<double>>& arch_samples);

/// The temporarily remeshed surface (paper, Fig. 11b): one component a patch, rulings are chains of its
/// edges. Vertices: of patch 0 first (those of its chart in their order, then those on cut edges), then of
/// patch 1, ...
struct RuledMesh {
  struct Ruling {
    int patch;
    std::vector<int> vertices;  ///< at least two, the ends on the outline
    std::vector<double> at;     ///< place along the chord in the chart, 0 to 1, strictly increasing
  };
  /// One patch's copy of the points along an arch, in the arch's direction.
  struct Side {
    int arch, patch;
    std::vector<int> vertices;
  };
  std::vector<Vector3> rest;  ///< on the surface
  std::vector<Vector2> uv;    ///< in the patch's chart
  std::vector<int> patch;
  std::vector<char> on_ruling, on_border;  ///< the sets R and B; I = neither. Without rulings, all B are in R
  std::vector<double> isotropy;            ///< of E_flat: 1 - |k_min| / |k_max|, 1 where unknown or flat
  std::vector<std::array<int, 3>> triangles;
  std::vector<Ruling> rulings;  ///< by patch, in the order of the sweep
  std::vector<Side> sides;      ///< by patch
  int size() const { return static_cast<int>(rest.size()); }
};

/// What full_morph solves.
struct FullMorphProblem {
  RuledMesh mesh;
  std::vector<std::pair<int, int>> seams;   ///< copies of one outline point, lower id first, no pair twice
  std::vector<std::array<int, 3>> outline;  ///< consecutive vertices along a side, corners excluded
  std::vector<std::vector<int>> arch_stop;  ///< per arch, per sample: index into the vertices of its sides
  std::vector<std::vector<Vector3>> arch_rest;  ///< per arch, per sample: its place on the surface
  std::vector<std::array<int, 2>> arch_nodes;   ///< per arch: mesh vertices at its ends
  /// Per arch, per sample: where the other side stays; empty = free. For morphs of a part of a layout; filled
  /// by the caller.
  std::vector<std::vector<Vector3>> held;
  int patches = 0;  ///< of the layout
  int dropped = 0;  ///< lines that left the chart or crossed an earlier one
  double build_seconds = 0;
};

/// Cuts every mesh edge that a ruling crosses in its chart and copies the outline of each patch. Crossings
/// nearer to a vertex or to another crossing than a thousandth of an edge are moved to it. curvature: of
/// `mesh`, for E_flat; may be null. Throws Error kInvalidParameter when the parts do not fit together.
/// O(faces + crossings).
FullMorphProblem full_morph_problem(const SurfaceMesh& mesh, const PatchLayout& layout,
                                    const std::vector<RuledPatch>& patches,
                                    const std::vector<std::vector<double>>& arch_samples,
                                    const CurvatureField* curvature, const RunContext& context);

/// How eq. 2 keeps rulings straight.
enum class Straightness : char {
  kTriplets,  ///< the paper: each vertex between its two neighbours; bow grows with the 4th power of their
              ///< number
  kChords     ///< each vertex on the line through both ends: the same bow at any resolution (method.md 9.2)
};

/// How eq. 3 treats outline vertices without a ruling.
enum class OutlinePlanarity : char {
  kPlanar,  ///< cotangent weights, changed as little as makes them exact on a plane: "lie in the plane of the
            ///< neighbours", the paper's purpose
  kOneSided,  ///< the formula as printed: the mean of neighbours that are all on one side; pulls the outline
              ///< in
  kOff
};

/// What E_smooth and E_flat compare with.
enum class BendTarget : char {
  kStraight,  ///< the paper: no bend at all
  kRest       ///< the bend of the surface itself: costs nothing while nothing moves (method.md 0.3)
};

/// Weights of eq. (5); the paper's values by default. Energies are squared lengths, so that the minimiser
/// does not depend on the unit of the mesh; it does depend on the number of rulings and vertices.
struct FullMorphWeights {
  double approx = 1;      ///< eq. 1
  double laplace = 1;     ///< eq. 3
  double straight = 1e5;  ///< eq. 2
  double seams = 100;     ///< eq. 4
  double smooth = 1;      ///< boundaries
  double flat = 2;        ///< bending
  double anchor = 1e-6;   ///< not in the paper: keeps vertices that no term holds; 1e-6 of eq. 1
  Straightness straightness = Straightness::kTriplets;
  OutlinePlanarity planarity = OutlinePlanarity::kPlanar;
  BendTarget smooth_target = BendTarget::kStraight;
  BendTarget flat_target = BendTarget::kStraight;
};

/// Straight rulings at any resolution (weight 1e3, method.md 9.2), bends compared with those of the surface.
FullMorphWeights resolution_independent_weights();

/// The terms of eq. (5), each without its weight; squared lengths.
struct FullMorphEnergy {
  double approx = 0, laplace = 0, straight = 0, seams = 0, smooth = 0, flat = 0, anchor = 0;
  double total = 0;  ///< weighted
};

struct FullMorphFigures {
  int unknowns = 0;        ///< vertices; each has three coordinates, solved as three right-hand sides
  long long nonzeros = 0;  ///< lower triangle of the normal equations
  double assemble_seconds = 0, factor_seconds = 0, solve_seconds = 0;  ///< wall clock
};

struct FullMorphResult {
  std::vector<Vector3> position;            ///< per vertex of the temporary mesh
  std::vector<double> displacement;         ///< |v - v0| of each
  std::vector<double> patch_displacement;   ///< per patch: largest over its vertices (the paper's test)
  std::vector<double> ruling_displacement;  ///< per patch: largest over its vertices on rulings
  /// Per arch, per sample: mean of all copies; nodes of several arches agree. Empty for arches no patch of
  /// which takes part.
  std::vector<std::vector<Vector3>> arch_points;
  FullMorphEnergy energy;  ///< at the solution
  double gap = 0;          ///< largest distance between copies of an outline point
  double bow = 0;          ///< largest distance of a ruling's vertex from the line through the ruling's ends
  FullMorphFigures figures;
};

/// Minimises eq. (5): one sparse factorisation, three right-hand sides. Throws Error kInvalidParameter for
/// weights that are negative, not finite, or all zero where vertices need them. About 0.1 to 0.2 s for 10^4
/// vertices.
FullMorphResult full_morph(const FullMorphProblem& problem, const FullMorphWeights& weights,
                           const RunContext& context);

/// The energy of any positions of the temporary mesh's vertices.
FullMorphEnergy full_morph_energy(const FullMorphProblem& problem, const FullMorphWeights& weights,
                                  const std::vector<Vector3>& position);

}  // namespace sheetform
