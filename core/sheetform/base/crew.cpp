#include "sheetform/base/crew.h"

#include <chrono>

namespace sheetform {
namespace {

constexpr std::chrono::microseconds kAwake{200};

}  // namespace

void wait_while(const std::atomic<int>& value, int old) {
  const auto until = std::chrono::steady_clock::now() + kAwake;
  while (value == old) {
    if (std::chrono::steady_clock::now() > until) return value.wait(old);
    std::this_thread::yield();
  }
}

Crew::Crew(int threads) {
  for (int i = 0; i < threads; ++i) members_.push_back(std::make_unique<Member>());
}

Crew::~Crew() {
  for (const auto& member : members_) {
    if (!member->thread.joinable()) continue;
    member->become(kEnds);
    member->thread.join();
  }
}

bool Crew::begin(const std::function<void()>& task) {
  for (const auto& member : members_) {
    int expected = kFree;
    if (!member->state.compare_exchange_strong(expected, kTaken)) continue;
    try {
      member->task = task;
      if (!member->thread.joinable()) member->thread = std::thread([&m = *member] { m.run(); });
    } catch (...) {  // no memory, or no thread: others help
      member->state = kFree;
      return false;
    }
    member->become(kHasTask);
    return true;
  }
  return false;
}

void Crew::Member::run() {
  while (true) {
    for (int now = state; now == kFree || now == kTaken; now = state) wait_while(state, now);
    if (state == kEnds) return;
    task();
    task = nullptr;
    int expected = kHasTask;  // or it ends: whoever waited for the task need not wait for this
    state.compare_exchange_strong(expected, kFree);
  }
}

}  // namespace sheetform
