// What users do to jobs, and who the users are.
#include "server/store/job_store_state.h"

namespace sheetform::server {
namespace {

Principal read_principal(SQLite::Statement& row) {
  Principal p;
  p.id = row.getColumn(0).getInt64();
  p.name = row.getColumn(1).getString();
  p.token_id = row.getColumn(2).getString();
  p.token_hash = blob_of(row.getColumn(3));
  p.scopes = row.getColumn(4).getString();
  p.created = row.getColumn(5).getInt64();
  p.disabled = row.getColumn(6).getInt() != 0;
  return p;
}

constexpr const char* kPrincipal =
    "SELECT id, name, token_id, token_hash, scopes, created, disabled FROM principal";

}  // namespace

bool Principal::may(const std::string& scope) const {
  return (" " + scopes + " ").find(" " + scope + " ") != std::string::npos;
}

DismissOutcome JobStore::dismiss(const std::string& id) {
  return state_->file.write([&](SQLite::Database& db) {
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
                             "finished = ? WHERE seq = ? AND state IN ('accepted', 'running')");
    update.bind(1, now_us());
    update.bind(2, job->seq);
    update.exec();
    write_event(db, job->seq, now_us());
    return DismissOutcome::kDismissed;
  });
}

bool JobStore::retry(const std::string& id) {
  return state_->file.write([&](SQLite::Database& db) {
    const std::optional<JobRecord> job = find_job(db, id);
    if (!job) return false;
    SQLite::Statement update(
        db,
        "UPDATE job SET state = 'accepted', run_after = ?1, crashes = 0, errors = 0, interruptions = 0, "
        "progress = 0, stage = '', message = 'waiting', problem = NULL, started = NULL, finished = NULL "
        "WHERE seq = ?2 AND state IN ('failed', 'dismissed')");
    update.bind(1, now_us());
    update.bind(2, job->seq);
    if (update.exec() != 1) return false;
    write_event(db, job->seq, now_us());
    return true;
  });
}

void JobStore::add_principal(const Principal& p) {
  state_->file.write([&](SQLite::Database& db) {
    SQLite::Statement insert(
        db, "INSERT INTO principal(name, token_id, token_hash, scopes, created) VALUES(?, ?, ?, ?, ?)");
    insert.bind(1, p.name);
    insert.bind(2, p.token_id);
    bind_blob(insert, 3, p.token_hash);
    insert.bind(4, p.scopes);
    insert.bind(5, p.created);
    insert.exec();
  });
}

bool JobStore::disable_principal(const std::string& name) {
  return state_->file.write([&](SQLite::Database& db) {
    SQLite::Statement update(db, "UPDATE principal SET disabled = 1 WHERE name = ? AND id != 0");
    update.bind(1, name);
    return update.exec() == 1;
  });
}

std::optional<Principal> JobStore::find_principal(const std::string& token_id) const {
  return state_->file.read([&](SQLite::Database& db) -> std::optional<Principal> {
    SQLite::Statement select(db, std::string(kPrincipal) + " WHERE token_id = ? AND disabled = 0");
    select.bind(1, token_id);
    if (!select.executeStep()) return std::nullopt;
    return read_principal(select);
  });
}

std::vector<Principal> JobStore::principals() const {
  return state_->file.read([](SQLite::Database& db) {
    SQLite::Statement select(db, std::string(kPrincipal) + " WHERE id != 0 ORDER BY id");
    std::vector<Principal> list;
    while (select.executeStep()) list.push_back(read_principal(select));
    return list;
  });
}

}  // namespace sheetform::server
