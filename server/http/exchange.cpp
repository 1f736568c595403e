#include "server/http/exchange.h"

#include "server/jobs/job_service.h"

namespace sheetform::server {
namespace {

[[noreturn]] void refuse_parameter(const std::string& name, const std::string& detail,
                                   const std::string& fix) {
  throw Refusal(api::ProblemType::kInvalidQueryParameter, detail, fix, name.substr(0, 60));
}

}  // namespace

std::optional<std::string> Exchange::parameter(const std::string& name) const {
  std::optional<std::string> value;
  for (const auto& [n, v] : query) {
    if (n != name) continue;
    if (value) refuse_parameter(name, "the parameter is given twice", "give it once");
    value = v;
  }
  return value;
}

std::optional<std::int64_t> Exchange::visible() const {
  if (principal.may("jobs:all")) return std::nullopt;
  return principal.id;
}

}  // namespace sheetform::server
