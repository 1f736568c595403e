// Errors of core in the words of the wire and of the command line.
#pragma once
#include "sheetform/base/error.h"
#include "sheetform_api/parameter_schema.h"
#include "sheetform_api/problem.h"

namespace sheetform::server {

/// Exit statuses of every command, after sysexits.
inline constexpr int kExitOk = 0;
inline constexpr int kExitUsage = 64;    ///< wrong options or parameters
inline constexpr int kExitInput = 65;    ///< the mesh is at fault
inline constexpr int kExitOurs = 70;     ///< our fault
inline constexpr int kExitMemory = 71;   ///< out of memory
inline constexpr int kExitIo = 74;       ///< a disk or file refused
inline constexpr int kExitConfig = 78;   ///< the server may not start like this
inline constexpr int kExitSignal = 130;  ///< stopped by the user

api::Problem to_problem(const Error& error);
/// What a problem of core's kind means for the exit status.
int exit_status(ErrorCode code);
/// The same error in core's words.
Error to_core_error(const api::InvalidParameter& error);

}  // namespace sheetform::server
