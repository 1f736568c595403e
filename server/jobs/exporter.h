// Files made from a stored result on request, without computing it again. In a child process, as with
// everything that works on what strangers sent; handed back in memory, so that a full disk is no obstacle.
#pragma once
#include <list>
#include <memory>
#include <mutex>
#include <semaphore>

#include "server/jobs/child_process.h"
#include "server/jobs/service_limits.h"
#include "server/store/blob_store.h"
#include "server/store/job_record.h"

namespace sheetform::server {

struct ExportedFile {
  std::string name, media_type;
  std::string digest;  ///< SHA-256 of the content
  std::uint64_t bytes = 0;
  Descriptor content;  ///< of a file in memory

  /// Up to `most` bytes from `offset`.
  std::string read(std::uint64_t offset, std::uint64_t most) const;
};

class Exporter {
 public:
  Exporter(const ServiceLimits& limits, const BlobStore& blobs, bool sandbox, std::string program);
  /// wish: server/mapping/exports.h, as JSON. outputs: the job's files. The latest files are remembered: the
  /// same wish gives the same file. Throws Refusal: kInvalidQueryParameter for what turns out to be wrong
  /// only now (a part that does not fit the sheet), kNoSuchOutput for a result without its two main files.
  std::shared_ptr<const ExportedFile> make(const std::vector<StoredOutput>& outputs, const api::Json& wish);

 private:
  std::shared_ptr<const ExportedFile> run(const StoredOutput& obj, const StoredOutput& json, api::Json wish);
  std::shared_ptr<const ExportedFile> recall(const std::string& key);
  void remember(const std::string& key, const std::shared_ptr<const ExportedFile>& file);

  const ServiceLimits& limits_;
  const BlobStore& blobs_;
  const bool sandbox_;
  const std::string program_;
  std::counting_semaphore<> places_;
  std::mutex mutex_;
  std::list<std::pair<std::string, std::shared_ptr<const ExportedFile>>> recent_;  ///< newest first
};

}  // namespace sheetform::server
