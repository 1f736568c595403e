#include "server/store/job_store.h"

#include <sqlite3.h>

#include "server/base/log.h"
#include "server/store/job_store_state.h"

namespace sheetform::server {

namespace {

/// SQLite calls it for every row that is written, by whichever statement.
void note_row(void* touched, int, const char*, const char* table, sqlite3_int64 row) {
  if (std::string_view(table) == "job") static_cast<std::set<std::int64_t>*>(touched)->insert(row);
}

}  // namespace

JobStore::State::State(const std::filesystem::path& path) : file(path, "") {
  migrate_metadata(file);
  file.follow_changes([this](SQLite::Database& db) { begin_line(db); },
                      [this](SQLite::Database& db) { follow_line(db); });
}

void JobStore::State::begin_line(SQLite::Database& db) {
  sqlite3_update_hook(db.getHandle(), note_row, &touched);
  SQLite::Statement select(
      db, "SELECT seq, run_after, principal FROM job WHERE state = 'accepted' ORDER BY run_after, seq");
  while (select.executeStep())
    line.put(select.getColumn(0).getInt64(),
             WaitingLine::Place{select.getColumn(1).getInt64(), select.getColumn(2).getInt64()});
}

/// A row that cannot be read now is looked at again after the next change. So are rows of a change that was
/// rolled back: what counts is what the row says.
void JobStore::State::follow_line(SQLite::Database& db) {
  try {
    while (!touched.empty()) {
      const std::int64_t seq = *touched.begin();
      SQLite::Statement select(db,
                               "SELECT run_after, principal FROM job WHERE seq = ? AND state = 'accepted'");
      select.bind(1, seq);
      std::optional<WaitingLine::Place> place;
      if (select.executeStep()) place = {select.getColumn(0).getInt64(), select.getColumn(1).getInt64()};
      line.put(seq, place);
      touched.erase(seq);
    }
  } catch (const SQLite::Exception& e) {
    log_warning("the line of waiting jobs is not up to date", {{"reason", e.what()}});
  }
}

JobStore::JobStore(const std::filesystem::path& path) : state_(std::make_unique<State>(path)) {}
JobStore::~JobStore() = default;

std::vector<RemovedJob> JobStore::remove_expired(Microseconds now, int limit) {
  return state_->file.write([&](SQLite::Database& db) {
    SQLite::Statement remove(db,
                             "DELETE FROM job WHERE seq IN (SELECT seq FROM job WHERE expires <= ? AND "
                             "state NOT IN ('accepted', 'running') LIMIT ?) RETURNING id, principal");
    remove.bind(1, now);
    remove.bind(2, limit);
    std::vector<RemovedJob> jobs;
    while (remove.executeStep())
      jobs.push_back({remove.getColumn(0).getString(), remove.getColumn(1).getInt64()});
    return jobs;
  });
}

std::vector<std::string> JobStore::oldest_finished(int limit) const {
  return state_->file.read([&](SQLite::Database& db) {
    SQLite::Statement select(
        db,
        "SELECT id FROM job WHERE state NOT IN ('accepted', 'running') ORDER BY finished, seq "
        "LIMIT ?");
    select.bind(1, limit);
    std::vector<std::string> ids;
    while (select.executeStep()) ids.push_back(select.getColumn(0).getString());
    return ids;
  });
}

std::optional<std::int64_t> JobStore::remove(const std::string& id) {
  return state_->file.write([&](SQLite::Database& db) {
    SQLite::Statement remove(
        db, "DELETE FROM job WHERE id = ? AND state NOT IN ('accepted', 'running') RETURNING principal");
    remove.bind(1, id);
    std::optional<std::int64_t> owner;
    while (remove.executeStep()) owner = remove.getColumn(0).getInt64();  // to its end, or nothing is removed
    return owner;
  });
}

std::int64_t JobStore::stored_bytes() const {
  return state_->file.read([](SQLite::Database& db) {
    return db.execAndGet("SELECT coalesce(sum(bytes), 0) FROM blob").getInt64();
  });
}

std::vector<std::string> JobStore::unused_blobs(Microseconds older_than, int limit) const {
  return state_->file.read([&](SQLite::Database& db) {
    SQLite::Statement select(db,
                             "SELECT digest FROM blob WHERE created < ? AND "
                             "NOT EXISTS (SELECT 1 FROM job WHERE input = digest) AND "
                             "NOT EXISTS (SELECT 1 FROM output WHERE output.digest = blob.digest) LIMIT ?");
    select.bind(1, older_than);
    select.bind(2, limit);
    std::vector<std::string> list;
    while (select.executeStep()) list.push_back(blob_of(select.getColumn(0)));
    return list;
  });
}

bool JobStore::remove_blob_row(const std::string& digest) {
  return state_->file.write([&](SQLite::Database& db) {
    SQLite::Statement remove(db,
                             "DELETE FROM blob WHERE digest = ? AND "
                             "NOT EXISTS (SELECT 1 FROM job WHERE input = digest) AND "
                             "NOT EXISTS (SELECT 1 FROM output WHERE output.digest = blob.digest)");
    bind_blob(remove, 1, digest);
    return remove.exec() == 1;
  });
}

void JobStore::probe() const {
  state_->file.read(
      [](SQLite::Database& db) { (void)db.execAndGet("SELECT count(*) FROM principal").getInt64(); });
}

bool JobStore::knows_blob(const std::string& digest) const { return input_bytes(digest) >= 0; }

void JobStore::forget_idempotency(Microseconds older_than) {
  state_->file.write([&](SQLite::Database& db) {
    SQLite::Statement remove(db, "DELETE FROM idempotency WHERE at < ?");
    remove.bind(1, older_than);
    remove.exec();
  });
}

std::string JobStore::check_integrity() const {
  return state_->file.read([](SQLite::Database& db) {
    const std::string answer = db.execAndGet("PRAGMA quick_check").getString();
    return answer == "ok" ? std::string() : answer;
  });
}

void JobStore::checkpoint() { state_->file.run_outside_transaction("PRAGMA wal_checkpoint(TRUNCATE)"); }

}  // namespace sheetform::server
