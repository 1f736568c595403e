#include "server/store/migrations.h"

namespace sheetform::server {
namespace {

constexpr const char* kFirstMetadata = R"(
CREATE TABLE principal(
  id INTEGER PRIMARY KEY, name TEXT UNIQUE NOT NULL, created INTEGER NOT NULL) STRICT;
INSERT INTO principal(id, name, created) VALUES(0, 'anonymous', 0);
CREATE TABLE blob(
  digest BLOB PRIMARY KEY CHECK(length(digest) = 32), bytes INTEGER NOT NULL,
  store TEXT NOT NULL CHECK(store IN ('file', 'db')), created INTEGER NOT NULL) STRICT, WITHOUT ROWID;
CREATE TABLE job(
  seq INTEGER PRIMARY KEY AUTOINCREMENT, id TEXT UNIQUE NOT NULL,
  principal INTEGER NOT NULL DEFAULT 0 REFERENCES principal(id),
  process TEXT NOT NULL, version TEXT NOT NULL,
  state TEXT NOT NULL CHECK(state IN ('accepted', 'running', 'successful', 'failed', 'dismissed')),
  run_after INTEGER NOT NULL,
  attempt INTEGER NOT NULL DEFAULT 0, crashes INTEGER NOT NULL DEFAULT 0, errors INTEGER NOT NULL DEFAULT 0,
  interruptions INTEGER NOT NULL DEFAULT 0,
  token BLOB, rev INTEGER NOT NULL DEFAULT 1, ev INTEGER NOT NULL DEFAULT 0,
  progress INTEGER NOT NULL DEFAULT 0, stage TEXT NOT NULL DEFAULT '', message TEXT NOT NULL DEFAULT '',
  problem TEXT, report TEXT, params TEXT NOT NULL, reuse_key BLOB, reused_from TEXT,
  input BLOB REFERENCES blob(digest), input_name TEXT NOT NULL DEFAULT '', input_info TEXT,
  tag TEXT NOT NULL DEFAULT '',
  created INTEGER NOT NULL, updated INTEGER NOT NULL, started INTEGER, finished INTEGER,
  expires INTEGER NOT NULL) STRICT;
CREATE INDEX job_ready ON job(principal, run_after, seq) WHERE state = 'accepted';
CREATE INDEX job_running ON job(principal) WHERE state = 'running';
CREATE INDEX job_list ON job(created DESC, id DESC);
CREATE INDEX job_list_principal ON job(principal, created DESC, id DESC);
CREATE INDEX job_reuse ON job(reuse_key) WHERE state = 'successful';
CREATE INDEX job_expiry ON job(expires) WHERE state NOT IN ('accepted', 'running');
CREATE INDEX job_input ON job(input);
CREATE TABLE output(
  job INTEGER NOT NULL REFERENCES job(seq) ON DELETE CASCADE, position INTEGER NOT NULL, name TEXT NOT NULL,
  media TEXT NOT NULL, digest BLOB NOT NULL REFERENCES blob(digest), PRIMARY KEY(job, name)) STRICT, WITHOUT ROWID;
CREATE INDEX output_digest ON output(digest);
CREATE TABLE attempt(
  job INTEGER NOT NULL REFERENCES job(seq) ON DELETE CASCADE, n INTEGER NOT NULL, started INTEGER NOT NULL,
  ended INTEGER, outcome TEXT, signal INTEGER, exit_status INTEGER, peak_rss INTEGER, cpu_ms INTEGER,
  log TEXT NOT NULL DEFAULT '', PRIMARY KEY(job, n)) STRICT, WITHOUT ROWID;
CREATE TABLE event(
  job INTEGER NOT NULL REFERENCES job(seq) ON DELETE CASCADE, n INTEGER NOT NULL, at INTEGER NOT NULL,
  state TEXT NOT NULL, progress INTEGER NOT NULL, stage TEXT NOT NULL, message TEXT NOT NULL,
  PRIMARY KEY(job, n)) STRICT, WITHOUT ROWID;
CREATE TABLE idempotency(
  principal INTEGER NOT NULL, route TEXT NOT NULL, key TEXT NOT NULL, fingerprint BLOB NOT NULL, job TEXT NOT NULL,
  at INTEGER NOT NULL, PRIMARY KEY(principal, route, key)) STRICT, WITHOUT ROWID;
CREATE INDEX idempotency_age ON idempotency(at);
)";

constexpr const char* kFirstBlobs = R"(
CREATE TABLE chunk(digest BLOB NOT NULL, i INTEGER NOT NULL, data BLOB NOT NULL, PRIMARY KEY(digest, i)) STRICT;
)";

int pragma_value(SQLite::Database& db, const char* name) {
  return db.execAndGet(std::string("PRAGMA ") + name).getInt();
}

void refuse(const std::string& why) { throw StoreError(StoreFailure::kRefused, why); }

void check_owner(SQLite::Database& db, int newest) {
  const int id = pragma_value(db, "application_id"), version = pragma_value(db, "user_version");
  if (version == 0 && id == 0) return;  // new file
  if (id != kApplicationId) refuse("the database belongs to another program; choose another data folder");
  if (version > newest)
    refuse(
        "the database was written by a newer version of sheetform; start that version, or restore a backup");
}

const std::vector<const char*>& metadata_steps() {
  static const std::vector<const char*> steps{kFirstMetadata};
  return steps;
}

}  // namespace

void run_migrations(DatabaseFile& file, const std::vector<const char*>& steps) {
  const int newest = static_cast<int>(steps.size());
  const int present = file.write([&](SQLite::Database& db) {
    check_owner(db, newest);
    return pragma_value(db, "user_version");
  });
  for (int step = present; step < newest; ++step) {
    file.write([&](SQLite::Database& db) {
      db.exec(steps[static_cast<std::size_t>(step)]);
      db.exec("PRAGMA application_id=" + std::to_string(kApplicationId));
      db.exec("PRAGMA user_version=" + std::to_string(step + 1));
    });
  }
}

int newest_schema() { return static_cast<int>(metadata_steps().size()); }

void migrate_metadata(DatabaseFile& file) { run_migrations(file, metadata_steps()); }

void migrate_blobs(DatabaseFile& file) { run_migrations(file, {kFirstBlobs}); }

}  // namespace sheetform::server
