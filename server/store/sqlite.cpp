#include "server/store/sqlite.h"

#include <SQLiteCpp/Savepoint.h>
#include <sqlite3.h>
#include <unistd.h>

#include "server/base/log.h"

namespace sheetform::server {
namespace {

constexpr int kBusyMilliseconds = 5000;
constexpr std::size_t kIdleReaders = 16;
constexpr int kExitStorage = 74;

/// For every connection: no code in the schema is trusted, and damaged cells are noticed.
constexpr const char* kConnectionPragmas =
    "PRAGMA foreign_keys=ON; PRAGMA trusted_schema=OFF; PRAGMA cell_size_check=ON; PRAGMA mmap_size=0;";

bool is_damage(int code, int extended) {
  return code == SQLITE_CORRUPT || code == SQLITE_NOTADB || extended == SQLITE_IOERR_FSYNC ||
         extended == SQLITE_IOERR_DIR_FSYNC;
}

}  // namespace

void end_after_storage_failure(const std::string& what) {
  log_error("storage failed, the process ends", {{"reason", what}});
  ::_exit(kExitStorage);
}

void rethrow_as_store_error(const SQLite::Exception& error) {
  const int code = error.getErrorCode(), extended = error.getExtendedErrorCode();
  if (is_damage(code, extended)) end_after_storage_failure(error.what());
  if (code == SQLITE_FULL) throw StoreError(StoreFailure::kFull, error.what());
  if (code == SQLITE_BUSY || code == SQLITE_LOCKED) throw StoreError(StoreFailure::kBusy, error.what());
  if (code == SQLITE_IOERR) throw StoreError(StoreFailure::kDisk, error.what());
  throw StoreError(StoreFailure::kRefused, error.what());
}

DatabaseFile::DatabaseFile(std::filesystem::path path, const std::string& settings) : path_(std::move(path)) {
  try {
    writer_ = std::make_unique<SQLite::Database>(path_.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE,
                                                 kBusyMilliseconds);
    sqlite3_db_config(writer_->getHandle(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    writer_->exec(settings);
    writer_->exec(kConnectionPragmas);
    writer_->exec(
        "PRAGMA journal_mode=WAL; PRAGMA synchronous=FULL; PRAGMA wal_autocheckpoint=1000;"
        "PRAGMA journal_size_limit=67108864; PRAGMA secure_delete=FAST;");
  } catch (const SQLite::Exception& e) {
    rethrow_as_store_error(e);
  }
}

void DatabaseFile::follow_changes(const std::function<void(SQLite::Database&)>& begin,
                                  std::function<void(SQLite::Database&)> after) {
  const std::lock_guard lock(writer_mutex_);
  try {
    begin(*writer_);
  } catch (const SQLite::Exception& e) {
    rethrow_as_store_error(e);
  }
  after_change_ = std::move(after);
}

void DatabaseFile::run_outside_transaction(const std::string& statements) {
  const std::lock_guard lock(writer_mutex_);
  try {
    writer_->exec(statements);
  } catch (const SQLite::Exception& e) {
    rethrow_as_store_error(e);
  }
}

void DatabaseFile::run_together(Change& mine) {
  std::unique_lock lock(waiting_mutex_);
  waiting_.push_back(&mine);
  while (!mine.done) {
    if (running_) {
      done_.wait(lock);
      continue;
    }
    running_ = true;
    lock.unlock();
    const std::vector<Change*> ran = run_waiting();
    lock.lock();
    for (Change* change : ran) change->done = true;
    running_ = false;
    done_.notify_all();
  }
  lock.unlock();
  if (mine.fault) std::rethrow_exception(mine.fault);
}

std::vector<DatabaseFile::Change*> DatabaseFile::run_waiting() noexcept {
  const std::lock_guard writing(writer_mutex_);
  std::vector<Change*> changes;
  {
    const std::lock_guard lock(waiting_mutex_);  // not earlier: until the file was ours, more could join
    changes.swap(waiting_);
  }
  if (changes.size() > 1 && run_in_one(changes)) return changes;
  for (Change* change : changes) {
    change->fault = nullptr;
    try {
      transact(change->run);
    } catch (...) {
      change->fault = std::current_exception();
    }
  }
  return changes;
}

/// SQLite may have rolled back all of it when a statement fails; then each change is run for itself, so that
/// whoever is at fault is told, and nobody else.
bool DatabaseFile::run_in_one(const std::vector<Change*>& changes) {
  try {
    SQLite::Transaction transaction(*writer_, SQLite::TransactionBehavior::IMMEDIATE);
    for (Change* change : changes) {
      SQLite::Savepoint savepoint(*writer_, "one");  // rolls back when it was not released
      try {
        change->run(*writer_);
        savepoint.release();
      } catch (const SQLite::Exception&) {
        throw;
      } catch (...) {
        change->fault = std::current_exception();
      }
    }
    transaction.commit();
  } catch (const SQLite::Exception& e) {
    if (is_damage(e.getErrorCode(), e.getExtendedErrorCode())) end_after_storage_failure(e.what());
    return false;
  }
  if (after_change_) after_change_(*writer_);
  return true;
}

std::unique_ptr<SQLite::Database> DatabaseFile::take_reader() {
  {
    const std::lock_guard lock(pool_mutex_);
    if (!idle_readers_.empty()) {
      auto connection = std::move(idle_readers_.back());
      idle_readers_.pop_back();
      return connection;
    }
  }
  try {
    auto connection =
        std::make_unique<SQLite::Database>(path_.string(), SQLite::OPEN_READONLY, kBusyMilliseconds);
    connection->exec(kConnectionPragmas);
    connection->exec("PRAGMA query_only=1;");
    return connection;
  } catch (const SQLite::Exception& e) {
    rethrow_as_store_error(e);
  }
}

void DatabaseFile::give_back(std::unique_ptr<SQLite::Database> connection) {
  const std::lock_guard lock(pool_mutex_);
  if (idle_readers_.size() < kIdleReaders) idle_readers_.push_back(std::move(connection));
}

std::string blob_of(const SQLite::Column& column) {
  const char* data = static_cast<const char*>(column.getBlob());
  return data == nullptr ? std::string() : std::string(data, static_cast<std::size_t>(column.getBytes()));
}

void bind_blob(SQLite::Statement& statement, int index, const std::string& bytes) {
  statement.bind(index, static_cast<const void*>(bytes.data()), static_cast<int>(bytes.size()));
}

}  // namespace sheetform::server
