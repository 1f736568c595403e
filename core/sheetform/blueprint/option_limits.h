// The range of every number that a download takes, in one place: what is checked is what is documented.
#pragma once
#include <string_view>

namespace sheetform {

struct OptionLimits {
  const char* name;  ///< as in a query
  double low, high;
};

/// Throws Error kInternal for a name that has no limits.
const OptionLimits& limits_of(std::string_view name);

/// Throws Error kInvalidParameter (where: the name) for a value out of its range or not finite.
void require_in_range(double value, std::string_view name);

}  // namespace sheetform
