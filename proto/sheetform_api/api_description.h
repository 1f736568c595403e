// The OpenAPI description as it is served: proto/openapi.yaml with the schema of the parameters and the types
// of problems filled in.
#pragma once
#include <string>

namespace sheetform::api {

/// JSON, OpenAPI 3.0.
const std::string& api_description();

}  // namespace sheetform::api
