// Taking jobs in: input, job, first event and idempotency key in one transaction.
#include "server/store/job_store_state.h"

namespace sheetform::server {
namespace {

void insert_input(SQLite::Database& db, const NewJob& job) {
  SQLite::Statement insert(db,
                           "INSERT INTO blob(digest, bytes, store, created) VALUES(?, ?, 'file', ?) "
                           "ON CONFLICT DO NOTHING");
  bind_blob(insert, 1, job.input);
  insert.bind(2, job.input_bytes);
  insert.bind(3, job.created);
  insert.exec();
}

std::int64_t insert_job(SQLite::Database& db, const NewJob& job) {
  SQLite::Statement insert(
      db,
      "INSERT INTO job(id, principal, process, version, state, run_after, params, reuse_key, input, "
      "input_name, "
      "input_info, tag, created, updated, expires, message) "
      "VALUES(?1, ?2, ?3, ?4, 'accepted', ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?5, ?5, ?12, 'waiting')");
  insert.bind(1, job.id);
  insert.bind(2, job.principal);
  insert.bind(3, job.process);
  insert.bind(4, job.version);
  insert.bind(5, job.created);
  insert.bind(6, job.parameters);
  bind_blob(insert, 7, job.reuse_key);
  bind_blob(insert, 8, job.input);
  insert.bind(9, job.input_name);
  insert.bind(10, job.input_info);
  insert.bind(11, job.tag);
  insert.bind(12, job.expires);
  insert.exec();
  return db.getLastInsertRowid();
}

void insert_idempotency(SQLite::Database& db, const NewJob& job) {
  if (job.idempotency_key.empty()) return;
  SQLite::Statement insert(db,
                           "INSERT OR REPLACE INTO idempotency(principal, route, key, fingerprint, job, at) "
                           "VALUES(?, ?, ?, ?, ?, ?)");
  insert.bind(1, job.principal);
  insert.bind(2, job.route);
  insert.bind(3, job.idempotency_key);
  bind_blob(insert, 4, job.fingerprint);
  insert.bind(5, job.id);
  insert.bind(6, job.created);
  insert.exec();
}

std::int64_t insert_all(SQLite::Database& db, const NewJob& job) {
  insert_input(db, job);
  const std::int64_t seq = insert_job(db, job);
  write_event(db, seq, job.created);
  insert_idempotency(db, job);
  return seq;
}

/// The outputs and the report of `source` become those of `seq`; false when it is not successful any more.
bool copy_result(SQLite::Database& db, std::int64_t seq, const std::string& source, const ResultPart& part,
                 Microseconds now) {
  SQLite::Statement update(
      db,
      "UPDATE job SET state = 'successful', progress = 100, message = 'result of an earlier job', started = "
      "?1, "
      "finished = ?1, reused_from = ?2, report = coalesce(nullif(?4, ''), s.report) FROM (SELECT report FROM "
      "job "
      "WHERE id = ?2 AND state = 'successful') AS s WHERE seq = ?3");
  update.bind(1, now);
  update.bind(2, source);
  update.bind(3, seq);
  update.bind(4, part.report);
  if (update.exec() != 1) return false;
  SQLite::Statement copy(
      db,
      "INSERT INTO output(job, position, name, media, digest) SELECT ?1, position, substr(name, 1 + "
      "length(?3)), media, digest FROM output WHERE job = (SELECT seq FROM job WHERE id = ?2) AND "
      "substr(name, 1, length(?3)) = ?3");
  copy.bind(1, seq);
  copy.bind(2, source);
  copy.bind(3, part.prefix);
  return copy.exec() > 0;
}

}  // namespace

JobRecord JobStore::accept(const NewJob& job) {
  return state_->file.write_together([&](SQLite::Database& db) {
    insert_all(db, job);
    return *find_job(db, job.id);
  });
}

std::optional<JobRecord> JobStore::accept_reused(const NewJob& job, const std::string& source,
                                                 const ResultPart& part) {
  struct SourceGone {};
  try {
    return state_->file.write_together([&](SQLite::Database& db) -> std::optional<JobRecord> {
      const std::int64_t seq = insert_all(db, job);
      if (!copy_result(db, seq, source, part, job.created)) throw SourceGone();
      write_event(db, seq, job.created);
      return find_job(db, job.id);
    });
  } catch (const SourceGone&) {
    return std::nullopt;  // rolled back; the caller accepts the job as a new one
  }
}

std::optional<IdempotencyRecord> JobStore::find_idempotency(std::int64_t principal, const std::string& route,
                                                            const std::string& key) const {
  return state_->file.read([&](SQLite::Database& db) -> std::optional<IdempotencyRecord> {
    SQLite::Statement select(
        db, "SELECT fingerprint, job FROM idempotency WHERE principal = ? AND route = ? AND key = ?");
    select.bind(1, principal);
    select.bind(2, route);
    select.bind(3, key);
    if (!select.executeStep()) return std::nullopt;
    return IdempotencyRecord{blob_of(select.getColumn(0)), select.getColumn(1).getString()};
  });
}

std::optional<JobRecord> JobStore::find_reusable(std::int64_t principal, const std::string& reuse_key) const {
  return state_->file.read([&](SQLite::Database& db) -> std::optional<JobRecord> {
    SQLite::Statement select(db,
                             std::string("SELECT ") + kJobColumns +
                                 " FROM job WHERE reuse_key = ? AND state = 'successful' AND principal = ? "
                                 "ORDER BY seq DESC LIMIT 1");
    bind_blob(select, 1, reuse_key);
    select.bind(2, principal);
    if (!select.executeStep()) return std::nullopt;
    return read_job(select);
  });
}

}  // namespace sheetform::server
