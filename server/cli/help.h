// What `--help` prints.
#pragma once
#include <string>
#include <vector>

#include "server/cli/command_line.h"

namespace sheetform::server {

/// The program's help: what it is, its commands, an example.
std::string program_help(const std::vector<CommandSpec>& commands);
/// The help of one command.
std::string command_help(const CommandSpec& command);

}  // namespace sheetform::server
