// Figures of one result, all against the untouched input. Lengths and areas are shares of the input's
// diagonal and of the result's area; angles in degrees.
#pragma once
#include "sheetform/decompose.h"

namespace sheetform::bench {

struct Quality {
  double input_to_result = 0, result_to_input = 0, mean_distance = 0;
  double normal_deviation = 0, normal_deviation_p95 = 0;
  double aligned = -1;       ///< share of ruling length within 15 degrees of least curvature, where that is
                             ///< pronounced; -1: nowhere
  double aligned_where = 0;  ///< share of ruling length where it is pronounced
  double bend = 0;           ///< mean dihedral angle over inner edges, by length
  double smallest_area = 0;  ///< of a part
  double narrowest = 0;      ///< width of the rectangle with the same second moments of area
  int small_parts = 0;       ///< below 0.3 % of the area
  int narrow_parts = 0;      ///< below 2 % of the diagonal
  double creases_kept = -1;  ///< share of the crease length (40 degrees) that lies on arches; -1: no creases
  double sharp_kept = -1;    ///< the same of all edges of 40 degrees and more, roughness and ridges too
  double sharp_length = 0;   ///< of those edges, in diagonals
  int self_seams = 0, t_junctions = 0;
};

Quality measure_quality(const InputMesh& input, const Decomposition& result, RunContext& context);

}  // namespace sheetform::bench
