// Any bytes as the JSON of an execute request: read or refused with words, never more.
#include <cstdint>
#include <cstdlib>

#include "server/base/digest.h"
#include "sheetform_api/job.h"
#include "sheetform_api/parameter_schema.h"

namespace {

using namespace sheetform;

void require(bool good) {
  if (!good) std::abort();
}

void check_parameters(const api::Json& given) {
  try {
    const api::Json complete = api::complete_parameters(given);
    require(api::complete_parameters(complete) == complete);
  } catch (const api::InvalidParameter& e) {
    require(e.what()[0] != '\0');
  }
}

void check_mesh(const std::string& base64) {
  std::string bytes;
  if (server::from_base64(base64, bytes)) require(server::to_base64(bytes) == base64);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  api::Json value, again;
  std::string why;
  if (!api::parse_json(text, value, why)) {
    require(!why.empty());
    return 0;
  }
  require(api::parse_json(api::dump(value), again, why));
  api::ExecuteRequest request;
  api::Problem problem;
  if (!api::read_execute_request(value, request, problem)) {
    require(!problem.detail.empty());
    return 0;
  }
  check_mesh(request.mesh_base64);
  check_parameters(request.parameters);
  return 0;
}
