// Landing page, conformance, description, limits, health, version, figures, session.
#include "server/base/version.h"
#include "server/http/api_parts.h"
#include "server/mapping/run.h"
#include "sheetform_api/api_description.h"

namespace sheetform::server {
namespace {

constexpr std::size_t kSessionBytes = 4096;

Answer landing_page(Exchange&) {
  const std::string root = kApiRoot;
  constexpr const char* kJson = "application/json";
  return json_answer(
      200,
      api::Json{{"title", "sheetform"},
                {"description", "Turns a mesh into sheets that can be cut flat and bent into shape."},
                {"links", api::to_json(std::vector<api::Link>{
                              {root + "/", "self", kJson, "This page"},
                              {"/", "alternate", "text/html", "The page for people"},
                              {root + "/api", "service-desc", "application/vnd.oai.openapi+json;version=3.0",
                               "Description of the API"},
                              {root + "/conformance", "http://www.opengis.net/def/rel/ogc/1.0/conformance",
                               kJson, "Conformance classes"},
                              {root + "/processes", "http://www.opengis.net/def/rel/ogc/1.0/processes", kJson,
                               "The processes"},
                              {root + "/jobs", "http://www.opengis.net/def/rel/ogc/1.0/job-list", kJson,
                               "All jobs of all processes"},
                              {root + "/limits", "limits", kJson, "Limits in force"}})}});
}

Answer conformance(Exchange&) {
  api::Json classes = api::Json::array({"http://www.opengis.net/spec/ogcapi-common-1/1.0/conf/core"});
  for (const char* name : {"core", "ogc-process-description", "json", "oas30", "job-list", "dismiss"})
    classes.push_back(std::string("http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/") + name);
  return json_answer(200, api::Json{{"conformsTo", classes}});
}

Answer description(Exchange&) {
  return text_answer(200, "application/vnd.oai.openapi+json;version=3.0", api::api_description());
}

Answer limits(const ApiParts& parts) {
  const ServiceLimits& l = parts.service.limits();
  const MeshLimits mesh = mesh_limits();
  return json_answer(200, api::Json{{"uploadBytes", l.upload_bytes},
                                    {"jsonBytes", l.json_bytes},
                                    {"meshVertices", mesh.vertices},
                                    {"meshFaces", mesh.faces},
                                    {"queuedJobs", l.queued_jobs},
                                    {"runningJobs", l.slots},
                                    {"jobSeconds", l.job_seconds},
                                    {"jobMemoryBytes", l.job_memory},
                                    {"resultBytes", l.result_bytes},
                                    {"exports", l.exports},
                                    {"exportSeconds", l.export_seconds},
                                    {"eventStreams", l.event_streams},
                                    {"waitSeconds", l.wait_seconds},
                                    {"submitsPerMinute", l.submits_per_minute},
                                    {"keepResultsSeconds", l.keep_results / kSecond},
                                    {"storedBytes", l.stored_bytes},
                                    {"diskFreeBytes", parts.service.free_bytes()}});
}

Answer health_answer(const api::Json& checks) {
  bool good = true;
  for (const auto& [name, state] : checks.items()) good = good && state == "ok";
  return json_answer(good ? 200 : 503, api::Json{{"status", good ? "ok" : "failing"}, {"checks", checks}});
}

const char* word(bool good) { return good ? "ok" : "failing"; }

bool store_answers(const ApiParts& parts) {
  try {
    parts.service.store().probe();
    return true;
  } catch (const StoreError&) {
    return false;
  }
}

api::Json health_checks(const ApiParts& parts) {
  return {{"accepting", word(parts.alive())}, {"store", word(store_answers(parts))}};
}

Answer ready(const ApiParts& parts) {
  api::Json checks = health_checks(parts);
  checks["disk"] = word(parts.service.free_bytes() >= parts.service.limits().free_bytes);
  checks["taking"] = word(!parts.service.draining());
  return health_answer(checks);
}

std::string metrics_text(const ApiParts& parts) {
  std::string text = "# HELP sheetform_jobs Jobs by state\n# TYPE sheetform_jobs gauge\n";
  std::map<std::string, std::int64_t> counts = parts.service.store().counts();
  for (const JobState s : {JobState::kAccepted, JobState::kRunning, JobState::kSuccessful, JobState::kFailed,
                           JobState::kDismissed})
    counts.emplace(api::to_string(s), 0);  // a line that comes and goes is no series
  for (const auto& [state, count] : counts)
    text += "sheetform_jobs{state=\"" + state + "\"} " + std::to_string(count) + "\n";
  const std::optional<Microseconds> oldest = parts.service.store().oldest_waiting();
  const double age = oldest ? static_cast<double>(now_us() - *oldest) / static_cast<double>(kSecond) : 0.0;
  text += metric_line("sheetform_queue_oldest_seconds", "gauge", "Age of the job that waits longest", age);
  text += metric_line("sheetform_slots_busy", "gauge", "Jobs that run now", parts.service.running());
  text += metric_line("sheetform_disk_free_bytes", "gauge", "Free space of the data folder's disk",
                      static_cast<double>(parts.service.free_bytes()));
  text += metric_line("sheetform_stored_bytes", "gauge", "Bytes of all uploads and results",
                      static_cast<double>(parts.service.store().stored_bytes()));
  text += metric_line("sheetform_event_streams", "gauge", "Open event streams", parts.streams);
  text += "# HELP sheetform_build_info Version of the program\n# TYPE sheetform_build_info gauge\n";
  text += "sheetform_build_info{version=\"" + std::string(kVersion) + "\"} 1\n";
  return text + parts.connection_metrics() + parts.metrics.text();
}

/// The name it is reached by says whether that is HTTPS, not a field that anybody can send.
std::string session_cookie(const ApiParts& parts, const std::string& token, int seconds) {
  const bool https = parts.public_url.rfind("https://", 0) == 0;
  return std::string(kSessionCookie) + "=" + token +
         "; Path=/; HttpOnly; SameSite=Strict; Max-Age=" + std::to_string(seconds) +
         (https ? "; Secure" : "");
}

Answer create_session(Exchange& x, ApiParts& parts) {
  x.body.set_limit(kSessionBytes);
  api::Json value;
  std::string why;
  if (!api::parse_json(x.body.read_all(), value, why) || !value.is_object() || !value.contains("token") ||
      !value["token"].is_string())
    throw Refusal(api::ProblemType::kMalformedRequest, "the body is not {\"token\": \"...\"}",
                  "send the token as JSON");
  const std::string token = value["token"];
  if (!parts.gatekeeper.find(token))
    throw Refusal(api::ProblemType::kUnauthorized, "the token is not known here",
                  "ask whoever runs this server for one");
  constexpr int kWeek = 7 * 24 * 3600;
  Answer answer;
  answer.status = 204;
  return answer.with("Set-Cookie", session_cookie(parts, token, kWeek));
}

Answer delete_session(const ApiParts& parts) {
  Answer answer;
  answer.status = 204;
  return answer.with("Set-Cookie", session_cookie(parts, "", 0));
}

}  // namespace

void add_service_routes(Router& router, ApiParts& parts) {
  const std::string root = kApiRoot;
  router.add({"GET", root, "read", landing_page});
  router.add({"GET", root + "/", "read", landing_page});
  router.add({"GET", root + "/conformance", "read", conformance});
  router.add({"GET", root + "/api", "read", description});
  router.add({"GET", root + "/limits", "read", [&parts](Exchange&) { return limits(parts); }});
  router.add({"POST", root + "/session", "", [&parts](Exchange& x) { return create_session(x, parts); }});
  router.add({"DELETE", root + "/session", "", [&parts](Exchange&) { return delete_session(parts); }});
  router.add({"GET", "/healthz", "", [&parts](Exchange&) { return health_answer(health_checks(parts)); }});
  router.add({"GET", "/readyz", "", [&parts](Exchange&) { return ready(parts); }});
  router.add({"GET", "/version", "", [&parts](Exchange&) {
                return json_answer(
                    200, api::Json{{"name", "sheetform"}, {"version", kVersion}, {"sandbox", parts.sandbox}});
              }});
  router.add({"GET", "/metrics", "read", [&parts](Exchange&) {
                return text_answer(200, "text/plain; version=0.0.4", metrics_text(parts));
              }});
}

}  // namespace sheetform::server
