// Parameters between the wire (values by name, as parameters.schema.json defines them) and core
// (DecomposeParams).
#pragma once
#include "sheetform/decompose.h"
#include "sheetform_api/parameter_schema.h"

namespace sheetform::server {

/// values: complete and checked (api::complete_parameters). Throws Error kInvalidParameter.
DecomposeParams to_core(const api::Json& values);
/// The reverse; optional parameters that are not set are absent.
api::Json to_wire(const DecomposeParams& params);

/// Fills in the defaults and checks everything that can be checked without the mesh: names, types, ranges,
/// and what core can do today. Throws Error kInvalidParameter (where: the parameter's name).
api::Json understood_parameters(const api::Json& given);

}  // namespace sheetform::server
