#include "server/base/log.h"

#include <spdlog/logger.h>
#include <spdlog/sinks/stdout_sinks.h>

#include <memory>

#include "server/base/clock.h"
#include "sheetform_api/json_text.h"

namespace sheetform::server {
namespace {

struct State {
  std::shared_ptr<spdlog::logger> logger;
  LogStyle style = LogStyle::kText;
};
State& state() {
  static State s;
  return s;
}

constexpr spdlog::level::level_enum kLevels[] = {spdlog::level::debug, spdlog::level::info,
                                                 spdlog::level::warn, spdlog::level::err};
constexpr const char* kNames[] = {"debug", "info", "warning", "error"};

/// Nothing but printable ASCII: whatever stands in a path or a name, it is no control character to a
/// terminal, no line end to a program.
template <class Json>
std::string printable(const Json& value) {
  return value.dump(-1, ' ', true, Json::error_handler_t::replace);
}

std::string json_line(LogLevel level, const std::string& message, const nlohmann::json& fields) {
  nlohmann::ordered_json line{
      {"ts", api::rfc3339(now_us())}, {"level", kNames[static_cast<int>(level)]}, {"msg", message}};
  if (fields.is_object())
    for (const auto& [name, value] : fields.items()) line[name] = value;
  return printable(line);
}

std::string text_line(LogLevel level, const std::string& message, const nlohmann::json& fields) {
  std::string line = api::rfc3339(now_us()).substr(11, 12) + " " + message;
  if (level >= LogLevel::kWarning) line = std::string(kNames[static_cast<int>(level)]) + ": " + line;
  if (fields.is_object())
    for (const auto& [name, value] : fields.items()) line += "  " + name + "=" + printable(value);
  return line;
}

}  // namespace

void open_log(LogStyle style, LogLevel lowest) {
  auto sink = std::make_shared<spdlog::sinks::stderr_sink_mt>();
  auto logger = std::make_shared<spdlog::logger>("sheetform", sink);
  logger->set_pattern("%v");
  logger->set_level(kLevels[static_cast<int>(lowest)]);
  state().style = style;
  state().logger = logger;
}

void log(LogLevel level, const std::string& message, const nlohmann::json& fields) noexcept {
  const std::shared_ptr<spdlog::logger>& logger = state().logger;
  if (!logger || !logger->should_log(kLevels[static_cast<int>(level)])) return;
  try {
    const std::string line = state().style == LogStyle::kJson ? json_line(level, message, fields)
                                                              : text_line(level, message, fields);
    logger->log(kLevels[static_cast<int>(level)], spdlog::string_view_t(line));
  } catch (...) {
    return;  // a line that cannot be written must not end a request
  }
}

}  // namespace sheetform::server
