// Asks a server whether it is well; what the image's health check runs.
#pragma once
#include "server/http/connection_gate.h"

namespace sheetform::server {

/// Status of GET `path`, 0 when there is no answer within the time.
int ask_status(const ListenAddress& address, const std::string& path, std::chrono::seconds patience);

}  // namespace sheetform::server
