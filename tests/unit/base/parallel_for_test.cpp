#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "sheetform/base/run_context.h"

namespace sheetform {
namespace {

RunContext with_threads(int threads) {
  RunContext context;
  context.threads = threads;
  return context;
}

// How many calls run at the same time, and the most that it ever were.
class Gauge {
 public:
  void enter() {
    const int now = ++running_;
    for (int most = most_; most < now && !most_.compare_exchange_weak(most, now);) {
    }
    std::this_thread::sleep_for(std::chrono::microseconds(200));
    --running_;
  }
  int most() const { return most_; }

 private:
  std::atomic<int> running_{0}, most_{0};
};

TEST(ParallelFor, EveryIndexOnceForAnyNumberOfThreads) {
  for (int threads : {1, 2, 3, 8}) {
    std::vector<int> calls(100, 0);
    parallel_for(with_threads(threads), 100, [&](int i) { ++calls[i]; });
    EXPECT_EQ(calls, std::vector<int>(100, 1)) << threads;
  }
  parallel_for(with_threads(2), 0, [](int) { FAIL(); });
}

TEST(ParallelFor, NestedCallsStayWithinTheThreads) {
  const RunContext context = with_threads(3);
  Gauge gauge;
  std::atomic<int> calls{0};
  parallel_for(context, 4, [&](int) {
    parallel_for(context, 5, [&](int) { parallel_for(context, 3, [&](int) { gauge.enter(), ++calls; }); });
  });
  EXPECT_EQ(calls, 4 * 5 * 3);
  EXPECT_LE(gauge.most(), 3);
}

TEST(ParallelFor, WhatOneCallLeavesIdleTheOtherUses) {
  const RunContext context = with_threads(2);
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  bool shared = false;
  parallel_for(context, 2, [&](int i) {
    while (i == 1 && !shared && std::chrono::steady_clock::now() < give_up) {
      std::vector<std::thread::id> on(2);
      parallel_for(context, 2, [&](int k) {
        on[k] = std::this_thread::get_id();
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      });
      shared = on[0] != on[1];
    }
  });
  EXPECT_TRUE(shared);
}

TEST(ParallelFor, AfterAFailureTheThreadsAreThereAgain) {
  const RunContext context = with_threads(2);
  parallel_for(context, 1, [&](int) {
    EXPECT_THROW(parallel_for(context, 9, [](int) { throw std::runtime_error("no"); }), std::runtime_error);
  });
  std::atomic<bool> other{false};
  const auto caller = std::this_thread::get_id();
  parallel_for(context, 2, [&](int) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    if (std::this_thread::get_id() != caller) other = true;
  });
  EXPECT_TRUE(other);
}

TEST(FirstOf, TheLowestThatPassesForAnyNumberOfThreads) {
  for (int threads : {1, 2, 3, 8}) {
    const RunContext context = with_threads(threads);
    for (int lowest = 0; lowest <= 40; ++lowest) {
      std::vector<std::atomic<int>> asked(40);
      const auto passes = [&](int i) {
        ++asked[i];
        // Those after it are often done first.
        if (i == lowest) std::this_thread::sleep_for(std::chrono::microseconds(100));
        return i >= lowest;
      };
      ASSERT_EQ(first_of(context, 40, passes), lowest) << threads;
      for (int i = 0; i < 40; ++i) ASSERT_TRUE(asked[i] == 1 || (asked[i] == 0 && i > lowest)) << i;
      if (threads == 1 && lowest < 39) {
        ASSERT_EQ(asked[lowest + 1], 0);
      }
    }
  }
  EXPECT_EQ(first_of(with_threads(2), 0, [](int) { return true; }), 0);
}

// What comes after the one found is left at its next checkpoint, also where it waits in a loop of its own:
// here it would never end by itself.
TEST(FirstOf, WhatCannotMatterAnyMoreIsLeft) {
  const RunContext context = with_threads(4);
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  std::atomic<int> left{0};
  const auto wait = [&] {
    while (std::chrono::steady_clock::now() < give_up) context.checkpoint();
  };
  const int found = first_of(context, 3, [&](int i) {
    if (i == 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      return true;
    }
    struct Count {
      std::atomic<int>& left;
      ~Count() { ++left; }
    } count{left};
    if (i == 1) wait();
    parallel_for(context, 2, [&](int) { wait(); });
    return true;
  });
  EXPECT_EQ(found, 0);
  EXPECT_GE(left, 1);
  EXPECT_LT(std::chrono::steady_clock::now(), give_up);
  EXPECT_NO_THROW(context.checkpoint());
}

TEST(FirstOf, AFailureBeforeTheOneFoundIsTold) {
  for (int threads : {1, 2, 4})
    EXPECT_THROW(first_of(with_threads(threads), 3,
                          [](int i) -> bool {
                            if (i == 1) throw std::runtime_error("no");
                            return i == 2;
                          }),
                 std::runtime_error);
}

TEST(FirstOf, InsideOfAnotherTheInnerOneAnswersForItself) {
  const RunContext context = with_threads(3);
  std::vector<int> inner(4, -1);
  const int found = first_of(context, 4, [&](int i) {
    inner[i] = first_of(context, 5, [&](int k) {
      context.checkpoint();
      return k >= i;
    });
    return i == 3;
  });
  EXPECT_EQ(found, 3);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(inner[i], i);
}

// Threads that wait between loops: many short ones, and ends right after one, from several runs at a time.
TEST(KeepThreads, LoopsOfARunShareThem) {
  std::vector<std::thread> runs;
  std::atomic<int> calls{0};
  for (int run = 0; run < 3; ++run)
    runs.emplace_back([&] {
      for (int k = 0; k < 200; ++k) {
        RunContext context = with_threads(3);
        keep_threads(context);
        for (int n : {2, 1, 7, 3})
          parallel_for(context, n, [&](int) { parallel_for(RunContext(context), 2, [&](int) { ++calls; }); });
      }
    });
  for (std::thread& t : runs) t.join();
  EXPECT_EQ(calls, 3 * 200 * 13 * 2);
}

TEST(KeepThreads, TheSameThreadsHelpAgain) {
  RunContext context = with_threads(2);
  keep_threads(context);
  std::set<std::thread::id> helpers;
  for (int k = 0; k < 20; ++k) {
    std::vector<std::thread::id> on(2);
    parallel_for(context, 2, [&](int i) {
      on[i] = std::this_thread::get_id();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    });
    for (const auto& id : on)
      if (id != std::this_thread::get_id()) helpers.insert(id);
    if (k % 5 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));  // asleep by then
  }
  EXPECT_GE(helpers.size(), 1u);
  EXPECT_LE(helpers.size(), 2u);
}

}  // namespace
}  // namespace sheetform
