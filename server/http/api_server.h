// The whole server: from a request that was read to an answer, in the order in which a request is judged.
#pragma once
#include "server/http/api_parts.h"
#include "server/http/guard_server.h"
#include "server/http/page_files.h"
#include "server/http/rate_limit.h"

namespace sheetform::server {

struct ApiOptions {
  GuardOptions guard;
  AuthOptions auth;
  std::filesystem::path token_file;  ///< of the records
  std::string secret;                ///< one more token; may be empty
  std::string public_url;
  std::filesystem::path web_folder;  ///< empty: the page that is built in
  api::Json sandbox;
  bool log_requests = true;
};

class ApiServer {
 public:
  ApiServer(JobService& service, ApiOptions options);

  int listen(const ListenAddress& address) { return guard_.listen(address); }
  void start() { guard_.start(); }
  bool drain(SteadyClock::time_point until) { return guard_.drain(until); }
  bool alive() const;
  const Router& router() const { return router_; }
  bool has_page() const { return !page_.empty(); }

 private:
  Answer dispatch(GuardedRequest& request);
  Answer judge(GuardedRequest& request, const std::string& request_id);
  /// Host, origin, token, scope, rate. Fills in who asks; throws Refusal.
  void judge_sender(const Route& route, const GuardedRequest& request, Principal& principal);
  void report(const GuardedRequest& request, const Answer& answer, const Served& served);

  JobService& service_;
  ApiOptions options_;
  Metrics metrics_;
  Gatekeeper gatekeeper_;
  PageFiles page_;
  ApiParts parts_;
  Router router_;
  RateLimit rate_;
  GuardServer guard_;
};

}  // namespace sheetform::server
