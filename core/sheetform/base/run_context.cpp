#include "sheetform/base/run_context.h"

#include <algorithm>
#include <array>
#include <exception>
#include <mutex>
#include <thread>
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

void parallel_for(const RunContext& context, int n, const std::function<void(int)>& fn) {
  const int workers = std::min(context.threads, n);
  if (workers <= 1) {
    for (int i = 0; i < n; ++i) fn(i);
    return;
  }
  std::atomic<int> next{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  auto work = [&] {
    try {
      for (int i = next++; i < n; i = next++) fn(i);
    } catch (...) {
      const std::lock_guard lock(failure_mutex);
      if (!failure) failure = std::current_exception();
      next = n;
    }
  };
  std::vector<std::thread> pool;
  for (int w = 1; w < workers; ++w) pool.emplace_back(work);
  work();
  for (std::thread& t : pool) t.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace sheetform
