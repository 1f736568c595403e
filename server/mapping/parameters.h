// Parameters between the wire (values by name, as parameters.schema.json defines them) and core
// (DecomposeParams).
#pragma once
#include "server/mapping/wire_parameters.h"
#include "sheetform/decompose.h"
#include "sheetform_api/parameter_schema.h"

namespace sheetform::server {

/// values: complete and checked (api::complete_parameters). Of a sweep, whose tolerance is a list, the finest
/// one is taken. Throws Error kInvalidParameter.
DecomposeParams to_core(const api::Json& values);
/// The reverse; optional parameters that are not set are absent.
api::Json to_wire(const DecomposeParams& params);

}  // namespace sheetform::server
