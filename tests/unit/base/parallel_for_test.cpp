#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
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

}  // namespace
}  // namespace sheetform
