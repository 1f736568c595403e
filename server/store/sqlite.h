// SQLite as this store uses it: one writing connection a file, a pool of reading ones. Internal to store/.
#pragma once
#include <SQLiteCpp/SQLiteCpp.h>

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/store/store_error.h"

namespace sheetform::server {

/// Turns SQLite's exception into StoreError; ends the process after a failed sync or on damage.
[[noreturn]] void rethrow_as_store_error(const SQLite::Exception& error);

/// One database file. Exactly one connection writes and checkpoints (SQLite 3.40 may damage a WAL file that
/// two connections reset), guarded by a mutex; readers are query-only and short.
class DatabaseFile {
 public:
  /// Opens or creates. settings: pragmas to run on the writing connection before anything else. Throws
  /// StoreError.
  DatabaseFile(std::filesystem::path path, const std::string& settings);

  /// Runs change(db) in one immediate transaction; what it returns is returned. A throw rolls back.
  template <class F>
  auto write(F&& change) {
    const std::lock_guard lock(writer_mutex_);
    return transact(change);
  }

  /// As write(), but changes that arrive while the disk is busy share one transaction, and so one sync.
  /// Returns when it is on stable storage. A change that throws is undone alone; the others do not notice.
  /// change may run more than once (each time what it did before is rolled back), so it must not leave traces
  /// elsewhere.
  template <class F>
  auto write_together(F&& change) {
    using Answer = decltype(change(*writer_));
    if constexpr (std::is_void_v<Answer>) {
      Change mine{std::ref(change), {}, false};
      run_together(mine);
    } else {
      std::optional<Answer> answer;
      Change mine{[&](SQLite::Database& db) { answer.emplace(change(db)); }, {}, false};
      run_together(mine);
      return std::move(*answer);
    }
  }

  /// From now on after(db) is called after every transaction, in their order. It must not throw: what
  /// is committed has happened. Also runs begin(db) once, before anybody else changes anything.
  void follow_changes(const std::function<void(SQLite::Database&)>& begin,
                      std::function<void(SQLite::Database&)> after);

  /// Runs query(db) on a read-only connection.
  template <class F>
  auto read(F&& query) {
    Reader reader(*this);
    try {
      return query(*reader.connection);
    } catch (const SQLite::Exception& e) {
      reader.connection.reset();  // not back to the pool
      rethrow_as_store_error(e);
    }
  }

  /// Runs statements outside of a transaction on the writing connection (pragmas, incremental vacuum).
  void run_outside_transaction(const std::string& statements);

 private:
  struct Change {
    std::function<void(SQLite::Database&)> run;
    std::exception_ptr fault;
    bool done;
  };
  /// Returns when `mine` is done; throws its fault.
  void run_together(Change& mine);
  /// Takes and runs all that wait by now; the faults are left in them.
  std::vector<Change*> run_waiting() noexcept;
  /// False when nothing of it has happened.
  bool run_in_one(const std::vector<Change*>& changes);
  /// Whoever calls it holds writer_mutex_.
  template <class F>
  auto transact(F&& change) {
    try {
      SQLite::Transaction transaction(*writer_, SQLite::TransactionBehavior::IMMEDIATE);
      if constexpr (std::is_void_v<decltype(change(*writer_))>) {
        change(*writer_);
        transaction.commit();
        if (after_change_) after_change_(*writer_);
      } else {
        auto answer = change(*writer_);
        transaction.commit();
        if (after_change_) after_change_(*writer_);
        return answer;
      }
    } catch (const SQLite::Exception& e) {
      rethrow_as_store_error(e);
    }
  }

  struct Reader {
    explicit Reader(DatabaseFile& f) : file(f), connection(f.take_reader()) {}
    ~Reader() {
      if (connection) file.give_back(std::move(connection));
    }
    DatabaseFile& file;
    std::unique_ptr<SQLite::Database> connection;
  };
  std::unique_ptr<SQLite::Database> take_reader();
  void give_back(std::unique_ptr<SQLite::Database> connection);

  std::filesystem::path path_;
  std::mutex writer_mutex_, pool_mutex_, waiting_mutex_;
  std::condition_variable done_;
  std::vector<Change*> waiting_;
  bool running_ = false;  ///< one of those who wait does the work of all
  std::function<void(SQLite::Database&)> after_change_;
  std::unique_ptr<SQLite::Database> writer_;
  std::vector<std::unique_ptr<SQLite::Database>> idle_readers_;
};

/// Bytes of a blob column.
std::string blob_of(const SQLite::Column& column);
/// Binds bytes as a blob.
void bind_blob(SQLite::Statement& statement, int index, const std::string& bytes);

}  // namespace sheetform::server
