// What a job's process may still do once it has been started: compute, read its input, write into its folder.
#pragma once
#include <cstdint>
#include <string>

#include "server/jobs/worker_protocol.h"
#include "sheetform_api/json_text.h"

namespace sheetform::server {

struct SandboxLimits {
  std::uint64_t memory = 0;      ///< bytes of address space; 0: no limit
  std::uint64_t file_bytes = 0;  ///< largest file; 0: no limit
  int cpu_seconds = 0;           ///< 0: no limit
  int parent = 0;                ///< process whose death is this one's; 0: whichever started it
  bool awaited = false;  ///< a client waits for it: before the jobs, but still after the server itself
};

/// What a request asks for. Reading and exporting are awaited, jobs are not.
SandboxLimits limits_of(const WorkerRequest& request);

/// Limits, low priority, no core dumps, dies with its parent. Cannot fail in a way that matters.
void lower_process(const SandboxLimits& limits);

struct SandboxState {
  bool landlock = false, seccomp = false, network = false;  ///< network: cut off by a namespace of its own
};

/// Cuts this process and those that it will start off the network; false without the privilege for it. Takes
/// milliseconds the first time, and the processes of a machine wait for each other; nothing after that.
bool leave_network();

/// Closes the process in: no files but those below `folder` (a descriptor) and what is open already, no
/// sockets, no programs, no processes, no signals to others. Says what this kernel could do.
SandboxState close_in(int folder);

/// Tries everything that close_in forbids, from inside; each member says whether it was refused.
api::Json probe_sandbox(int folder);

}  // namespace sheetform::server
