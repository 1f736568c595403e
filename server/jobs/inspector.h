// Looks at an upload before it becomes a job: what is it, can it be read at all. In a child process, as with
// all bytes of strangers.
#pragma once
#include <condition_variable>
#include <mutex>

#include "server/jobs/child_process.h"
#include "server/jobs/service_limits.h"

namespace sheetform::server {

struct Inspection {
  api::Json mesh;                       ///< as api::to_json(MeshInfo), without the digest; null when refused
  std::optional<api::Problem> problem;  ///< set when refused
};

class Inspector {
 public:
  Inspector(const ServiceLimits& limits, int at_once, bool sandbox, std::string program, Nursery* nursery)
      : limits_(limits), free_(at_once), sandbox_(sandbox), program_(std::move(program)), nursery_(nursery) {}
  /// fd: the mesh, any offset. Waits while as many as allowed run already.
  Inspection inspect(int fd, const std::string& name, const api::Json& parameters);

 private:
  const ServiceLimits& limits_;
  std::mutex mutex_;
  std::condition_variable ended_;
  int free_;
  bool sandbox_;
  std::string program_;
  Nursery* nursery_;
};

}  // namespace sheetform::server
