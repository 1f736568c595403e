// Results: the list of files, single files with ranges, all of them as a zip; the uploaded mesh.
#include <unistd.h>

#include <algorithm>

#include "server/base/digest.h"
#include "server/base/identity.h"
#include "server/base/input_bundle.h"
#include "server/http/api_parts.h"
#include "server/http/download.h"
#include "server/http/zip_writer.h"
#include "sheetform_api/process.h"

namespace sheetform::server {
namespace {

using api::ProblemType;

[[noreturn]] void refuse_name(const std::string& name, const std::vector<StoredOutput>& outputs) {
  std::string names;
  for (const StoredOutput& o : outputs) names += (names.empty() ? "" : ", ") + o.name;
  throw Refusal(ProblemType::kNoSuchOutput, "the result has no file " + name.substr(0, 60),
                "there are " + names + "; other formats are made under .../exports");
}

/// The outputs that `outputs=a,b` names, all without it.
std::vector<StoredOutput> wanted_outputs(const Exchange& x, const ApiParts& parts, const JobRecord& job) {
  std::vector<StoredOutput> all = parts.service.store().outputs(job.seq);
  const std::optional<std::string> names = x.parameter("outputs");
  if (!names) return all;
  std::vector<StoredOutput> some;
  for (std::size_t at = 0; at <= names->size();) {
    const std::size_t end = std::min(names->find(',', at), names->size());
    const std::string name = names->substr(at, end - at);
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const StoredOutput& o) { return o.name == name; });
    if (found == all.end()) refuse_name(name, all);
    some.push_back(*found);
    at = end + 1;
  }
  return some;
}

std::function<std::string(std::uint64_t, std::uint64_t)> blob_reader(const ApiParts& parts,
                                                                     const StoredOutput& o) {
  return [&blobs = parts.service.blobs(), digest = o.digest](std::uint64_t offset, std::uint64_t most) {
    return blobs.read(digest, offset, most);
  };
}

std::uint32_t crc_of(const StoredOutput& o,
                     const std::function<std::string(std::uint64_t, std::uint64_t)>& read) {
  constexpr std::uint64_t kPiece = 1 << 20;
  std::uint32_t crc = 0;
  const auto bytes = static_cast<std::uint64_t>(o.bytes);
  for (std::uint64_t at = 0; at < bytes;) {
    const std::string piece = read(at, std::min(kPiece, bytes - at));
    if (piece.empty()) throw std::runtime_error("a file of the result is incomplete");
    crc = crc32_of(piece, crc);
    at += piece.size();
  }
  return crc;
}

/// Where the digest names the content, and is not that of the bytes that are sent.
void forget_digest(Answer& answer) {
  std::erase_if(answer.headers, [](const auto& h) { return h.first == "Repr-Digest"; });
}

Answer send_zip(const Exchange& x, const ApiParts& parts, const JobRecord& job) {
  std::vector<ZipMember> members;
  Sha256 digest;
  for (const StoredOutput& o : wanted_outputs(x, parts, job)) {
    const auto read = blob_reader(parts, o);
    members.push_back({o.name, static_cast<std::uint64_t>(o.bytes), crc_of(o, read), read});
    digest.add(o.name + "\n" + o.digest);
  }
  const std::int64_t modified = job.finished.value_or(0) / kSecond;
  const auto archive = std::make_shared<ZipArchive>(std::move(members), modified);
  Download d{base_name(job) + "-sheets.zip",
             "application/zip",
             digest.finish(),
             archive->length(),
             modified,
             [archive](std::uint64_t offset, std::uint64_t most) { return archive->read(offset, most); },
             false};
  Answer answer = send_download(x, d);
  forget_digest(answer);
  return answer;
}

bool wants_zip(const Exchange& x) {
  const std::optional<std::string> f = x.parameter("f");
  return f ? *f == "zip" : x.head.field("accept").find("application/zip") != std::string::npos;
}

Answer list_results(Exchange& x, const ApiParts& parts) {
  const JobRecord job = successful_job(x, parts);
  if (wants_zip(x)) return send_zip(x, parts, job);
  std::vector<api::ResultFile> files;
  for (const StoredOutput& o : wanted_outputs(x, parts, job))
    files.push_back({o.name, o.media_type, api::output_title(o.name), o.bytes, to_hex(o.digest)});
  const std::string self = std::string(kApiRoot) + "/jobs/" + job.id;
  return json_answer(200, api::results_document(files, self))
      .with("Link", "<" + self + "/exports>; rel=\"exports\"; type=\"application/json\"");
}

Answer get_result(Exchange& x, const ApiParts& parts) {
  const JobRecord job = successful_job(x, parts);
  const std::vector<StoredOutput> outputs = parts.service.store().outputs(job.seq);
  for (const StoredOutput& o : outputs) {
    if (o.name != x.captures.at(1)) continue;
    const bool shown = wants_inline(x);
    return send_download(x, {o.name, o.media_type, o.digest, static_cast<std::uint64_t>(o.bytes),
                             job.finished.value_or(0) / kSecond, blob_reader(parts, o), shown});
  }
  refuse_name(x.captures[1], outputs);
}

std::string read_at(int fd, std::uint64_t offset, std::uint64_t most) {
  std::string bytes(std::min<std::uint64_t>(most, 1 << 18), '\0');
  const ssize_t got = ::pread(fd, bytes.data(), bytes.size(), static_cast<off_t>(offset));
  bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  return bytes;
}

/// The input of a job as it is stored: the mesh, and what came with it.
struct StoredInput {
  std::shared_ptr<Descriptor> file;
  std::uint64_t bytes = 0, mesh_bytes = 0;
};

StoredInput stored_input(const ApiParts& parts, const JobRecord& job) {
  StoredInput input{std::make_shared<Descriptor>(parts.service.open_input(job.input))};
  const std::int64_t bytes = parts.service.store().input_bytes(job.input);
  if (!input.file->valid() || bytes < 0)
    throw Refusal(ProblemType::kNoSuchOutput, "the uploaded mesh is not kept any more");
  input.bytes = static_cast<std::uint64_t>(bytes);
  const std::uint64_t tail = std::min<std::uint64_t>(input.bytes, kTailBytes);
  input.mesh_bytes = mesh_bytes_of(input.bytes, read_at(input.file->get(), input.bytes - tail, tail));
  return input;
}

Answer get_input(Exchange& x, const ApiParts& parts) {
  const JobRecord job = parts.service.job(x.captures.at(0), x.visible());
  const StoredInput input = stored_input(parts, job);
  Answer answer =
      send_download(x, {job.input_name.empty() ? "mesh" : job.input_name, "application/octet-stream",
                        job.input, input.mesh_bytes, job.created / kSecond,
                        [file = input.file](std::uint64_t offset, std::uint64_t most) {
                          return read_at(file->get(), offset, most);
                        },
                        false});
  if (input.mesh_bytes != input.bytes) forget_digest(answer);  // it is that of all that came
  return answer;
}

/// The strokes that came with the mesh, byte for byte.
Answer get_guides(Exchange& x, const ApiParts& parts) {
  const StoredInput input = stored_input(parts, parts.service.job(x.captures.at(0), x.visible()));
  std::string rest;
  while (input.mesh_bytes + rest.size() < input.bytes) {
    const std::uint64_t at = input.mesh_bytes + rest.size();
    const std::string piece = read_at(input.file->get(), at, input.bytes - at);
    if (piece.empty()) throw std::runtime_error("the stored input is incomplete");
    rest += piece;
  }
  const InputBundle bundle = split_after_mesh(rest);
  if (bundle.guides.empty())
    throw Refusal(ProblemType::kNoSuchOutput, "nothing was drawn on the mesh of this job");
  return text_answer(200, "application/json", std::string(bundle.guides));
}

}  // namespace

JobRecord successful_job(const Exchange& x, const ApiParts& parts) {
  JobRecord job = parts.service.job(x.captures.at(0), x.visible());
  if (job.state == JobState::kSuccessful) return job;
  if (job.state == JobState::kFailed && !job.problem.empty()) {
    api::Problem problem = api::problem_from_json(api::Json::parse(job.problem));
    problem.instance = std::string(kApiRoot) + "/jobs/" + job.id;
    throw Refusal(problem);
  }
  throw Refusal(
      ProblemType::kResultNotReady, std::string("the job is ") + api::to_string(job.state),
      api::is_terminal(job.state) ? "run it again: POST .../retry" : "wait until its status is successful");
}

std::string base_name(const JobRecord& job) {
  const std::string name = job.input_name.substr(0, job.input_name.rfind('.'));
  return name.empty() ? "sheetform" : name;
}

void add_result_routes(Router& router, ApiParts& parts) {
  const std::string job = std::string(kApiRoot) + "/jobs/{jobID}";
  router.add({"GET", job + "/results", "read", [&parts](Exchange& x) { return list_results(x, parts); }});
  router.add(
      {"GET", job + "/results/{output}", "read", [&parts](Exchange& x) { return get_result(x, parts); }});
  router.add({"GET", job + "/input", "read", [&parts](Exchange& x) { return get_input(x, parts); }});
  router.add({"GET", job + "/guides", "read", [&parts](Exchange& x) { return get_guides(x, parts); }});
}

}  // namespace sheetform::server
