#include "sheetform/base/run_context.h"

#include <algorithm>
#include <array>
#include <exception>
#include <mutex>
#include <utility>

#include "sheetform/base/crew.h"
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

// The outermost parallel_for that this thread works for.
struct Loop {
  std::atomic<int> idle;  // so many threads have nothing to do
  Crew& crew;
};
thread_local Loop* loop = nullptr;

// What this thread works for may come after the one that first_of() has found. outer: what that is a part of.
struct Candidate {
  const std::atomic<int>* found;
  int own;
  const Candidate* outer;
  bool superseded() const { return found->load(std::memory_order_relaxed) < own; }
};
thread_local const Candidate* candidate = nullptr;

struct Superseded {};

// Takes up to `wanted` of the idle threads; how many it were.
int take(std::atomic<int>& idle, int wanted) {
  int there = idle;
  while (true) {
    const int taken = std::clamp(there, 0, std::max(wanted, 0));
    if (taken == 0 || idle.compare_exchange_weak(there, there - taken)) return taken;
  }
}

void share_out(Loop& outermost, const RunContext& context, int n, const std::function<void(int)>& fn) {
  const int helpers = take(outermost.idle, std::min(context.threads, n) - 1);
  if (helpers == 0) {
    for (int i = 0; i < n; ++i) fn(i);
    return;
  }
  std::atomic<int> next{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto work = [&, all_for = candidate] {
    Loop* const outer = std::exchange(loop, &outermost);
    const Candidate* const before = std::exchange(candidate, all_for);
    try {
      for (int i = next++; i < n; i = next++) fn(i);
    } catch (...) {
      const std::lock_guard lock(failure_mutex);
      if (!failure) failure = std::current_exception();
      next = n;
    }
    loop = outer, candidate = before;
    ++outermost.idle;
  };
  // A helper is done with all that is here when it tells so, and the last one tells it to what may outlive
  // it. From the first that begins on nothing may throw.
  const auto working = std::make_shared<std::atomic<int>>(helpers);
  const auto leave = [](std::atomic<int>& left) {
    if (--left == 0) left.notify_one();
  };
  const std::function<void()> help = [&work, working, leave] { work(), leave(*working); };
  for (int w = 0; w < helpers; ++w) {
    if (outermost.crew.begin(help)) continue;
    ++outermost.idle;
    leave(*working);
  }
  work();
  for (int left = *working; left > 0; left = *working) wait_while(*working, left);
  --outermost.idle;  // this thread goes on
  if (failure) std::rethrow_exception(failure);
}

}  // namespace

const char* to_string(Stage stage) { return share(stage).name; }

void RunContext::checkpoint() const {
  if (cancelled != nullptr && cancelled->load(std::memory_order_relaxed))
    throw Error(ErrorCode::kCancelled, "the run was cancelled");
  for (const Candidate* c = candidate; c != nullptr; c = c->outer)
    if (c->superseded()) throw Superseded();
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
  return loop == nullptr ? context.threads : std::min(context.threads, 1 + loop->idle);
}

void keep_threads(RunContext& context) {
  if (context.threads > 1 && !context.crew) context.crew = std::make_shared<Crew>(context.threads);
}

void parallel_for(const RunContext& context, int n, const std::function<void(int)>& fn) {
  if (loop != nullptr) return share_out(*loop, context, n, fn);
  if (context.crew) {
    Loop own{context.threads - 1, *context.crew};
    return share_out(own, context, n, fn);
  }
  Crew crew(context.threads);
  Loop own{context.threads - 1, crew};
  share_out(own, context, n, fn);
}

int first_of(const RunContext& context, int n, const std::function<bool(int)>& passes) {
  std::atomic<int> found{n};
  parallel_for(context, n, [&](int i) {
    const Candidate own{&found, i, candidate};
    if (own.superseded()) return;
    candidate = &own;
    bool passed = false;
    try {
      passed = passes(i);
    } catch (...) {
      candidate = own.outer;
      if (!own.superseded()) throw;
    }
    candidate = own.outer;
    for (int other = found; passed && i < other && !found.compare_exchange_weak(other, i);) {
    }
  });
  return found;
}

}  // namespace sheetform
