// The commands that people call. Each takes what parse_line made of the line and answers with the exit
// status; Errors are printed by main.
#pragma once
#include "server/cli/command_line.h"

namespace sheetform::server {

CommandSpec decompose_spec();
int decompose_command(const ParsedLine& line);

CommandSpec sweep_spec();
int sweep_command(const ParsedLine& line);

CommandSpec serve_spec();
int serve_command(const ParsedLine& line);

CommandSpec backup_spec();
int backup_command(const ParsedLine& line);

CommandSpec restore_spec();
int restore_command(const ParsedLine& line);

CommandSpec token_spec();
int token_command(const ParsedLine& line);

CommandSpec healthcheck_spec();
int healthcheck_command(const ParsedLine& line);

CommandSpec verify_spec();
int verify_command(const ParsedLine& line);

}  // namespace sheetform::server
