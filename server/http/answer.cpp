#include "server/http/answer.h"

#include <algorithm>

#include "server/http/field_text.h"

namespace sheetform::server {
namespace {

/// What to do when whoever refused had no better advice: a problem without any is no help.
const char* usual_fix(api::ProblemType type) {
  using T = api::ProblemType;
  switch (type) {
    case T::kMalformedRequest:
    case T::kUnsupportedVersion:
    case T::kNotImplementedMethod:
      return "send the request with a common HTTP client, e.g. curl; /api/v1/api describes all requests";
    case T::kMethodNotAllowed:
      return "use one of these methods; /api/v1/api describes all requests";
    case T::kPayloadTooLarge:
      return "simplify the mesh, or store it in a binary format; /api/v1/limits tells how large it may be";
    case T::kRequestTimeout:
      return "send it again over a steadier connection";
    case T::kPreconditionFailed:
      return "ask for the file without If-Match, or with its present ETag";
    case T::kRangeNotSatisfiable:
      return "ask for a range that begins within the file, or for all of it";
    case T::kUriTooLong:
    case T::kHeadersTooLarge:
      return "shorten it; the mesh itself belongs into the body";
    case T::kForbidden:
      return "ask whoever runs the server for a token that may do it";
    case T::kInternal:
      return "try again later; the server's log tells more under this requestId";
    default:
      return "see /api/v1/api";
  }
}

}  // namespace

Answer& Answer::with(const std::string& name, const std::string& value) {
  std::string clean = value;
  for (char& c : clean)
    if (is_control(c)) c = ' ';
  headers.emplace_back(name, std::move(clean));
  return *this;
}

bool Answer::has(std::string_view name) const {
  return std::any_of(headers.begin(), headers.end(), [&](const auto& h) { return h.first == name; });
}

Answer text_answer(int status, const std::string& media_type, std::string body) {
  Answer answer;
  answer.status = status;
  answer.media_type = media_type;
  answer.body = std::move(body);
  return answer;
}

Answer json_answer(int status, const api::Json& value) {
  return text_answer(status, "application/json", api::dump(value) + "\n");
}

Answer json_answer(int status, const api::OrderedJson& value) {
  return text_answer(status, "application/json", api::dump(value) + "\n");
}

Answer problem_answer(api::Problem problem) {
  if (problem.fix.empty()) problem.fix = usual_fix(problem.type);
  Answer answer =
      text_answer(problem.status(), "application/problem+json", api::dump(api::to_json(problem)) + "\n");
  switch (problem.type) {
    case api::ProblemType::kUnauthorized:
      answer.with("WWW-Authenticate", "Bearer");
      break;
    case api::ProblemType::kIdempotencyInProgress:
      answer.with("Retry-After", "1");
      break;
    case api::ProblemType::kOverloaded:
      answer.with("Retry-After", "1");
      break;
    case api::ProblemType::kTooManyRequests:
    case api::ProblemType::kQueueFull:
    case api::ProblemType::kDraining:
      answer.with("Retry-After", "30");
      break;
    case api::ProblemType::kDiskFull:
      answer.with("Retry-After", "300");
      break;
    default:
      break;
  }
  return answer;
}

}  // namespace sheetform::server
