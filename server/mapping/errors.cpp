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

/// What to do when the one who found the fault had no better advice.
const char* usual_fix(ErrorCode code) {
  switch (code) {
    case ErrorCode::kUnreadableMesh:
      return "export the mesh again, or in another format";
    case ErrorCode::kUnsupportedMesh:
      return "repair the mesh in the program that made it";
    case ErrorCode::kLimitExceeded:
      return "simplify the mesh";
    default:
      return "";
  }
}

}  // namespace

api::Problem to_problem(const Error& error) {
  api::Problem problem;
  problem.type = problem_type(error.code());
  problem.detail = error.summary();
  problem.where = error.where();
  problem.fix = error.fix().empty() ? usual_fix(error.code()) : error.fix();
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
