// The server's log: one line an event, JSON for machines or text for people. Never throws.
#pragma once
#include <string>

#include <nlohmann/json.hpp>

namespace sheetform::server {

enum class LogLevel { kDebug, kInfo, kWarning, kError };
enum class LogStyle { kJson, kText };

/// Call once, before threads start. Lines go to stderr.
void open_log(LogStyle style, LogLevel lowest);

/// fields: an object of further members, may be null.
void log(LogLevel level, const std::string& message, const nlohmann::json& fields = nullptr) noexcept;
inline void log_info(const std::string& message, const nlohmann::json& fields = nullptr) {
  log(LogLevel::kInfo, message, fields);
}
inline void log_warning(const std::string& message, const nlohmann::json& fields = nullptr) {
  log(LogLevel::kWarning, message, fields);
}
inline void log_error(const std::string& message, const nlohmann::json& fields = nullptr) {
  log(LogLevel::kError, message, fields);
}

}  // namespace sheetform::server
