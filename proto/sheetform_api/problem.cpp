#include "sheetform_api/problem.h"

namespace sheetform::api {
namespace {

constexpr const char* kOgc = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/";
constexpr const char* kOwn = "urn:sheetform:problem:";

void put(Json& object, const char* name, const std::string& text) {
  if (!text.empty()) object[name] = text;
}

std::string text_of(const Json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::optional<std::int64_t> number_of(const Json& object, const char* name) {
  const auto found = object.find(name);
  if (found == object.end() || !found->is_number_integer()) return std::nullopt;
  return found->get<std::int64_t>();
}

}  // namespace

const std::vector<ProblemKind>& problem_kinds() {
  using T = ProblemType;
  static const std::vector<ProblemKind> kinds{
      {T::kNoSuchProcess, "no-such-process", "There is no such process", 404, false, true},
      {T::kNoSuchJob, "no-such-job", "There is no such job", 404, false, true},
      {T::kNoSuchOutput, "no-such-output", "The result has no such file", 404, false, true},
      {T::kResultNotReady, "result-not-ready", "The result is not ready", 404, true, true},
      {T::kInvalidQueryParameter, "invalid-query-parameter-value", "A query parameter is wrong", 400, false,
       true},
      {T::kNotFound, "not-found", "There is nothing at this address", 404, false, false},
      {T::kMethodNotAllowed, "method-not-allowed", "This address does not take this method", 405, false,
       false},
      {T::kMalformedRequest, "malformed-request", "The request is malformed", 400, false, false},
      {T::kInvalidParameter, "invalid-parameter", "A parameter is wrong", 422, false, false},
      {T::kUnreadableMesh, "unreadable-mesh", "The mesh cannot be read", 422, false, false},
      {T::kUnsupportedMesh, "unsupported-mesh", "The mesh cannot be decomposed", 422, false, false},
      {T::kMeshLimitExceeded, "limit-exceeded", "The mesh exceeds a limit", 422, false, false},
      {T::kRemoteInputDisabled, "remote-input-disabled", "Meshes are not fetched from elsewhere", 422, false,
       false},
      {T::kPayloadTooLarge, "payload-too-large", "The upload is too large", 413, false, false},
      {T::kUnsupportedMediaType, "unsupported-media-type", "This type of body is not understood", 415, false,
       false},
      {T::kNotAcceptable, "not-acceptable", "The answer is not available in the wanted form", 406, false,
       false},
      {T::kRequestTimeout, "request-timeout", "The request did not arrive in time", 408, true, false},
      {T::kConflict, "conflict", "The job is in another state", 409, false, false},
      {T::kIdempotencyInProgress, "idempotency-in-progress", "A request with this key is still running", 409,
       true, false},
      {T::kIdempotencyMismatch, "idempotency-mismatch", "This key was used for another request", 422, false,
       false},
      {T::kDigestMismatch, "digest-mismatch", "The upload differs from its digest", 400, true, false},
      {T::kPreconditionFailed, "precondition-failed", "The file differs from the one named", 412, false,
       false},
      {T::kRangeNotSatisfiable, "range-not-satisfiable", "The range lies outside the file", 416, false,
       false},
      {T::kMisdirectedRequest, "misdirected-request", "This server does not answer for this host name", 421,
       false, false},
      {T::kUriTooLong, "uri-too-long", "The address is too long", 414, false, false},
      {T::kHeadersTooLarge, "headers-too-large", "The request's head is too large", 431, false, false},
      {T::kUnsupportedVersion, "unsupported-version", "Only HTTP/1.0 and HTTP/1.1 are spoken", 505, false,
       false},
      {T::kNotImplementedMethod, "not-implemented", "The method or transfer coding is not known", 501, false,
       false},
      {T::kUnauthorized, "unauthorized", "A token is needed", 401, false, false},
      {T::kForbidden, "forbidden", "This is not allowed", 403, false, false},
      {T::kTooManyRequests, "too-many-requests", "Too many requests", 429, true, false},
      {T::kQueueFull, "queue-full", "The queue is full", 503, true, false},
      {T::kOverloaded, "overloaded", "Too many connections", 503, true, false},
      {T::kDraining, "draining", "The server is stopping", 503, true, false},
      {T::kDiskFull, "disk-full", "The server's disk is full", 507, true, false},
      {T::kTimeLimit, "time-limit", "The job took too long", 422, false, false},
      {T::kMemoryLimit, "memory-limit", "The job needs too much memory", 422, false, false},
      {T::kAlgorithmFailed, "algorithm-failed", "The decomposition failed", 500, false, false},
      {T::kWorkerCrashed, "worker-crashed", "The program that ran the job died", 500, false, false},
      {T::kStorage, "storage", "The result could not be stored", 500, true, false},
      {T::kInternal, "internal", "Our fault", 500, true, false},
  };
  return kinds;
}

const ProblemKind& kind_of(ProblemType type) { return problem_kinds()[static_cast<std::size_t>(type)]; }

std::string type_uri(ProblemType type) {
  const ProblemKind& kind = kind_of(type);
  return std::string(kind.ogc ? kOgc : kOwn) + kind.slug;
}

ProblemType problem_type_from_slug(std::string_view slug) {
  for (const ProblemKind& kind : problem_kinds())
    if (slug == kind.slug) return kind.type;
  return ProblemType::kInternal;
}

Problem make_problem(ProblemType type, std::string detail, std::string fix, std::string where) {
  Problem p;
  p.type = type;
  p.detail = std::move(detail);
  p.fix = std::move(fix);
  p.where = std::move(where);
  return p;
}

Json to_json(const Problem& problem) {
  const ProblemKind& kind = kind_of(problem.type);
  Json object{{"type", type_uri(problem.type)},
              {"title", kind.title},
              {"status", kind.status},
              {"retryable", kind.retryable}};
  put(object, "detail", problem.detail);
  put(object, "where", problem.where);
  put(object, "fix", problem.fix);
  put(object, "instance", problem.instance);
  put(object, "requestId", problem.request_id);
  if (problem.limit) object["limit"] = *problem.limit;
  if (problem.actual) object["actual"] = *problem.actual;
  if (problem.pointer)
    object["errors"] = Json::array({{{"pointer", *problem.pointer}, {"detail", problem.detail}}});
  return object;
}

Problem problem_from_json(const Json& value) {
  Problem problem;
  if (!value.is_object()) return problem;
  const std::string uri = text_of(value, "type");
  problem.type = problem_type_from_slug(std::string_view(uri).substr(uri.find_last_of("/:") + 1));
  problem.detail = text_of(value, "detail");
  problem.where = text_of(value, "where");
  problem.fix = text_of(value, "fix");
  problem.instance = text_of(value, "instance");
  problem.request_id = text_of(value, "requestId");
  problem.limit = number_of(value, "limit");
  problem.actual = number_of(value, "actual");
  return problem;
}

}  // namespace sheetform::api
