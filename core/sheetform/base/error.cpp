#include "sheetform/base/error.h"

namespace sheetform {
namespace {

std::string joined(const std::string& what, const std::string& where, const std::string& fix) {
  std::string text = what;
  if (!where.empty()) text += " (" + where + ")";
  if (!fix.empty()) text += "; " + fix;
  return text;
}

}  // namespace

const char* to_string(ErrorCode code) {
  switch (code) {
    case ErrorCode::kInvalidParameter:
      return "invalid-parameter";
    case ErrorCode::kUnreadableMesh:
      return "unreadable-mesh";
    case ErrorCode::kUnsupportedMesh:
      return "unsupported-mesh";
    case ErrorCode::kLimitExceeded:
      return "limit-exceeded";
    case ErrorCode::kCancelled:
      return "cancelled";
    case ErrorCode::kDeadlineExceeded:
      return "deadline-exceeded";
    case ErrorCode::kInternal:
      return "internal";
  }
  return "internal";
}

Error::Error(ErrorCode code, std::string what, std::string where, std::string fix)
    : std::runtime_error(joined(what, where, fix)),
      code_(code),
      summary_(std::move(what)),
      where_(std::move(where)),
      fix_(std::move(fix)) {}

}  // namespace sheetform
