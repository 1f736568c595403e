// What users do to jobs.
#include "server/store/job_store_state.h"

namespace sheetform::server {

DismissOutcome JobStore::dismiss(const std::string& id, Microseconds expires) {
  return state_->file.write_together([&](SQLite::Database& db) {
    const std::optional<JobRecord> job = find_job(db, id);
    if (!job) return DismissOutcome::kNoSuchJob;
    if (api::is_terminal(job->state)) {
      SQLite::Statement remove(db, "DELETE FROM job WHERE seq = ?");
      remove.bind(1, job->seq);
      remove.exec();
      return DismissOutcome::kRemoved;
    }
    SQLite::Statement update(db,
                             "UPDATE job SET state = 'dismissed', token = NULL, message = 'dismissed', "
                             "finished = ?, expires = ? WHERE seq = ? AND state IN ('accepted', 'running')");
    update.bind(1, now_us());
    update.bind(2, expires);
    update.bind(3, job->seq);
    update.exec();
    write_event(db, job->seq, now_us());
    return DismissOutcome::kDismissed;
  });
}

bool JobStore::retry(const std::string& id, Microseconds expires) {
  return state_->file.write_together([&](SQLite::Database& db) {
    const std::optional<JobRecord> job = find_job(db, id);
    if (!job) return false;
    SQLite::Statement update(
        db,
        "UPDATE job SET state = 'accepted', run_after = ?1, crashes = 0, errors = 0, interruptions = 0, "
        "progress = 0, stage = '', message = 'waiting', problem = NULL, started = NULL, finished = NULL, "
        "expires = ?3 "
        "WHERE seq = ?2 AND state IN ('failed', 'dismissed')");
    update.bind(1, now_us());
    update.bind(2, job->seq);
    update.bind(3, expires);
    if (update.exec() != 1) return false;
    write_event(db, job->seq, now_us());
    return true;
  });
}

std::int64_t JobStore::principal_id(const std::string& name) {
  return state_->file.write_together([&](SQLite::Database& db) {
    SQLite::Statement insert(db, "INSERT INTO principal(name, created) VALUES(?, ?) ON CONFLICT DO NOTHING");
    insert.bind(1, name);
    insert.bind(2, now_us());
    insert.exec();
    SQLite::Statement select(db, "SELECT id FROM principal WHERE name = ?");
    select.bind(1, name);
    select.executeStep();
    return select.getColumn(0).getInt64();
  });
}

}  // namespace sheetform::server
