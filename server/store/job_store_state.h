// The open metadata file behind JobStore. Internal to store/.
#pragma once
#include <mutex>

#include "server/store/job_rows.h"
#include "server/store/job_store.h"
#include "server/store/migrations.h"

namespace sheetform::server {

struct JobStore::State {
  explicit State(const std::filesystem::path& path) : file(path, "") { migrate_metadata(file); }
  DatabaseFile file;

  /// The waiting jobs in their order (run_after, seq), as they were after `changes` changes: a page of a long
  /// queue asks for a hundred places, and each would count the whole queue.
  struct QueueOrder {
    std::uint64_t changes = 0;
    std::vector<std::pair<Microseconds, std::int64_t>> jobs;
  };
  std::mutex queue_mutex;
  std::optional<QueueOrder> queue;
};

}  // namespace sheetform::server
