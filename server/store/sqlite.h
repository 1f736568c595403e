// SQLite as this store uses it: one writing connection a file, a pool of reading ones. Internal to store/.
#pragma once
#include <SQLiteCpp/SQLiteCpp.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
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

  /// From now on after(db) is called after every change, in the order of the changes. It must not throw: what
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
  std::mutex writer_mutex_, pool_mutex_;
  std::function<void(SQLite::Database&)> after_change_;
  std::unique_ptr<SQLite::Database> writer_;
  std::vector<std::unique_ptr<SQLite::Database>> idle_readers_;
};

/// Bytes of a blob column.
std::string blob_of(const SQLite::Column& column);
/// Binds bytes as a blob.
void bind_blob(SQLite::Statement& statement, int index, const std::string& bytes);

}  // namespace sheetform::server
