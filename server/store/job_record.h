// What the store keeps of a job. Texts of JSON are kept as they are; the store never looks into them.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/base/clock.h"
#include "sheetform_api/job.h"

namespace sheetform::server {

using api::JobState;

struct JobRecord {
  std::int64_t seq = 0;
  std::string id;
  std::int64_t principal = 0;
  std::string process, version;
  JobState state = JobState::kAccepted;
  int attempt = 0, crashes = 0, errors = 0, interruptions = 0;
  std::int64_t revision = 0;  ///< grows with every change
  std::int64_t last_event = 0;
  int progress = 0;
  std::string stage, message;
  std::string problem, report;  ///< JSON, or empty
  std::string parameters;       ///< JSON
  std::string reused_from;
  std::string input;  ///< digest, 32 bytes
  std::string input_name, input_info;
  std::string tag;
  Microseconds created = 0, updated = 0, expires = 0, run_after = 0;
  std::optional<Microseconds> started, finished;
};

/// What accept() stores, all in one transaction.
struct NewJob {
  std::string id;
  std::int64_t principal = 0;
  std::string process, version, parameters, tag;
  std::string input, input_name, input_info;
  std::int64_t input_bytes = 0;
  std::string reuse_key;  ///< digest of all that decides the result
  Microseconds created = 0, expires = 0;
  std::string idempotency_key, route, fingerprint;  ///< key empty: none
};

struct ClaimedJob {
  JobRecord job;
  std::string token;  ///< proves that a finished attempt is the one that owns the job
};

/// A file of a result that is stored in the blobs already.
struct StoredOutput {
  std::string name, media_type;
  std::string digest;
  std::int64_t bytes = 0;
};

/// What of another job's result is reused: the files whose names begin with `prefix`, without it.
struct ResultPart {
  std::string prefix;
  std::string report;  ///< JSON, in place of that job's own; empty: that one
};

/// One moment of a job, kept for replay.
struct JobEvent {
  std::int64_t number = 0;
  Microseconds at = 0;
  JobState state = JobState::kAccepted;
  int progress = 0;
  std::string stage, message;
};

/// How an attempt ended, for the history.
struct AttemptEnd {
  std::string outcome, log;
  int signal = 0, exit_status = 0;
  std::int64_t peak_rss = 0, cpu_ms = 0;
};

struct JobFilter {
  std::vector<JobState> states;  ///< empty: all
  std::string process, tag;
  std::optional<std::int64_t> principal;
  std::optional<Microseconds> created_from, created_to;
  std::optional<double> min_seconds, max_seconds;
  /// Created and id of a job: those older than it (after), or those newer, the nearest ones (before).
  std::optional<std::pair<Microseconds, std::string>> after, before;
  int limit = 10;
};

struct RemovedJob {
  std::string id;
  std::int64_t principal = 0;  ///< whose it was
};

struct IdempotencyRecord {
  std::string fingerprint, job;
};

}  // namespace sheetform::server
