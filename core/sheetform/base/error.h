// Wrong input throws Error, once, at the edge; "not viable" is a value of the search, never an Error.
#pragma once
#include <stdexcept>
#include <string>
#include <utility>

namespace sheetform {

/// Who is at fault and what kind of fault it is; names are part of the API (problem types, exit codes).
enum class ErrorCode {
  kInvalidParameter,  ///< a parameter is unknown, out of range, or not usable together with another
  kUnreadableMesh,    ///< the bytes are not a mesh of a known format, or break that format
  kUnsupportedMesh,   ///< a readable mesh that cannot be decomposed (no faces, non-orientable, ...)
  kLimitExceeded,     ///< a stated limit (bytes, faces, components, memory) is exceeded
  kCancelled,         ///< the caller asked to stop
  kDeadlineExceeded,  ///< RunContext::deadline has passed
  kInternal,          ///< our fault
};

/// Stable machine name of a code, e.g. "unreadable-mesh".
const char* to_string(ErrorCode code);

/// What went wrong, where, and how to fix it: three short texts that a person can act on.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, std::string what, std::string where = {}, std::string fix = {});
  ErrorCode code() const { return code_; }
  const std::string& where() const { return where_; }      ///< e.g. "line 12", "face 845"; may be empty
  const std::string& fix() const { return fix_; }          ///< what the user can do; may be empty
  const std::string& summary() const { return summary_; }  ///< the first text alone

 private:
  ErrorCode code_;
  std::string summary_, where_, fix_;
};

}  // namespace sheetform
