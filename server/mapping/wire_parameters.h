// The check of parameters for callers that do not know core.
#pragma once
#include "sheetform_api/json_text.h"

namespace sheetform::server {

/// Fills in the defaults and checks everything that can be checked without the mesh: names, types, ranges,
/// and what core can do today. Throws Error kInvalidParameter (where: the parameter's name).
api::Json understood_parameters(const api::Json& given);
/// The same for a sweep, where e_max is a list.
api::Json understood_sweep_parameters(const api::Json& given);

}  // namespace sheetform::server
