// The terms of eq. (1) to (4) and of the text after them as rows of a linear system. Part of full_morph.
#pragma once
#include <initializer_list>
#include <utility>
#include <vector>

#include "sheetform/morph/full_morph.h"

namespace sheetform {

enum class EnergyTerm : char { kApprox, kLaplace, kStraight, kSeams, kSmooth, kFlat, kAnchor };
double weight_of(EnergyTerm term, const FullMorphWeights& weights);

/// Each row costs weight_of(term) * factor * |sum of coefficient * position - target|^2.
class EnergyRows {
 public:
  struct Entry {
    int vertex;
    double coefficient;
  };
  struct Row {
    EnergyTerm term;
    double factor;
    Vector3 target;
    int begin, end;  ///< entries
  };
  void add(EnergyTerm term, const std::vector<Entry>& entries, const Vector3& target, double factor = 1);
  const std::vector<Row>& rows() const { return rows_; }
  const std::vector<Entry>& entries() const { return entries_; }
  Vector3 value(const Row& row, const std::vector<Vector3>& position) const;

 private:
  std::vector<Row> rows_;
  std::vector<Entry> entries_;
};

/// All rows with a weight above 0. O(vertices).
EnergyRows energy_rows(const FullMorphProblem& problem, const FullMorphWeights& weights);

FullMorphEnergy energy_of(const EnergyRows& rows, const FullMorphWeights& weights,
                          const std::vector<Vector3>& position);

}  // namespace sheetform
