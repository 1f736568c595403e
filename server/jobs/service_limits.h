// Every limit of the service, with its default. /api/v1/limits shows them.
#pragma once
#include <cstdint>

#include "server/base/clock.h"

namespace sheetform::server {

struct ServiceLimits {
  // uploads
  std::uint64_t upload_bytes = std::uint64_t{256} << 20;
  std::uint64_t json_bytes = std::uint64_t{16} << 20;
  // queue
  std::int64_t queued_jobs = 20'000;
  std::int64_t queued_jobs_each = 20'000;  ///< of one principal
  int slots = 1;                           ///< jobs that run at once
  int threads = 1;                         ///< of one job
  // one job
  int job_seconds = 900;                              ///< wall clock
  int stall_seconds = 120;                            ///< without progress and without use of the processor
  std::uint64_t job_memory = std::uint64_t{4} << 30;  ///< address space of the child
  std::uint64_t result_bytes = std::uint64_t{256} << 20;  ///< all files together
  int result_files = 64;
  int inspect_seconds = 60;  ///< reading a mesh at upload
  int export_seconds = 60;   ///< making a file from a stored result
  int exports = 16;          ///< such files at once, those that wait for a processor included
  int crashes = 3;           ///< starts of a job that kills its process
  int errors = 5;            ///< starts of a job that the disk refuses
  int interruptions = 20;
  // keeping
  Microseconds keep_results = 30 * kDay;
  Microseconds keep_dismissed = 1 * kDay;
  Microseconds keep_idempotency = 1 * kDay;
  std::uint64_t stored_bytes = 0;                     ///< quota of all uploads and results; 0: none
  std::uint64_t free_bytes = std::uint64_t{2} << 30;  ///< uploads are refused below this much free space
  // connections
  int event_streams = 200;
  int waiters = 64;
  int wait_seconds = 55;
  int submits_per_minute = 0;  ///< of one principal; 0: no limit
};

}  // namespace sheetform::server
