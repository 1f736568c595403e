// A request that cannot be granted; becomes a problem response.
#pragma once
#include <stdexcept>
#include <string>

#include "sheetform_api/problem.h"

namespace sheetform::server {

class Refusal : public std::runtime_error {
 public:
  explicit Refusal(api::Problem problem) : std::runtime_error(problem.detail), problem_(std::move(problem)) {}
  Refusal(api::ProblemType type, std::string detail, std::string fix = {}, std::string where = {});
  const api::Problem& problem() const { return problem_; }

 private:
  api::Problem problem_;
};

}  // namespace sheetform::server
