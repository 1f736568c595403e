// Processes and execution.
#include <unistd.h>

#include <algorithm>

#include "server/base/version.h"
#include "server/http/api_parts.h"
#include "server/http/conditional.h"
#include "server/http/upload_request.h"
#include "sheetform_api/process.h"

namespace sheetform::server {
namespace {

void require_process(const Exchange& x) {
  if (!api::is_process(x.captures.at(0)))
    throw Refusal(api::ProblemType::kNoSuchProcess, "there is no process " + x.captures[0].substr(0, 60),
                  "see /api/v1/processes");
}

Answer list_processes(Exchange& x) {
  const std::string root = kApiRoot;
  const std::size_t limit = std::stoul(x.parameter("limit").value_or("10"));
  api::Json list = api::Json::array();
  for (const char* id : api::kProcesses)
    if (list.size() < limit) list.push_back(api::process_summary(id, root, kVersion));
  return json_answer(
      200, api::Json{{"processes", std::move(list)},
                     {"links", api::to_json(std::vector<api::Link>{
                                   {root + "/processes", "self", "application/json", "The processes"}})}});
}

Answer describe_process(Exchange& x) {
  require_process(x);
  return json_answer(200, api::process_description(x.captures[0], kApiRoot, kVersion));
}

/// Prefer: wait=N holds the answer back until the job has ended.
std::string wait_as_preferred(const Exchange& x, ApiParts& parts, JobRecord& job) {
  const std::optional<int> wish = preferred_wait(x.head.field("prefer"));
  if (!wish || *wish == 0) return {};
  const int seconds = std::min(*wish, parts.service.limits().wait_seconds);
  const CountedPlace place(parts.waiters, parts.service.limits().waiters, "requests that wait");
  job = parts.service.wait_for_change(job, true, std::chrono::seconds(seconds));
  return "wait=" + std::to_string(seconds);
}

/// The beginning of an upload.
std::string beginning(const Upload& upload) {
  std::string bytes(std::min<std::uint64_t>(upload.bytes(), 4096), '\0');
  const ssize_t got = ::pread(upload.descriptor(), bytes.data(), bytes.size(), 0);
  bytes.resize(got < 0 ? 0 : static_cast<std::size_t>(got));
  return bytes;
}

bool is_one_line(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c == '\t' || (c >= 0x20 && c < 0x7f); });
}

/// curl calls every body a form. Its -d takes the line breaks of a file away, and it goes on without a file
/// that it does not find; both are no fault of the mesh.
void explain_curl(const Upload& upload, api::Problem& problem) {
  if (upload.bytes() == 0) {
    problem.detail = "the request has no body";
    problem.fix = "with curl send the file by --data-binary @FILE; is there such a FILE?";
  } else if (is_one_line(beginning(upload))) {
    problem.fix = "with curl send the file by --data-binary @FILE; -d takes its line breaks away";
  }
}

Submitted submit(const Exchange& x, ApiParts& parts, UploadRequest& request) {
  try {
    return parts.service.submit(*request.upload, request.submission);
  } catch (const Refusal& e) {
    api::Problem p = e.problem();
    if (p.type == api::ProblemType::kUnreadableMesh &&
        x.head.field("content-type").rfind("application/x-www-form-urlencoded", 0) == 0)
      explain_curl(*request.upload, p);
    throw Refusal(p);
  }
}

Answer execute(Exchange& x, ApiParts& parts) {
  require_process(x);
  parts.service.check_admission(x.principal.id);
  UploadRequest request = read_upload_request(x, parts.service);
  Submitted submitted = submit(x, parts, request);
  request.upload.reset();
  const std::string applied = wait_as_preferred(x, parts, submitted.job);
  Answer answer = status_answer(parts, 201, submitted.job);
  answer.with("Location", absolute(parts, x.head, std::string(kApiRoot) + "/jobs/" + submitted.job.id));
  if (!applied.empty()) answer.with("Preference-Applied", applied);
  if (submitted.replayed) answer.with("Idempotency-Replayed", "true");
  return answer;
}

}  // namespace

void add_process_routes(Router& router, ApiParts& parts) {
  const std::string root = kApiRoot;
  router.add({"GET", root + "/processes", "read", list_processes});
  router.add({"GET", root + "/processes/{processID}", "read", describe_process});
  router.add({"POST", root + "/processes/{processID}/execution", "submit",
              [&parts](Exchange& x) { return execute(x, parts); }});
}

}  // namespace sheetform::server
