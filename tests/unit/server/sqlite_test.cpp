// Changes that share a transaction.
#include "server/store/sqlite.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <thread>

#include "server/base/digest.h"
#include "server/base/identity.h"
#include "server/store/migrations.h"

namespace sheetform::server {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::Not;

class WriteTogether : public testing::Test {
 protected:
  WriteTogether() {
    file_.write([](SQLite::Database& db) { db.exec("CREATE TABLE t(x INTEGER PRIMARY KEY) STRICT"); });
    file_.follow_changes([](SQLite::Database&) {}, [this](SQLite::Database&) { ++transactions_; });
  }
  ~WriteTogether() override { fs::remove_all(folder_); }

  static void insert(SQLite::Database& db, int x) {
    db.exec("INSERT INTO t VALUES(" + std::to_string(x) + ")");
  }

  std::vector<int> stored() {
    return file_.read([](SQLite::Database& db) {
      std::vector<int> list;
      SQLite::Statement select(db, "SELECT x FROM t ORDER BY x");
      while (select.executeStep()) list.push_back(select.getColumn(0).getInt());
      return list;
    });
  }

  /// Runs work(i) in a thread each, all of them while the file is busy; how many transactions that took.
  int all_at_once(int count, const std::function<void(int)>& work) {
    const int before = transactions_;
    std::atomic<int> begun{0};
    std::vector<std::thread> threads;
    file_.write([&](SQLite::Database&) {
      for (int i = 0; i < count; ++i)
        threads.emplace_back([&, i] {
          ++begun;
          work(i);
        });
      while (begun < count) std::this_thread::yield();
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
    });
    for (std::thread& t : threads) t.join();
    return transactions_ - before - 1;
  }

  fs::path folder_ = [] {
    const fs::path path = fs::temp_directory_path() / ("sheetform-sqlite-" + to_hex(random_bytes(6)));
    fs::create_directories(path);
    return path;
  }();
  DatabaseFile file_{folder_ / "t.db", ""};
  std::atomic<int> transactions_{0};
};

TEST_F(WriteTogether, WhatWaitsForTheDiskSharesATransaction) {
  std::vector<int> answers(20);
  const int transactions = all_at_once(20, [&](int i) {
    answers[static_cast<std::size_t>(i)] = file_.write_together([&](SQLite::Database& db) {
      insert(db, i);
      return 10 * i;
    });
  });
  EXPECT_LT(transactions, 10);
  EXPECT_EQ(stored().size(), 20u);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(answers[static_cast<std::size_t>(i)], 10 * i);
}

TEST_F(WriteTogether, AThrowUndoesOneChangeAndReachesOneCaller) {
  std::atomic<int> thrown{0};
  const int transactions = all_at_once(20, [&](int i) {
    try {
      file_.write_together([&](SQLite::Database& db) {
        insert(db, i);
        if (i % 5 == 0) throw std::runtime_error("no " + std::to_string(i));
      });
    } catch (const std::runtime_error& e) {
      EXPECT_EQ(e.what(), "no " + std::to_string(i));
      ++thrown;
    }
  });
  EXPECT_LT(transactions, 10);
  EXPECT_EQ(thrown, 4);
  const std::vector<int> list = stored();
  EXPECT_EQ(list.size(), 16u);
  EXPECT_THAT(list, Not(Contains(5)));
}

TEST_F(WriteTogether, AStatementThatFailsHarmsNoOtherChange) {
  file_.write([](SQLite::Database& db) { insert(db, 7); });
  std::atomic<int> refused{0};
  all_at_once(12, [&](int i) {
    try {
      file_.write_together([&](SQLite::Database& db) { insert(db, i); });
    } catch (const StoreError& e) {
      EXPECT_EQ(e.kind(), StoreFailure::kRefused);
      EXPECT_EQ(i, 7);
      ++refused;
    }
  });
  EXPECT_EQ(refused, 1);
  EXPECT_EQ(stored().size(), 12u);
}

/// One of them finds no room: SQLite rolls all of it back, the others are done all the same.
TEST_F(WriteTogether, AFullFileRefusesOnlyWhatDoesNotFit) {
  file_.run_outside_transaction("PRAGMA max_page_count=6");
  std::atomic<int> full{0};
  all_at_once(8, [&](int i) {
    try {
      file_.write_together([&](SQLite::Database& db) {
        insert(db, i);
        if (i == 3) db.exec("CREATE TABLE wide(b BLOB); INSERT INTO wide VALUES(zeroblob(1000000))");
      });
    } catch (const StoreError& e) {
      EXPECT_EQ(e.kind(), StoreFailure::kFull);
      EXPECT_EQ(i, 3);
      ++full;
    }
  });
  EXPECT_EQ(full, 1);
  EXPECT_EQ(stored(), (std::vector<int>{0, 1, 2, 4, 5, 6, 7}));
}

class Migration : public testing::Test {
 protected:
  Migration() {
    fs::create_directories(folder_);
    DatabaseFile file(path_, "");
    run_migrations(file, {kFirst});
    file.write([](SQLite::Database& db) { db.exec("INSERT INTO t VALUES(7)"); });
  }
  ~Migration() override { fs::remove_all(folder_); }

  /// user_version, and the columns and values of t.
  std::string state() {
    DatabaseFile file(path_, "");
    return file.read([](SQLite::Database& db) {
      EXPECT_EQ(db.execAndGet("PRAGMA integrity_check").getString(), "ok");
      return db.execAndGet("PRAGMA user_version").getString() + " " +
             db.execAndGet("SELECT group_concat(name) FROM pragma_table_info('t')").getString() + " " +
             db.execAndGet("SELECT group_concat(x) FROM t").getString();
    });
  }

  static constexpr const char* kFirst = "CREATE TABLE t(x INTEGER PRIMARY KEY) STRICT";
  static constexpr const char* kSecond = "ALTER TABLE t ADD COLUMN y INTEGER; UPDATE t SET x = x + 1";
  const fs::path folder_ = fs::temp_directory_path() / ("sheetform-migration-" + to_hex(random_bytes(6)));
  const fs::path path_ = folder_ / "t.db";
};

TEST_F(Migration, TakesTheStepsThatAreMissing) {
  EXPECT_EQ(state(), "1 x 7");
  for (int i = 0; i < 2; ++i) {  // the second time there is nothing to do
    DatabaseFile file(path_, "");
    run_migrations(file, {kFirst, kSecond});
  }
  EXPECT_EQ(state(), "2 x,y 8");
}

TEST_F(Migration, AStepThatFailsLeavesTheFileAsItWas) {
  {
    DatabaseFile file(path_, "");
    EXPECT_THROW(run_migrations(file, {kFirst, "UPDATE t SET x = x + 1; SELECT no_such_function()"}),
                 StoreError);
  }
  EXPECT_EQ(state(), "1 x 7");
}

TEST_F(Migration, KilledInTheMiddleItBeginsAnew) {
  const pid_t child = ::fork();
  if (child == 0) {
    DatabaseFile file(path_, "");
    file.follow_changes(
        [](SQLite::Database& db) {
          db.createFunction(
              "die", 0, true, nullptr, [](sqlite3_context*, int, sqlite3_value**) { ::raise(SIGKILL); },
              nullptr, nullptr, nullptr);
        },
        {});
    run_migrations(file,
                   {kFirst, "ALTER TABLE t ADD COLUMN y INTEGER; UPDATE t SET x = x + 1; SELECT die()"});
    ::_exit(0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(state(), "1 x 7");
  {
    DatabaseFile file(path_, "");
    run_migrations(file, {kFirst, kSecond});
  }
  EXPECT_EQ(state(), "2 x,y 8");
}

TEST_F(Migration, FilesOfOthersAndOfLaterVersionsAreRefused) {
  DatabaseFile file(path_, "");
  EXPECT_THROW(run_migrations(file, {}), StoreError);
  file.write([](SQLite::Database& db) { db.exec("PRAGMA application_id=7"); });
  EXPECT_THROW(run_migrations(file, {kFirst}), StoreError);
}

}  // namespace
}  // namespace sheetform::server
