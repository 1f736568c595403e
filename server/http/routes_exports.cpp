// Exports: files made from a stored result for another machine, sheet or material, without computing it
// again.
#include "server/base/identity.h"
#include "server/http/api_parts.h"
#include "server/http/download.h"
#include "sheetform/base/error.h"
#include "sheetform_api/process.h"

namespace sheetform::server {
namespace {

using api::ProblemType;

std::string address_of(const JobRecord& job) {
  return std::string(kApiRoot) + "/jobs/" + job.id + "/exports";
}

/// The job whose result is exported.
JobRecord exported_job(const Exchange& x, const ApiParts& parts) {
  JobRecord job = successful_job(x, parts);
  if (job.process == api::kSweep)
    throw Refusal(ProblemType::kNoSuchOutput, "a sweep is exported point by point",
                  "POST .../points/0.02 opens a point as a job, which has exports");
  return job;
}

/// The axis that points up in pictures where the query does not say it: that of the job, if it has one.
std::string usual_up(const JobRecord& job) {
  return api::Json::parse(job.parameters).value("up", std::string());
}

Answer list_exports(Exchange& x, const ApiParts& parts) {
  const JobRecord job = exported_job(x, parts);
  api::Json document = exports_document(address_of(job), parts.service.profiles());
  for (api::Json& one : document["parameters"])
    if (const std::string axis = usual_up(job); one["name"] == "up" && !axis.empty()) one["default"] = axis;
  const std::string up = std::string(kApiRoot) + "/jobs/" + job.id;
  document["links"] = api::to_json({{address_of(job), "self", "application/json", "These exports"},
                                    {up, "up", "application/json", "The job"}});
  return json_answer(200, document);
}

/// The wish in the query; inline is about the answer, not about the file.
ExportWish wish_of(const Exchange& x, const ApiParts& parts, const JobRecord& job) {
  ExportWish wish{x.captures.at(1), {}, job.id, job.input_name, "sha256:" + to_hex(job.input), {}};
  for (const auto& [name, value] : x.query)
    if (name != "inline") wish.query[name] = x.parameter(name).value();
  if (const std::string axis = usual_up(job); !axis.empty()) wish.query.try_emplace("up", axis);
  std::string link = absolute(parts, x.head, address_of(job) + "/" + percent_encode(wish.format));
  for (char before = '?'; const auto& [name, value] : wish.query) {
    link += before + percent_encode(name) + "=" + percent_encode(value);
    before = '&';
  }
  wish.link = link;
  return wish;
}

void check(const ExportWish& wish) {
  try {
    check_export(wish);
  } catch (const Error& e) {
    if (e.where() == "format")
      throw Refusal(ProblemType::kNoSuchOutput,
                    "there is no export " + wish.format.substr(0, 60) + ": " + e.summary(),
                    "see .../exports for all of them");
    api::Problem p =
        make_problem(ProblemType::kInvalidQueryParameter, e.summary(), e.fix(), e.where().substr(0, 60));
    p.pointer = p.where;
    throw Refusal(p);
  }
}

Answer get_export(Exchange& x, ApiParts& parts) {
  const bool shown = wants_inline(x);
  const JobRecord job = exported_job(x, parts);
  const ExportWish wish = wish_of(x, parts, job);
  check(wish);
  const CountedPlace place(parts.exports, parts.service.limits().exports, "files that are being made");
  const std::shared_ptr<const ExportedFile> file = parts.service.export_result(job, wish);
  return send_download(
      x, {base_name(job) + "-" + file->name, file->media_type, file->digest, file->bytes, std::nullopt,
          [file](std::uint64_t offset, std::uint64_t most) { return file->read(offset, most); }, shown});
}

}  // namespace

void add_export_routes(Router& router, ApiParts& parts) {
  const std::string exports = std::string(kApiRoot) + "/jobs/{jobID}/exports";
  router.add({"GET", exports, "read", [&parts](Exchange& x) { return list_exports(x, parts); }});
  router.add({"GET", exports + "/{format}", "read", [&parts](Exchange& x) { return get_export(x, parts); }});
}

}  // namespace sheetform::server
