#include "server/jobs/exporter.h"

#include <sys/mman.h>
#include <sys/stat.h>

#include <algorithm>
#include <csignal>
#include <system_error>
#include <thread>

#include "server/base/digest.h"
#include "server/base/log.h"
#include "server/jobs/refusal.h"
#include "server/mapping/errors.h"

namespace sheetform::server {
namespace {

using api::ProblemType;

constexpr std::uint64_t kPiece = 1 << 20;
constexpr std::uint64_t kRememberedBytes = std::uint64_t{64} << 20;
constexpr std::size_t kRememberedFiles = 64;          // each holds a descriptor
constexpr auto kPatience = std::chrono::seconds(30);  // for a processor

Descriptor memory_file(const char* name) {
  Descriptor file(::memfd_create(name, MFD_CLOEXEC));
  if (!file.valid()) throw std::system_error(errno, std::generic_category(), "file in memory");
  return file;
}

void append(int fd, std::string_view bytes) {
  if (!write_whole(fd, bytes)) throw std::system_error(errno, std::generic_category(), "file in memory");
}

void append_blob(int fd, const BlobStore& blobs, const StoredOutput& output) {
  const auto bytes = static_cast<std::uint64_t>(output.bytes);
  for (std::uint64_t at = 0; at < bytes;) {
    const std::string piece = blobs.read(output.digest, at, std::min(kPiece, bytes - at));
    if (piece.empty()) throw std::runtime_error("a file of the result is incomplete");
    append(fd, piece);
    at += piece.size();
  }
}

std::string digest_of(const ExportedFile& file) {
  Sha256 hash;
  for (std::uint64_t at = 0; at < file.bytes;) {
    const std::string piece = file.read(at, kPiece);
    if (piece.empty()) throw std::runtime_error("the exported file is incomplete");
    hash.add(piece);
    at += piece.size();
  }
  return hash.finish();
}

const StoredOutput& named(const std::vector<StoredOutput>& outputs, const char* name) {
  for (const StoredOutput& o : outputs)
    if (o.name == name) return o;
  throw Refusal(ProblemType::kNoSuchOutput,
                std::string("the result has no file ") + name + ", which exports are made from",
                "run the job again");
}

[[noreturn]] void refuse_after(const ChildReport& report, const std::optional<api::Problem>& told,
                               const ServiceLimits& limits) {
  if (told && told->type == ProblemType::kInvalidParameter) {
    api::Problem p = *told;
    p.type = ProblemType::kInvalidQueryParameter;
    if (!p.where.empty()) p.pointer = p.where;
    throw Refusal(p);
  }
  log_error("an export failed", {{"signal", report.signal},
                                 {"exit", report.exit_status},
                                 {"reason", told ? told->detail : report.log}});
  const char* fix = "ask for fewer copies, parts or angles, or for another format";
  if (report.ending == ChildEnding::kTimedOut || report.ending == ChildEnding::kStalled ||
      report.signal == SIGXCPU)
    throw Refusal(ProblemType::kTimeLimit,
                  "the file took longer than " + std::to_string(limits.export_seconds) + " s", fix);
  if (report.exit_status == kExitMemory || report.exit_status == kExitIo)
    throw Refusal(ProblemType::kMemoryLimit, "the file grew too large", fix);
  if (report.ending == ChildEnding::kSignalled)
    throw Refusal(ProblemType::kWorkerCrashed, "the program that makes the file died", fix);
  throw Refusal(ProblemType::kAlgorithmFailed,
                told ? told->detail : "the file could not be made of this result", fix);
}

}  // namespace

std::string ExportedFile::read(std::uint64_t offset, std::uint64_t most) const {
  std::string piece(std::min(most, kPiece), '\0');
  const ssize_t got = ::pread(content.get(), piece.data(), piece.size(), static_cast<off_t>(offset));
  piece.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  return piece;
}

Exporter::Exporter(const ServiceLimits& limits, const BlobStore& blobs, bool sandbox, std::string program)
    : limits_(limits),
      blobs_(blobs),
      sandbox_(sandbox),
      program_(std::move(program)),
      places_(std::max(1, static_cast<int>(std::thread::hardware_concurrency()))) {}

std::shared_ptr<const ExportedFile> Exporter::make(const std::vector<StoredOutput>& outputs,
                                                   const api::Json& wish) {
  const StoredOutput &obj = named(outputs, "ruled.obj"), &json = named(outputs, "layout.json");
  const std::string key = sha256(obj.digest + json.digest + api::dump(wish));
  if (std::shared_ptr<const ExportedFile> known = recall(key)) return known;
  if (!places_.try_acquire_for(kPatience))
    throw Refusal(ProblemType::kTooManyRequests, "too many files are being made", "try again in a minute");
  struct Place {
    std::counting_semaphore<>& places;
    ~Place() { places.release(); }
  } const place{places_};
  std::shared_ptr<const ExportedFile> made = run(obj, json, wish);
  remember(key, made);
  return made;
}

std::shared_ptr<const ExportedFile> Exporter::run(const StoredOutput& obj, const StoredOutput& json,
                                                  api::Json wish) {
  const Descriptor input = memory_file("result");
  append_blob(input.get(), blobs_, obj);
  append_blob(input.get(), blobs_, json);
  auto file = std::make_shared<ExportedFile>();
  file->content = memory_file("export");
  std::optional<api::Problem> told;
  std::optional<WorkerFile> exported;
  ChildTask task;
  task.program = program_;
  task.input = input.get();
  task.folder = file->content.get();
  wish["objBytes"] = obj.bytes;
  task.request.mode = WorkerMode::kExport;
  task.request.parameters = std::move(wish);
  task.request.memory = limits_.job_memory;
  task.request.file_bytes = limits_.result_bytes;
  task.request.cpu_seconds = limits_.export_seconds;
  task.request.sandbox = sandbox_;
  task.wall = task.stall = std::chrono::seconds(limits_.export_seconds);
  task.on_message = [&](const WorkerMessage& m) {
    if (m.problem) told = m.problem;
    if (m.exported) exported = m.exported;
  };
  const ChildReport report = run_child(task);
  if (report.ending != ChildEnding::kExited || report.exit_status != kExitOk || !exported)
    refuse_after(report, told, limits_);
  struct stat status {};
  if (::fstat(file->content.get(), &status) == 0) file->bytes = static_cast<std::uint64_t>(status.st_size);
  file->name = exported->name;
  file->media_type = exported->media_type;
  file->digest = digest_of(*file);
  return file;
}

std::shared_ptr<const ExportedFile> Exporter::recall(const std::string& key) {
  const std::lock_guard lock(mutex_);
  const auto found =
      std::find_if(recent_.begin(), recent_.end(), [&](const auto& e) { return e.first == key; });
  if (found == recent_.end()) return nullptr;
  recent_.splice(recent_.begin(), recent_, found);
  return found->second;
}

void Exporter::remember(const std::string& key, const std::shared_ptr<const ExportedFile>& file) {
  const std::lock_guard lock(mutex_);
  recent_.emplace_front(key, file);
  if (recent_.size() > kRememberedFiles) recent_.pop_back();
  std::uint64_t bytes = 0;
  for (auto at = recent_.begin(); at != recent_.end();) {
    bytes += at->second->bytes;
    at = bytes > kRememberedBytes ? recent_.erase(at) : std::next(at);
  }
}

}  // namespace sheetform::server
