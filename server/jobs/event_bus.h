// Tells waiting threads that jobs have changed, and keeps what is too fresh to be stored: live progress.
#pragma once
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/base/clock.h"

namespace sheetform::server {

struct LiveProgress {
  int attempt = 0, percent = 0;
  std::string stage, message;
};

struct JobChange {
  std::string job;
  std::optional<std::int64_t> removed_of;  ///< whose it was, when it is no more
};

class EventBus {
 public:
  /// Something about this job changed.
  void publish(const std::string& job);
  /// The job of this principal is no more: nobody can be asked any longer whose it was.
  void publish_removed(const std::string& job, std::int64_t principal);
  /// Live progress of a running job; published at most four times a second unless `now`.
  void progress(const std::string& job, const LiveProgress& live, bool now);
  void forget(const std::string& job);
  std::optional<LiveProgress> live(const std::string& job) const;

  /// Number of the newest change of any job.
  std::uint64_t newest() const;
  /// Waits for a change after `seen`, of `job` or (empty) of any. False: none came before `until`, or
  /// wake_all.
  bool wait(const std::string& job, std::uint64_t& seen, SteadyClock::time_point until);
  /// Jobs that changed after `seen`, each once, in order of their last change. None when too many changes
  /// were missed.
  std::optional<std::vector<JobChange>> changed_since(std::uint64_t seen) const;
  /// Ends every wait, now and later.
  void wake_all();

 private:
  bool changed(const std::string& job, std::uint64_t seen) const;
  void publish_locked(JobChange change);

  struct Entry {
    LiveProgress live;
    SteadyClock::time_point published{};
  };
  mutable std::mutex mutex_;
  std::condition_variable condition_;
  std::uint64_t newest_ = 0;
  std::deque<JobChange> changes_;  ///< of the last changes; the newest at the back
  std::map<std::string, Entry> live_;
  bool closed_ = false;
};

}  // namespace sheetform::server
