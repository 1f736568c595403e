// Questions about jobs. Each is one short read, so that no reader keeps the log of changes from being reset.
#include <algorithm>

#include "server/store/job_store_state.h"

namespace sheetform::server {
namespace {

/// Conditions with their values, in order.
class Where {
 public:
  void add(const std::string& condition) { text_ += (text_.empty() ? " WHERE " : " AND ") + condition; }
  template <class T>
  void add(const std::string& condition, const T& value) {
    add(condition);
    put(value);
  }
  /// A condition on the place of a job in the list: its time twice, then its id.
  void add(const std::string& condition, const std::pair<Microseconds, std::string>& place) {
    add(condition);
    put(place.first);
    put(place.first);
    put(place.second);
  }
  const std::string& text() const { return text_; }
  int bind(SQLite::Statement& statement) const {
    int index = 1;
    for (const auto& value : values_) value(statement, index++);
    return index;
  }

 private:
  template <class T>
  void put(T value) {
    values_.emplace_back([v = std::move(value)](SQLite::Statement& s, int i) { s.bind(i, v); });
  }

  std::string text_;
  std::vector<std::function<void(SQLite::Statement&, int)>> values_;
};

std::string state_list(const std::vector<JobState>& states) {
  std::string text;
  for (const JobState s : states) text += (text.empty() ? "'" : ", '") + std::string(api::to_string(s)) + "'";
  return states.size() == 1 ? "state = " + text : "state IN (" + text + ")";
}

/// Few jobs run or wait, and they have indexes of their own; in the list one would look at all others for
/// them. SQLite guesses otherwise.
const char* table_of(const JobFilter& f) {
  if (f.states == std::vector{JobState::kRunning}) return "job INDEXED BY job_running";
  if (f.states == std::vector{JobState::kAccepted}) return "job INDEXED BY job_ready";
  return "job";
}

Where where_of(const JobFilter& f) {
  // Whole seconds of a job: until its end, or until now when it still runs.
  const std::string seconds = "(coalesce(finished, " + std::to_string(now_us()) + ") - started) / 1000000.0";
  Where where;
  if (!f.states.empty()) where.add(state_list(f.states));
  if (!f.process.empty()) where.add("process = ?", f.process);
  if (!f.tag.empty()) where.add("tag = ?", f.tag);
  if (f.principal) where.add("principal = ?", *f.principal);
  if (f.created_from) where.add("created >= ?", *f.created_from);
  if (f.created_to) where.add("created <= ?", *f.created_to);
  if (f.min_seconds) where.add(seconds + " >= ?", *f.min_seconds);
  if (f.max_seconds) where.add(seconds + " <= ?", *f.max_seconds);
  if (f.after) where.add("(created < ? OR (created = ? AND id < ?))", *f.after);
  if (f.before) where.add("(created > ? OR (created = ? AND id > ?))", *f.before);
  return where;
}

}  // namespace

std::optional<JobRecord> JobStore::find(const std::string& id) const {
  return state_->file.read([&](SQLite::Database& db) { return find_job(db, id); });
}

std::vector<JobRecord> JobStore::list(const JobFilter& filter) const {
  return state_->file.read([&](SQLite::Database& db) {
    const Where where = where_of(filter);
    const char* order =
        filter.before ? " ORDER BY created, id LIMIT ?" : " ORDER BY created DESC, id DESC LIMIT ?";
    SQLite::Statement select(
        db, std::string("SELECT ") + kJobColumns + " FROM " + table_of(filter) + where.text() + order);
    select.bind(where.bind(select), filter.limit);
    std::vector<JobRecord> jobs;
    while (select.executeStep()) jobs.push_back(read_job(select));
    if (filter.before) std::reverse(jobs.begin(), jobs.end());
    return jobs;
  });
}

std::int64_t JobStore::queue_position(const JobRecord& job) const {
  return state_->line.position(job.run_after, job.seq);
}

std::vector<StoredOutput> JobStore::outputs(std::int64_t seq) const {
  return state_->file.read([&](SQLite::Database& db) {
    SQLite::Statement select(db,
                             "SELECT name, media, output.digest, bytes FROM output JOIN blob "
                             "ON blob.digest = output.digest WHERE job = ? ORDER BY position");
    select.bind(1, seq);
    std::vector<StoredOutput> list;
    while (select.executeStep())
      list.push_back({select.getColumn(0).getString(), select.getColumn(1).getString(),
                      blob_of(select.getColumn(2)), select.getColumn(3).getInt64()});
    return list;
  });
}

std::vector<JobEvent> JobStore::events_after(std::int64_t seq, std::int64_t number) const {
  return state_->file.read([&](SQLite::Database& db) {
    SQLite::Statement select(
        db,
        "SELECT n, at, state, progress, stage, message FROM event WHERE job = ? AND n > ? "
        "ORDER BY n");
    select.bind(1, seq);
    select.bind(2, number);
    std::vector<JobEvent> list;
    while (select.executeStep())
      list.push_back({select.getColumn(0).getInt64(), select.getColumn(1).getInt64(),
                      api::job_state_from(select.getColumn(2).getString()).value_or(JobState::kFailed),
                      select.getColumn(3).getInt(), select.getColumn(4).getString(),
                      select.getColumn(5).getString()});
    return list;
  });
}

std::string JobStore::attempt_log(std::int64_t seq) const {
  return state_->file.read([&](SQLite::Database& db) {
    SQLite::Statement select(
        db, "SELECT n, coalesce(outcome, 'running'), log FROM attempt WHERE job = ? ORDER BY n");
    select.bind(1, seq);
    std::string text;
    while (select.executeStep())
      text += "--- start " + std::to_string(select.getColumn(0).getInt()) + ": " +
              select.getColumn(1).getString() + "\n" + select.getColumn(2).getString();
    return text;
  });
}

std::int64_t JobStore::input_bytes(const std::string& digest) const {
  return state_->file.read([&](SQLite::Database& db) {
    SQLite::Statement select(db, "SELECT bytes FROM blob WHERE digest = ?");
    bind_blob(select, 1, digest);
    return select.executeStep() ? select.getColumn(0).getInt64() : std::int64_t{-1};
  });
}

std::map<std::string, std::int64_t> JobStore::counts() const {
  return state_->file.read([](SQLite::Database& db) {
    std::map<std::string, std::int64_t> counts;
    SQLite::Statement select(db, "SELECT state, count(*) FROM job GROUP BY state");
    while (select.executeStep()) counts[select.getColumn(0).getString()] = select.getColumn(1).getInt64();
    return counts;
  });
}

std::int64_t JobStore::waiting(std::optional<std::int64_t> principal) const {
  return state_->line.size(principal);
}

std::optional<Microseconds> JobStore::oldest_waiting() const {
  return state_->file.read([](SQLite::Database& db) {
    SQLite::Statement select(db, "SELECT min(created) FROM job WHERE state = 'accepted'");
    select.executeStep();
    return optional_integer(select.getColumn(0));
  });
}

}  // namespace sheetform::server
