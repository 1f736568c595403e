// What the commands that decompose have in common: options of every parameter, threads, progress.
#pragma once
#include <cstdint>

#include "server/cli/command_line.h"
#include "server/cli/progress_display.h"
#include "sheetform/base/run_context.h"
#include "sheetform_api/parameter_schema.h"

namespace sheetform::server {

constexpr std::uint64_t kLargestFile = std::uint64_t{256} << 20;

/// -o, one option for each parameter of the schema, --field, --threads, -q.
std::vector<OptionSpec> run_options();

/// The parameters named on the line, by wire name, in wire types. Throws Error kInvalidParameter (where: the
/// option).
api::Json given_parameters(const ParsedLine& line);

/// The mesh named on the line, with the file of --field behind it where there is one (base/input_bundle.h).
/// Throws Error (where: the file or the option).
std::string read_run_input(const ParsedLine& line);

/// The folder of -o. Throws Error kInvalidParameter when it is not given.
std::string output_folder(const ParsedLine& line);

/// Threads and progress as the line asks for; SIGINT and SIGTERM cancel from now on. `display` has to live as
/// long.
RunContext context_for(const ParsedLine& line, ProgressDisplay& display);

/// "1.87 %"
std::string percent(double fraction);

}  // namespace sheetform::server
