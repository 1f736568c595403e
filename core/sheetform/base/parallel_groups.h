// Loops over much that is little each.
#pragma once
#include <algorithm>

#include "sheetform/base/run_context.h"

namespace sheetform {

/// parallel_for over groups of `size` neighbours, for what is too little to be handed out one by one; asks
/// checkpoint() before each group.
template <typename Call>
void parallel_in_groups(const RunContext& context, int n, int size, const Call& fn) {
  parallel_for(context, (n + size - 1) / size, [&](int group) {
    context.checkpoint();
    for (int i = group * size; i < std::min(n, (group + 1) * size); ++i) fn(i);
  });
}

}  // namespace sheetform
