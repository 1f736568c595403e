// Jobs: list, state, dismissal, retry, log.
#include <algorithm>

#include "server/http/api_parts.h"
#include "server/http/conditional.h"
#include "server/http/field_text.h"
#include "server/http/job_query.h"
#include "sheetform_api/process.h"

namespace sheetform::server {
namespace {

JobRecord job_of(const Exchange& x, const ApiParts& parts) {
  return parts.service.job(x.captures.at(0), x.visible());
}

/// Cuts the page to its length; whether there were more jobs in the direction of reading.
bool cut_page(std::vector<JobRecord>& jobs, std::size_t limit, bool backwards) {
  if (jobs.size() <= limit) return false;
  jobs.erase(backwards ? jobs.begin() : jobs.end() - 1);
  return true;
}

Answer list_jobs(Exchange& x, const ApiParts& parts) {
  JobFilter filter = job_filter(x);
  const auto limit =
      static_cast<std::size_t>(filter.limit++);  // one more tells whether there is another page
  std::vector<JobRecord> jobs = parts.service.store().list(filter);
  const bool backwards = filter.before.has_value(), more = cut_page(jobs, limit, backwards);
  const std::string self = std::string(kApiRoot) + "/jobs";
  std::vector<api::Link> links{{self + (x.head.query.empty() ? "" : "?" + x.head.query), "self",
                                "application/json", "This page of jobs"}};
  // Behind the reader are the jobs of the page that led here.
  if (!jobs.empty() && (backwards || more))
    links.push_back({self + "?" + next_page_query(x, jobs.back()), "next", "application/json", "Older jobs"});
  if (!jobs.empty() && (backwards ? more : filter.after.has_value()))
    links.push_back(
        {self + "?" + previous_page_query(x, jobs.front()), "prev", "application/json", "Newer jobs"});
  return text_answer(
      200, "application/json",
      "{\"jobs\":" + jobs_text(parts, jobs) + ",\"links\":" + api::dump(api::to_json(links)) + "}\n");
}

std::string revision_tag(const JobRecord& job) { return "W/\"" + std::to_string(job.revision) + "\""; }

Answer get_job(Exchange& x, ApiParts& parts) {
  JobRecord job = job_of(x, parts);
  const std::optional<int> wish = preferred_wait(x.head.field("prefer"));
  std::string applied;
  if (wish && *wish > 0 && !api::is_terminal(job.state)) {
    const int seconds = std::min(*wish, parts.service.limits().wait_seconds);
    const CountedPlace place(parts.waiters, parts.service.limits().waiters, "requests that wait");
    job = parts.service.wait_for_change(job, false, std::chrono::seconds(seconds));
    applied = "wait=" + std::to_string(seconds);
  }
  // Live progress is not in the revision: only what has ended can be "not modified".
  const bool same = x.head.has("if-none-match") && api::is_terminal(job.state) &&
                    names_tag(x.head.field("if-none-match"), revision_tag(job).substr(2), true);
  Answer answer = same ? Answer{} : status_answer(parts, 200, job);
  if (same) {
    answer.status = 304;
    answer.with("ETag", revision_tag(job));
  }
  if (!applied.empty()) answer.with("Preference-Applied", applied);
  return answer;
}

/// Opening a point again answers with the same job.
Answer open_point(const Exchange& x, ApiParts& parts) {
  const JobRecord sweep = successful_job(x, parts);
  if (sweep.process != api::kSweep)
    throw Refusal(api::ProblemType::kNoSuchOutput, "the job is no sweep, it has no points",
                  "only jobs of the process sweep have them");
  const Submitted opened = parts.service.open_point(sweep, x.captures.at(1));
  return status_answer(parts, opened.replayed ? 200 : 201, opened.job)
      .with("Location", absolute(parts, x.head, std::string(kApiRoot) + "/jobs/" + opened.job.id));
}

/// What a job's process printed may be shown by a terminal, and must not steer it.
Answer get_log(Exchange& x, const ApiParts& parts) {
  const JobRecord job = job_of(x, parts);
  std::string text = parts.service.store().attempt_log(job.seq);
  std::replace_if(
      text.begin(), text.end(), [](char c) { return is_control(c) && c != '\n' && c != '\t'; }, '?');
  return text_answer(200, "text/plain; charset=utf-8", std::move(text));
}

}  // namespace

std::string job_text(const ApiParts& parts, const JobRecord& job) {
  return api::status_text(parts.service.status(job), kApiRoot);
}

std::string jobs_text(const ApiParts& parts, const std::vector<JobRecord>& jobs) {
  std::vector<std::string> texts;
  for (const JobRecord& job : jobs) texts.push_back(job_text(parts, job));
  return api::array_text(texts);
}

Answer status_answer(const ApiParts& parts, int status, const JobRecord& job) {
  Answer answer = text_answer(status, "application/json", job_text(parts, job) + "\n");
  return answer.with("ETag", revision_tag(job));
}

std::string absolute(const ApiParts& parts, const RequestHead& head, const std::string& path) {
  return (parts.public_url.empty() ? "http://" + head.field("host") : parts.public_url) + path;
}

CountedPlace::CountedPlace(std::atomic<int>& count, int most, const std::string& what) : count_(count) {
  if (++count_ <= most) return;
  --count_;
  api::Problem p = make_problem(api::ProblemType::kTooManyRequests, "there are too many " + what,
                                "close some, or ask again later");
  p.limit = most;
  throw Refusal(p);
}

void add_job_routes(Router& router, ApiParts& parts) {
  const std::string jobs = std::string(kApiRoot) + "/jobs", job = jobs + "/{jobID}";
  router.add({"GET", jobs, "read", [&parts](Exchange& x) { return list_jobs(x, parts); }});
  router.add({"GET", job, "read", [&parts](Exchange& x) { return get_job(x, parts); }});
  router.add({"DELETE", job, "submit", [&parts](Exchange& x) {
                return status_answer(parts, 200, parts.service.dismiss(job_of(x, parts)));
              }});
  router.add({"POST", job + "/finish", "submit", [&parts](Exchange& x) {
                return status_answer(parts, 200, parts.service.finish(job_of(x, parts)));
              }});
  router.add({"POST", job + "/retry", "submit", [&parts](Exchange& x) {
                return status_answer(parts, 200, parts.service.retry(job_of(x, parts)));
              }});
  router.add(
      {"POST", job + "/points/{point}", "submit", [&parts](Exchange& x) { return open_point(x, parts); }});
  router.add({"GET", job + "/log", "read", [&parts](Exchange& x) { return get_log(x, parts); }});
}

}  // namespace sheetform::server
