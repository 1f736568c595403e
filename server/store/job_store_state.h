// The open metadata file behind JobStore. Internal to store/.
#pragma once
#include <set>

#include "server/store/job_rows.h"
#include "server/store/job_store.h"
#include "server/store/migrations.h"
#include "server/store/waiting_line.h"

namespace sheetform::server {

struct JobStore::State {
  explicit State(const std::filesystem::path& path);
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  /// Jobs whose rows were changed since the line was told; belongs to whoever writes.
  std::set<std::int64_t> touched;
  WaitingLine line;
  DatabaseFile file;

 private:
  void begin_line(SQLite::Database& db);
  void follow_line(SQLite::Database& db);
};

}  // namespace sheetform::server
