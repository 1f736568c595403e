// RFC 9457 problems: the closed list of what can go wrong, and the message that says it.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sheetform_api/json_text.h"

namespace sheetform::api {

/// Every type of problem that this API can answer with. Order is that of kProblemTypes.
enum class ProblemType {
  kNoSuchProcess,
  kNoSuchJob,
  kNoSuchOutput,
  kResultNotReady,
  kInvalidQueryParameter,
  kNotFound,
  kMethodNotAllowed,
  kMalformedRequest,
  kInvalidParameter,
  kUnreadableMesh,
  kUnsupportedMesh,
  kMeshLimitExceeded,
  kRemoteInputDisabled,
  kPayloadTooLarge,
  kUnsupportedMediaType,
  kNotAcceptable,
  kRequestTimeout,
  kConflict,
  kIdempotencyInProgress,
  kIdempotencyMismatch,
  kDigestMismatch,
  kPreconditionFailed,
  kRangeNotSatisfiable,
  kMisdirectedRequest,
  kUriTooLong,
  kHeadersTooLarge,
  kUnsupportedVersion,
  kNotImplementedMethod,
  kUnauthorized,
  kForbidden,
  kTooManyRequests,
  kQueueFull,
  kOverloaded,
  kDraining,
  kDiskFull,
  kTimeLimit,
  kMemoryLimit,
  kAlgorithmFailed,
  kWorkerCrashed,
  kStorage,
  kInternal,
};

struct ProblemKind {
  ProblemType type;
  const char* slug;  ///< last part of the URI
  const char* title;
  int status;      ///< HTTP status
  bool retryable;  ///< the same request may succeed later
  bool ogc;        ///< named by OGC API Processes
};

const std::vector<ProblemKind>& problem_kinds();
const ProblemKind& kind_of(ProblemType type);
/// The URI of a type.
std::string type_uri(ProblemType type);
/// The type with this slug; kInternal when there is none.
ProblemType problem_type_from_slug(std::string_view slug);

struct Problem {
  ProblemType type = ProblemType::kInternal;
  std::string detail;    ///< what went wrong, for people
  std::string where;     ///< the place, e.g. "line 12" or "parameter e_max"; may be empty
  std::string fix;       ///< what to do; may be empty
  std::string instance;  ///< path of the request or job
  std::string request_id;
  std::optional<std::int64_t> limit, actual;
  std::optional<std::string> pointer;  ///< JSON pointer or parameter name for `errors`

  int status() const { return kind_of(type).status; }
};

Problem make_problem(ProblemType type, std::string detail, std::string fix = {}, std::string where = {});

Json to_json(const Problem& problem);
/// Reads what to_json wrote (a job's stored problem); unknown types become kInternal.
Problem problem_from_json(const Json& value);

}  // namespace sheetform::api
