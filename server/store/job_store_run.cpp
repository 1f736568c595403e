// Running jobs: claiming, progress, the ends of an attempt. Each arrow of the state machine is one UPDATE
// that names the state it leaves, and the token of the attempt; no row changed means that somebody else was
// faster.
#include "server/base/identity.h"
#include "server/store/job_store_state.h"

namespace sheetform::server {
namespace {

// The first ready job of every principal that has one (found by skipping through the index), the one whose
// principal has the fewest running jobs first. As fast as first-in-first-out even with ten thousand waiting.
// A time farther away than any delay of ours is no delay: the clock was put back, and the job does not wait
// for it.
constexpr const char* kClaim = R"(
WITH RECURSIVE waiting(id) AS (
  SELECT min(principal) FROM job WHERE state = 'accepted'
  UNION ALL
  SELECT (SELECT min(principal) FROM job WHERE state = 'accepted' AND principal > waiting.id)
  FROM waiting WHERE waiting.id IS NOT NULL),
head AS (
  SELECT (SELECT seq FROM job WHERE state = 'accepted' AND principal = waiting.id
          AND (run_after <= ?1 OR run_after > ?1 + 600000000)
          ORDER BY run_after, seq LIMIT 1) AS first,
         (SELECT count(*) FROM job WHERE state = 'running' AND principal = waiting.id) AS running
  FROM waiting WHERE waiting.id IS NOT NULL)
UPDATE job SET state = 'running', attempt = attempt + 1, token = ?2, started = coalesce(started, ?1), progress = 0,
  stage = '', message = 'started'
WHERE seq = (SELECT job.seq FROM head JOIN job ON job.seq = head.first
             ORDER BY head.running, job.run_after, job.seq LIMIT 1)
RETURNING seq, id, attempt
)";

void begin_attempt(SQLite::Database& db, std::int64_t seq, int attempt, Microseconds now) {
  SQLite::Statement insert(db, "INSERT OR REPLACE INTO attempt(job, n, started) VALUES(?, ?, ?)");
  insert.bind(1, seq);
  insert.bind(2, attempt);
  insert.bind(3, now);
  insert.exec();
}

/// Part of an UPDATE's SET that counts the start.
std::string counted(Requeue reason) {
  switch (reason) {
    case Requeue::kInterruption:
      return ", interruptions = interruptions + 1";
    case Requeue::kCrash:
      return ", crashes = crashes + 1";
    case Requeue::kError:
      return ", errors = errors + 1";
    case Requeue::kNoRoom:
      return "";
  }
  return "";
}

/// Runs an UPDATE whose last two values are seq and token; writes the event when a row changed.
bool change_owned(SQLite::Database& db, SQLite::Statement& update, int next, const ClaimedJob& claimed) {
  update.bind(next, claimed.job.seq);
  bind_blob(update, next + 1, claimed.token);
  if (update.exec() != 1) return false;
  write_event(db, claimed.job.seq, now_us());
  return true;
}

constexpr const char* kOwned = " WHERE seq = ? AND token = ? AND state = 'running'";

void insert_output(SQLite::Database& db, std::int64_t seq, int position, const StoredOutput& output) {
  SQLite::Statement blob(db,
                         "INSERT INTO blob(digest, bytes, store, created) VALUES(?, ?, 'db', ?) "
                         "ON CONFLICT DO NOTHING");
  bind_blob(blob, 1, output.digest);
  blob.bind(2, output.bytes);
  blob.bind(3, now_us());
  blob.exec();
  SQLite::Statement insert(db,
                           "INSERT INTO output(job, position, name, media, digest) VALUES(?, ?, ?, ?, ?)");
  insert.bind(1, seq);
  insert.bind(2, position);
  insert.bind(3, output.name);
  insert.bind(4, output.media_type);
  bind_blob(insert, 5, output.digest);
  insert.exec();
}

}  // namespace

std::optional<ClaimedJob> JobStore::claim(Microseconds now) {
  return state_->file.write_together([&](SQLite::Database& db) -> std::optional<ClaimedJob> {
    const std::string token = random_bytes(16);
    std::string id;
    {
      SQLite::Statement update(db, kClaim);
      update.bind(1, now);
      bind_blob(update, 2, token);
      if (!update.executeStep()) return std::nullopt;
      id = update.getColumn(1).getString();
      const std::int64_t seq = update.getColumn(0).getInt64();
      const int attempt = update.getColumn(2).getInt();
      update.reset();
      begin_attempt(db, seq, attempt, now);
      write_event(db, seq, now);
    }
    return ClaimedJob{*find_job(db, id), token};
  });
}

bool JobStore::report_progress(const ClaimedJob& claimed, int percent, const std::string& stage,
                               const std::string& message) {
  return state_->file.write_together([&](SQLite::Database& db) {
    SQLite::Statement update(db, std::string("UPDATE job SET progress = ?, stage = ?, message = ?") + kOwned);
    update.bind(1, percent);
    update.bind(2, stage);
    update.bind(3, message);
    return change_owned(db, update, 4, claimed);
  });
}

bool JobStore::succeed(const ClaimedJob& claimed, const std::vector<StoredOutput>& outputs,
                       const std::string& report, const std::string& message) {
  return state_->file.write_together([&](SQLite::Database& db) {
    SQLite::Statement update(
        db, std::string("UPDATE job SET state = 'successful', progress = 100, stage = 'write', "
                        "message = ?, report = ?, finished = ?, token = NULL, problem = NULL") +
                kOwned);
    update.bind(1, message);
    update.bind(2, report);
    update.bind(3, now_us());
    if (!change_owned(db, update, 4, claimed)) return false;
    for (std::size_t i = 0; i < outputs.size(); ++i)
      insert_output(db, claimed.job.seq, static_cast<int>(i), outputs[i]);
    return true;
  });
}

bool JobStore::fail(const ClaimedJob& claimed, const std::string& problem, const std::string& message,
                    Requeue counted_as) {
  return state_->file.write_together([&](SQLite::Database& db) {
    SQLite::Statement update(db,
                             "UPDATE job SET state = 'failed', problem = ?, message = ?, finished = ?, "
                             "token = NULL" +
                                 counted(counted_as) + kOwned);
    update.bind(1, problem);
    update.bind(2, message);
    update.bind(3, now_us());
    return change_owned(db, update, 4, claimed);
  });
}

bool JobStore::requeue(const ClaimedJob& claimed, Requeue reason, Microseconds run_after,
                       const std::string& message) {
  return state_->file.write_together([&](SQLite::Database& db) {
    SQLite::Statement update(db,
                             "UPDATE job SET state = 'accepted', run_after = ?, message = ?, progress = 0, "
                             "stage = '', token = NULL" +
                                 counted(reason) + kOwned);
    update.bind(1, run_after);
    update.bind(2, message);
    return change_owned(db, update, 3, claimed);
  });
}

void JobStore::end_attempt(const ClaimedJob& claimed, const AttemptEnd& end) {
  state_->file.write_together([&](SQLite::Database& db) {
    SQLite::Statement update(db,
                             "UPDATE attempt SET ended = ?, outcome = ?, signal = ?, exit_status = ?, "
                             "peak_rss = ?, cpu_ms = ?, log = ? WHERE job = ? AND n = ?");
    update.bind(1, now_us());
    update.bind(2, end.outcome);
    update.bind(3, end.signal);
    update.bind(4, end.exit_status);
    update.bind(5, end.peak_rss);
    update.bind(6, end.cpu_ms);
    update.bind(7, end.log);
    update.bind(8, claimed.job.seq);
    update.bind(9, claimed.job.attempt);
    update.exec();
  });
}

int JobStore::recover() {
  return state_->file.write([](SQLite::Database& db) {
    std::vector<std::int64_t> running;
    SQLite::Statement select(db, "SELECT seq FROM job WHERE state = 'running' ORDER BY seq");
    while (select.executeStep()) running.push_back(select.getColumn(0).getInt64());
    select.reset();
    for (const std::int64_t seq : running) {
      SQLite::Statement update(
          db,
          "UPDATE job SET state = 'accepted', token = NULL, interruptions = interruptions + 1, "
          "progress = 0, stage = '', message = 'waiting again after a restart' WHERE seq = ?");
      update.bind(1, seq);
      update.exec();
      write_event(db, seq, now_us());
    }
    return static_cast<int>(running.size());
  });
}

}  // namespace sheetform::server
