// Between rows of the metadata file and records. Internal to store/.
#pragma once
#include "server/store/job_record.h"
#include "server/store/sqlite.h"

namespace sheetform::server {

/// The columns that read_job expects, in its order.
extern const char* const kJobColumns;
/// Reads the columns from `first` on.
JobRecord read_job(const SQLite::Statement& row);
std::optional<JobRecord> find_job(SQLite::Database& db, const std::string& id);
/// A moment of the job becomes its next event, from what the row says now.
void write_event(SQLite::Database& db, std::int64_t seq, Microseconds at);
std::optional<std::int64_t> optional_integer(const SQLite::Column& column);

}  // namespace sheetform::server
