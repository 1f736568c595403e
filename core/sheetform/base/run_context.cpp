#include "sheetform/base/run_context.h"

#include <algorithm>
#include <array>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "sheetform/base/error.h"

namespace sheetform {
namespace {

struct Share {
  const char* name;
  double begin, end;  // of the whole run; measured shares of a typical run, rounded
};
constexpr std::array<Share, 8> kShares{{{"read", 0.0, 0.02},
                                        {"prepare", 0.02, 0.10},
                                        {"field", 0.10, 0.16},
                                        {"trace", 0.16, 0.25},
                                        {"insert", 0.25, 0.45},
                                        {"remove", 0.45, 0.85},
                                        {"final", 0.85, 0.97},
                                        {"write", 0.97, 1.0}}};

const Share& share(Stage stage) { return kShares[static_cast<std::size_t>(stage)]; }

// Of the outermost parallel_for that this thread works for: the threads that have nothing to do.
thread_local std::atomic<int>* idle_threads = nullptr;

// Takes up to `wanted` of the idle threads; how many it were.
int take(std::atomic<int>& idle, int wanted) {
  int there = idle;
  while (true) {
    const int taken = std::clamp(there, 0, std::max(wanted, 0));
    if (taken == 0 || idle.compare_exchange_weak(there, there - taken)) return taken;
  }
}

}  // namespace

const char* to_string(Stage stage) { return share(stage).name; }

void RunContext::checkpoint() const {
  if (cancelled != nullptr && cancelled->load(std::memory_order_relaxed))
    throw Error(ErrorCode::kCancelled, "the run was cancelled");
  if (deadline && std::chrono::steady_clock::now() > *deadline)
    throw Error(ErrorCode::kDeadlineExceeded, "the run took longer than its time limit", {},
                "simplify the mesh, raise e_max, or raise the time limit");
}

void RunContext::report(Stage stage, double part, const std::string& message) const {
  checkpoint();
  if (!progress) return;
  const Share& s = share(stage);
  progress(stage, s.begin + (s.end - s.begin) * std::clamp(part, 0.0, 1.0), message);
}

int threads_at_hand(const RunContext& context) {
  return idle_threads == nullptr ? context.threads : std::min(context.threads, 1 + *idle_threads);
}

void parallel_for(const RunContext& context, int n, const std::function<void(int)>& fn) {
  std::atomic<int> own{context.threads - 1};
  std::atomic<int>& idle = idle_threads != nullptr ? *idle_threads : own;
  const int helpers = take(idle, std::min(context.threads, n) - 1);
  if (helpers == 0) {
    for (int i = 0; i < n; ++i) fn(i);
    return;
  }
  std::atomic<int> next{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  auto work = [&] {
    std::atomic<int>* const outer = std::exchange(idle_threads, &idle);
    try {
      for (int i = next++; i < n; i = next++) fn(i);
    } catch (...) {
      const std::lock_guard lock(failure_mutex);
      if (!failure) failure = std::current_exception();
      next = n;
    }
    idle_threads = outer;
    ++idle;
  };
  std::vector<std::thread> pool;
  for (int w = 0; w < helpers; ++w) pool.emplace_back(work);
  work();
  for (std::thread& t : pool) t.join();
  --idle;  // this thread goes on
  if (failure) std::rethrow_exception(failure);
}

int first_of(const RunContext& context, int n, const std::function<bool(int)>& passes) {
  std::atomic<int> found{n};
  parallel_for(context, n, [&](int i) {
    if (i > found || !passes(i)) return;
    for (int other = found; i < other && !found.compare_exchange_weak(other, i);) {
    }
  });
  return found;
}

}  // namespace sheetform
