// The open metadata file behind JobStore. Internal to store/.
#pragma once
#include "server/store/job_rows.h"
#include "server/store/job_store.h"
#include "server/store/migrations.h"

namespace sheetform::server {

struct JobStore::State {
  explicit State(const std::filesystem::path& path) : file(path, "") { migrate_metadata(file); }
  DatabaseFile file;
};

}  // namespace sheetform::server
