#include "server/store/job_rows.h"

namespace sheetform::server {

const char* const kJobColumns =
    "seq, id, principal, process, version, state, attempt, crashes, errors, interruptions, rev, ev, "
    "progress, stage, "
    "message, problem, report, params, reused_from, input, input_name, input_info, tag, created, updated, "
    "expires, "
    "run_after, started, finished";

std::optional<std::int64_t> optional_integer(const SQLite::Column& column) {
  if (column.isNull()) return std::nullopt;
  return column.getInt64();
}

JobRecord read_job(const SQLite::Statement& row) {
  JobRecord j;
  int i = 0;
  const auto column = [&] { return const_cast<SQLite::Statement&>(row).getColumn(i++); };
  j.seq = column().getInt64();
  j.id = column().getString();
  j.principal = column().getInt64();
  j.process = column().getString();
  j.version = column().getString();
  j.state = api::job_state_from(column().getString()).value_or(JobState::kFailed);
  j.attempt = column().getInt();
  j.crashes = column().getInt();
  j.errors = column().getInt();
  j.interruptions = column().getInt();
  j.revision = column().getInt64();
  j.last_event = column().getInt64();
  j.progress = column().getInt();
  j.stage = column().getString();
  j.message = column().getString();
  j.problem = column().getString();
  j.report = column().getString();
  j.parameters = column().getString();
  j.reused_from = column().getString();
  j.input = blob_of(column());
  j.input_name = column().getString();
  j.input_info = column().getString();
  j.tag = column().getString();
  j.created = column().getInt64();
  j.updated = column().getInt64();
  j.expires = column().getInt64();
  j.run_after = column().getInt64();
  j.started = optional_integer(column());
  j.finished = optional_integer(column());
  return j;
}

std::optional<JobRecord> find_job(SQLite::Database& db, const std::string& id) {
  SQLite::Statement select(db, std::string("SELECT ") + kJobColumns + " FROM job WHERE id = ?");
  select.bind(1, id);
  if (!select.executeStep()) return std::nullopt;
  return read_job(select);
}

void write_event(SQLite::Database& db, std::int64_t seq, Microseconds at) {
  SQLite::Statement count(db, "UPDATE job SET ev = ev + 1, rev = rev + 1, updated = ? WHERE seq = ?");
  count.bind(1, at);
  count.bind(2, seq);
  count.exec();
  SQLite::Statement insert(db,
                           "INSERT INTO event(job, n, at, state, progress, stage, message) "
                           "SELECT seq, ev, ?, state, progress, stage, message FROM job WHERE seq = ?");
  insert.bind(1, at);
  insert.bind(2, seq);
  insert.exec();
}

}  // namespace sheetform::server
