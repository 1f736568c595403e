// What every stage is given besides its input: cancellation, a deadline, progress, threads, a seed.
#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace sheetform {

class Crew;

/// Names of the stages in the order in which they run; progress lines, job rows and timings speak of these.
enum class Stage { kRead, kPrepare, kField, kTrace, kInsert, kRemove, kFinal, kWrite };
const char* to_string(Stage stage);

/// Shared by all stages of one run. A stage calls checkpoint() at least every 50 ms of work.
struct RunContext {
  const std::atomic<bool>* cancelled = nullptr;  ///< set by another thread to stop the run
  std::optional<std::chrono::steady_clock::time_point> deadline;
  /// Never called concurrently; from the running thread, or one that works for it. fraction: of the whole
  /// run, 0..1, never decreasing.
  std::function<void(Stage, double fraction, const std::string& message)> progress;
  int threads = 1;             ///< upper bound of worker threads; results do not depend on it
  std::uint64_t seed = 0;      ///< the only source of randomness
  std::shared_ptr<Crew> crew;  ///< see keep_threads; null: every loop starts its own threads

  /// Throws Error kCancelled or kDeadlineExceeded when the run has to stop. Inside of first_of() it also ends
  /// a call whose answer cannot matter any more (by an exception that is no Error, which first_of() catches).
  void checkpoint() const;
  /// Reports that `stage` is done to `part` (0..1) of itself.
  void report(Stage stage, double part, const std::string& message = {}) const;
};

/// From now on the loops of this context and its copies share threads that wait between them.
void keep_threads(RunContext& context);

/// Calls fn(i) for i in [0, n), on up to context.threads threads; exceptions are rethrown. Each i must write
/// only its own output, then the result does not depend on the number of threads. Calls inside of fn share
/// the threads of the outermost call: what one of them leaves idle, the others may use from their next call
/// on.
void parallel_for(const RunContext& context, int n, const std::function<void(int)>& fn);

/// The lowest i below n that passes, n where none does. While one is under way the next are begun on other
/// threads, and left at their next checkpoint() when one before them has passed. So passes() must have no
/// effect beyond i itself; of what comes after the one found some may have been asked for, in part or not.
int first_of(const RunContext& context, int n, const std::function<bool(int)>& passes);

/// How many threads a parallel_for called now would use: what is worth while only beside something else can
/// be left out where it is one.
int threads_at_hand(const RunContext& context);

}  // namespace sheetform
