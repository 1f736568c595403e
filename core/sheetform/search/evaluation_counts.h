// How much a search had to compute, and how much of it was known already.
#pragma once
#include <cstdint>

namespace sheetform {

struct EvaluationCounts {
  std::int64_t evaluations = 0;  ///< of patches that were not known: chart, rulings, their own error
  std::int64_t cache_hits = 0;   ///< patches that had been evaluated before
  EvaluationCounts& operator+=(const EvaluationCounts& o) {
    evaluations += o.evaluations, cache_hits += o.cache_hits;
    return *this;
  }
};

}  // namespace sheetform
