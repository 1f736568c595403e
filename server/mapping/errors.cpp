#include "server/mapping/errors.h"

namespace sheetform::server {
namespace {

api::ProblemType problem_type(ErrorCode code) {
  switch (code) {
    case ErrorCode::kInvalidParameter:
      return api::ProblemType::kInvalidParameter;
    case ErrorCode::kUnreadableMesh:
      return api::ProblemType::kUnreadableMesh;
    case ErrorCode::kUnsupportedMesh:
      return api::ProblemType::kUnsupportedMesh;
    case ErrorCode::kLimitExceeded:
      return api::ProblemType::kMeshLimitExceeded;
    case ErrorCode::kDeadlineExceeded:
      return api::ProblemType::kTimeLimit;
    case ErrorCode::kCancelled:
    case ErrorCode::kInternal:
      return api::ProblemType::kAlgorithmFailed;
  }
  return api::ProblemType::kInternal;
}

}  // namespace

api::Problem to_problem(const Error& error) {
  api::Problem problem;
  problem.type = problem_type(error.code());
  problem.detail = error.summary();
  problem.where = error.where();
  problem.fix = error.fix();
  if (error.code() == ErrorCode::kInvalidParameter) problem.pointer = error.where();
  return problem;
}

int exit_status(ErrorCode code) {
  switch (code) {
    case ErrorCode::kInvalidParameter:
      return kExitUsage;
    case ErrorCode::kUnreadableMesh:
    case ErrorCode::kUnsupportedMesh:
    case ErrorCode::kLimitExceeded:
    case ErrorCode::kDeadlineExceeded:
      return kExitInput;
    case ErrorCode::kCancelled:
      return kExitSignal;
    case ErrorCode::kInternal:
      return kExitOurs;
  }
  return kExitOurs;
}

Error to_core_error(const api::InvalidParameter& error) {
  return Error(ErrorCode::kInvalidParameter, error.what(), error.name(), error.fix());
}

}  // namespace sheetform::server
