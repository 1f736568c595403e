#include "server/http/api_server.h"

#include <algorithm>
#include <system_error>

#include "server/base/identity.h"
#include "server/base/log.h"
#include "server/http/field_text.h"
#include "server/mapping/errors.h"
#include "sheetform_api/api_description.h"

namespace sheetform::server {
namespace {

using api::ProblemType;

constexpr auto kStalledLoop = std::chrono::seconds(5);

/// An id that a client gave, when it is harmless; else a new one.
std::string request_id_of(const RequestHead& head) {
  const std::string given = head.field("x-request-id");
  const auto harmless = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '_' || c == '-';
  };
  const bool usable =
      !given.empty() && given.size() <= 64 && std::all_of(given.begin(), given.end(), harmless);
  return usable ? given : to_hex(random_bytes(8));
}

bool changes_something(const std::string& method) {
  return method != "GET" && method != "HEAD" && method != "OPTIONS";
}

/// The same problem, told where and in which request it happened.
Answer placed(api::Problem problem, const GuardedRequest& request, const std::string& request_id) {
  if (problem.instance.empty()) problem.instance = request.head.path;
  problem.request_id = request_id;
  return problem_answer(problem);
}

constexpr const char* kSendMeshes = "send meshes by POST to /api/v1/processes/decompose/execution";

/// Who sends something where nothing is taken most likely has a mesh.
api::Problem method_not_allowed(const RequestHead& head, const std::string& allowed) {
  const bool sends = head.method == "POST" || head.method == "PUT";
  const bool takes = allowed.find("POST") != std::string::npos;
  std::string fix;
  if (sends && takes) fix = "send it by POST, e.g. curl --data-binary @FILE";
  if (sends && !takes) fix = kSendMeshes;
  return make_problem(ProblemType::kMethodNotAllowed, head.method + " is not allowed here, but " + allowed,
                      fix);
}

Refusal nothing_here(const Router& router, const RequestHead& head) {
  std::string fix = "see /api/v1/";
  const std::string shorter = head.path.substr(0, head.path.find_last_not_of('/') + 1);
  if (head.method == "POST" || head.method == "PUT") fix = kSendMeshes;
  if (shorter != head.path && !router.match(head.method, shorter).allowed.empty())
    fix = "leave out the / at the end";
  return Refusal(ProblemType::kNotFound, "there is nothing at this address", fix);
}

Refusal malformed_query(const std::string& query) {
  const auto told = [](const char* detail, const char* fix) {
    return Refusal(ProblemType::kInvalidQueryParameter, detail, fix, "query");
  };
  std::string decoded;
  if (!percent_decode(query, true, decoded))
    return told("the query holds a % without two hexadecimal digits", "write a percent sign as %25");
  if (std::any_of(decoded.begin(), decoded.end(), is_control))
    return told("the query holds a control character", "leave it out; no parameter takes one");
  return told("the query has too many parameters", "give 64 at most");
}

api::Problem problem_of(const StoreError& error, const std::string& request_id) {
  if (error.kind() == StoreFailure::kFull)
    return make_problem(ProblemType::kDiskFull, "the server's disk is full", "try again later");
  log_error("the store failed", {{"request", request_id}, {"reason", error.what()}});
  if (error.kind() == StoreFailure::kBusy)
    return make_problem(ProblemType::kOverloaded, "the store is busy", "try again");
  return make_problem(ProblemType::kInternal, "the store could not answer");
}

/// What went wrong is for the log; the client gets the number under which it stands there.
api::Problem problem_of(const std::exception& error, const std::string& request_id) {
  const auto* system = dynamic_cast<const std::system_error*>(&error);
  if (system != nullptr && (system->code().value() == ENOSPC || system->code().value() == EDQUOT))
    return make_problem(ProblemType::kDiskFull, "the server's disk is full", "try again later");
  log_error("a request failed", {{"request", request_id}, {"reason", error.what()}});
  return make_problem(ProblemType::kInternal, "the server had a problem");
}

}  // namespace

ApiServer::ApiServer(JobService& service, ApiOptions options)
    : service_(service),
      options_(std::move(options)),
      gatekeeper_(service.store(), options_.token_file, options_.secret),
      page_(options_.web_folder),
      parts_{service,
             metrics_,
             options_.auth,
             gatekeeper_,
             options_.public_url,
             [this] {
               return metric_line("sheetform_http_connections", "gauge", "Connections being answered",
                                  guard_.busy()) +
                      metric_line("sheetform_http_waiting", "gauge", "Connections without a request",
                                  guard_.waiting()) +
                      metric_line("sheetform_http_shed_total", "counter", "Connections turned away",
                                  static_cast<double>(guard_.shed()));
             },
             [this] { return alive(); },
             options_.sandbox},
      rate_(service.limits().submits_per_minute),
      guard_(
          options_.guard, [this](GuardedRequest& r) { return dispatch(r); },
          [this](const GuardedRequest& r, const Answer& a, const Served& s) { report(r, a, s); }) {
  add_service_routes(router_, parts_);
  add_process_routes(router_, parts_);
  add_job_routes(router_, parts_);
  add_result_routes(router_, parts_);
  add_export_routes(router_, parts_);
  add_event_routes(router_, parts_);
  router_.describe(api::Json::parse(api::api_description()));
}

bool ApiServer::alive() const { return SteadyClock::now() - guard_.last_turn() < kStalledLoop; }

Answer ApiServer::dispatch(GuardedRequest& request) {
  const std::string request_id = request_id_of(request.head);
  Answer answer;
  try {
    answer = judge(request, request_id);
  } catch (const Refusal& e) {
    answer = placed(e.problem(), request, request_id);
  } catch (const Error& e) {
    answer = placed(to_problem(e), request, request_id);
  } catch (const BodyError& e) {
    answer = placed(make_problem(e.type(), e.what()), request, request_id);
  } catch (const StoreError& e) {
    answer = placed(problem_of(e, request_id), request, request_id);
  } catch (const std::exception& e) {
    answer = placed(problem_of(e, request_id), request, request_id);
  }
  answer.with("X-Request-Id", request_id).with("X-Content-Type-Options", "nosniff");
  if (!answer.has("Cache-Control")) answer.with("Cache-Control", "no-store");
  return answer;
}

/// In this order, and all of it before a byte of the body is read: head, address, host, origin, token, rate.
Answer ApiServer::judge(GuardedRequest& request, const std::string& request_id) {
  if (request.error) throw Refusal(request.error->type, request.error->detail, request.error->fix);
  const RouteMatch match = router_.match(request.head.method, request.head.path);
  if (!match.route && match.allowed.empty()) {
    if (!changes_something(request.head.method) && host_allowed(options_.auth, request.head))
      if (std::optional<Answer> file = page_.find(request.head)) return *file;
    throw nothing_here(router_, request.head);
  }
  if (!match.route)
    return placed(method_not_allowed(request.head, match.allowed), request, request_id)
        .with("Allow", match.allowed);
  Principal principal;
  judge_sender(*match.route, request, principal);
  Exchange exchange{request.head, request.body, request.peer, request_id, {}, match.captures, principal};
  if (!parse_query(request.head.query, exchange.query)) throw malformed_query(request.head.query);
  // Who watches over a server may ask for its health with anything that keeps caches away.
  if (!match.route->scope.empty()) check_query(match.route->query, exchange.query);
  return match.route->handler(exchange);
}

void ApiServer::judge_sender(const Route& route, const GuardedRequest& request, Principal& principal) {
  const RequestHead& head = request.head;
  const bool open_to_all = route.scope.empty();
  if (!host_allowed(options_.auth, head) && head.path != "/healthz" && head.path != "/readyz")
    throw Refusal(ProblemType::kMisdirectedRequest,
                  "this server does not answer for the host " + host_name(head.field("host")),
                  "ask for localhost, or have it started with --public-url for the name it is reached by",
                  "Host");
  if (changes_something(head.method) && !origin_allowed(options_.auth, head))
    throw Refusal(ProblemType::kForbidden, "the request comes from a page of another site",
                  "use the page of this server; start it with --public-url when it has a name of its own",
                  "Origin");
  const std::string token = token_of(head);
  const std::optional<Principal> known = token.empty() ? std::nullopt : gatekeeper_.find(token);
  if (known)
    principal = *known;
  else if (!open_to_all && (options_.auth.needed || !token.empty()))
    throw Refusal(
        ProblemType::kUnauthorized, token.empty() ? "a token is needed" : "the token is not known here",
        token.empty()
            ? "send Authorization: Bearer TOKEN"
            : "send it whole, as it was given to you, or ask whoever runs this server for a new one",
        "Authorization");
  else
    principal.scopes = "read submit jobs:all";
  if (!open_to_all && !principal.may(route.scope))
    throw Refusal(ProblemType::kForbidden, "this token may not do that", "it needs the scope " + route.scope);
  if (route.scope == "submit" && !rate_.take(principal.id > 0 ? principal.name : request.peer))
    throw Refusal(
        ProblemType::kTooManyRequests,
        "these are more than " + std::to_string(service_.limits().submits_per_minute) + " jobs in a minute",
        "wait half a minute; /api/v1/limits tells how many may come");
}

void ApiServer::report(const GuardedRequest& request, const Answer& answer, const Served& served) {
  const RouteMatch match = router_.match(request.head.method, request.head.path);
  const std::string route = match.route           ? match.route->path
                            : request.error       ? "malformed"
                            : answer.status < 400 ? "page"
                                                  : "other";
  metrics_.count_request(route, request.head.method.empty() ? "-" : request.head.method, served.status,
                         served.seconds, served.bytes_in, served.bytes_out);
  const bool quiet = route == "/healthz" || route == "/readyz" || route == "/metrics";
  if (!options_.log_requests || (quiet && served.status < 400)) return;
  std::string id;
  for (const auto& [name, value] : answer.headers)
    if (name == "X-Request-Id") id = value;
  log(served.status >= 500 ? LogLevel::kWarning : LogLevel::kInfo, "request",
      {{"request", id},
       {"method", request.head.method},
       {"path", request.head.path},
       {"status", served.status},
       {"ms", static_cast<std::int64_t>(served.seconds * 1000)},
       {"in", served.bytes_in},
       {"out", served.bytes_out},
       {"peer", request.peer}});
}

}  // namespace sheetform::server
