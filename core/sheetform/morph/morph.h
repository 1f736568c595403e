// The reduced morph: the outline points of all patches move so that straight rulings between them fit the
// surface best.
//
// It is the paper's energy (3.3.2, eq. 1 to 5) with straightness and seams made exact: the unknowns are the
// arch points, shared by both sides of a seam, and every ruling point is an affine combination of them
// (method.md 9.4). The smoothness term acts on displacements, so that smooth arches are not shrunk
// (experiments.md Q4).
#pragma once
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// Which morph gives the shape: this one, or the paper's own (full_morph.h).
enum class MorphKind { kReduced, kFull };

/// A point of a ruled patch and the surface point that it stands for.
struct MorphSample {
  std::array<int, 3> unknown;  ///< ids of unknowns; unused ones have weight 0
  int triangle = 0;            ///< of the strips of its patch: where to look for the nearest first
  std::array<double, 3> coefficient;
  Vector3 target = Vector3::Zero(), normal = Vector3::Zero();  ///< on the surface; unit normal there
  double weight = 0;  ///< area that it stands for; 0 = only measured, not fitted
  double slide = 1;   ///< share of MorphParams::slide that it is granted; 0 for points of the outline
  bool covers =
      false;  ///< stands for the surface point: measured from there to the strips, not the other way
  Vector3 at(const std::vector<Vector3>& x) const {
    return coefficient[0] * x[unknown[0]] + coefficient[1] * x[unknown[1]] + coefficient[2] * x[unknown[2]];
  }
};

struct MorphProblem {
  std::vector<Vector3> rest;   ///< per unknown: its place on the surface
  std::vector<double> anchor;  ///< per unknown: relative weight of staying at rest
  std::vector<std::array<int, 3>>
      stencils;  ///< consecutive unknowns along an arch: smoothness of the displacement
  std::vector<std::array<int, 3>> bends;  ///< the same, absolute: keeps the arch itself smooth (small weight)
  std::vector<MorphSample> samples;
  std::vector<char> on_plane;  ///< per unknown: stays in the plane x = 0; empty = none does
};

struct MorphParams {
  double smooth = 0.3;  ///< relative to the mean data weight of an unknown
  double spacing = 0;   ///< of the points that `smooth` is meant for: where they are farther apart, the same
                        ///< bend costs the same; 0 = of all
  double bend = 0.0;
  int rounds = 4;         ///< minimax reweightings (Lawson) after the least-squares solve
  double slide = 0.8;     ///< share of a sample's tangential offset that is forgiven between rounds
  double stop_below = 0;  ///< no more rounds once the largest error is below
};

struct MorphResult {
  std::vector<Vector3> position;  ///< per unknown
  double max_error = 0;  ///< largest |position - target| of the fitted samples, normal part (see slide)
};

/// Least squares, then minimax reweighting; the best iterate is returned. One sparse factorisation per round.
MorphResult morph(const MorphProblem& problem, const MorphParams& params);

}  // namespace sheetform
