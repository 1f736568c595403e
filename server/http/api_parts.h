// What the handlers of the API share.
#pragma once
#include <atomic>
#include <functional>

#include "server/http/auth.h"
#include "server/http/metrics.h"
#include "server/http/router.h"
#include "server/jobs/job_service.h"

namespace sheetform::server {

inline constexpr const char* kApiRoot = "/api/v1";

struct ApiParts {
  JobService& service;
  Metrics& metrics;
  AuthOptions auth;
  Gatekeeper& gatekeeper;
  std::string public_url;                           ///< begins Location; empty: http:// and Host
  std::function<std::string()> connection_metrics;  ///< lines about the HTTP server
  std::function<bool()> alive;                      ///< the accept loop turns
  api::Json sandbox;                                ///< what the sandbox can do on this machine
  std::atomic<int> streams{0}, waiters{0}, exports{0};
};

void add_service_routes(Router& router, ApiParts& parts);
void add_process_routes(Router& router, ApiParts& parts);
void add_job_routes(Router& router, ApiParts& parts);
void add_result_routes(Router& router, ApiParts& parts);
void add_export_routes(Router& router, ApiParts& parts);
void add_event_routes(Router& router, ApiParts& parts);

/// The status document of a job, as JSON text on one line; and an array of them.
std::string job_text(const ApiParts& parts, const JobRecord& job);
std::string jobs_text(const ApiParts& parts, const std::vector<JobRecord>& jobs);
/// The status document of a job, with its weak tag.
Answer status_answer(const ApiParts& parts, int status, const JobRecord& job);
/// The job of the address if its result can be had; a failed job answers with its own problem.
JobRecord successful_job(const Exchange& x, const ApiParts& parts);
/// Name of the uploaded mesh without its ending, for files made from it.
std::string base_name(const JobRecord& job);
/// The address of a path for headers that want a whole one.
std::string absolute(const ApiParts& parts, const RequestHead& head, const std::string& path);

/// Counts down when it goes; for the limits on streams and waiters.
class CountedPlace {
 public:
  /// Takes one of `most` places, or throws Refusal kTooManyRequests naming `what`.
  CountedPlace(std::atomic<int>& count, int most, const std::string& what);
  ~CountedPlace() { --count_; }
  CountedPlace(const CountedPlace&) = delete;
  CountedPlace& operator=(const CountedPlace&) = delete;

 private:
  std::atomic<int>& count_;
};

}  // namespace sheetform::server
