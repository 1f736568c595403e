// What a job's process can and cannot do on this machine, found out by starting one.
#pragma once
#include "sheetform_api/json_text.h"

namespace sheetform::server {

/// Members: landlock, seccomp, whole (everything that must be refused is), and each single attempt.
api::Json probe_worker(bool sandbox);

}  // namespace sheetform::server
