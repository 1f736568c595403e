// `sheetform worker`: the child side of a job. Not for people; it needs the descriptors of worker_protocol.h.
#pragma once

namespace sheetform::server {

/// The exit status; see worker_protocol.h and server/mapping/errors.h.
int worker_command();

}  // namespace sheetform::server
