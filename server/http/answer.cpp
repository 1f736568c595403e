#include "server/http/answer.h"

#include <algorithm>

namespace sheetform::server {

Answer& Answer::with(const std::string& name, const std::string& value) {
  std::string clean = value;
  for (char& c : clean)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
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

Answer problem_answer(const api::Problem& problem) {
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

Answer problem_answer(api::ProblemType type, std::string detail, std::string fix, std::string where) {
  api::Problem problem;
  problem.type = type;
  problem.detail = std::move(detail);
  problem.fix = std::move(fix);
  problem.where = std::move(where);
  return problem_answer(problem);
}

}  // namespace sheetform::server
