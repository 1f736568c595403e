// Parts and cut length against error: one input decomposed for several tolerances.
#pragma once
#include <functional>
#include <vector>

#include "sheetform/decompose.h"

namespace sheetform {

/// One decomposition for each tolerance (fractions of the diagonal, in place of params.e_max), in the order
/// given. Everything that does not depend on the tolerance is done once, for the finest one: repair, the
/// plane of symmetry, the working mesh, field, tracing graph and candidates; charts of patches that were seen
/// for one tolerance are at hand for the next. A coarser tolerance does not take more parts of a component
/// than a finer one. Each result is certified as that of decompose, and handed to `found` as soon as it is,
/// the finest first: who keeps it there has it also when the sweep is stopped later. Throws
/// as decompose does, what `found` throws, and kInvalidParameter for an empty list, values out of range, or
/// e_max_mm. Timings of shared stages count for the finest.
std::vector<Decomposition> sweep(const InputMesh& input, const DecomposeParams& params,
                                 const std::vector<double>& e_max, const UserField* field,
                                 RunContext& context, const UserGuides* guides = nullptr,
                                 const std::function<void(const Decomposition&)>& found = {});

}  // namespace sheetform
