// Who asks.
#pragma once
#include <cstdint>
#include <string>

namespace sheetform::server {

/// Scopes: read (jobs and results), submit (start, cancel, retry), jobs:all (those of others too), admin
/// (everything).
struct Principal {
  std::int64_t id = 0;       ///< in the store; 0 is anonymous
  std::string name, scopes;  ///< scopes separated by spaces

  bool may(const std::string& scope) const {
    const std::string all = " " + scopes + " ";
    return all.find(" " + scope + " ") != std::string::npos || all.find(" admin ") != std::string::npos;
  }
};

}  // namespace sheetform::server
