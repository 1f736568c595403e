#include "server/cli/command_line.h"

#include <charconv>

namespace sheetform::server {
namespace {

[[noreturn]] void wrong(const std::string& what, const std::string& where, const std::string& fix) {
  throw Error(ErrorCode::kInvalidParameter, what, where, fix);
}

const OptionSpec* find_option(const CommandSpec& command, const std::string& name) {
  for (const OptionSpec& o : command.options)
    if (name == o.name || (!o.alias.empty() && name == o.alias)) return &o;
  return nullptr;
}

std::string help_hint(const CommandSpec& command) { return "see `sheetform " + command.name + " --help`"; }

/// Takes the option at `at`, and its value, moving `at` past both.
void read_option(const CommandSpec& command, const std::vector<std::string>& arguments, std::size_t& at,
                 ParsedLine& line) {
  std::string name = arguments[at++], value;
  const std::size_t equals = name.rfind("--", 0) == 0 ? name.find('=') : std::string::npos;
  const bool joined = equals != std::string::npos;
  if (joined) {
    value = name.substr(equals + 1);
    name.resize(equals);
  }
  const OptionSpec* option = find_option(command, name);
  if (option == nullptr) wrong("there is no option " + name, "command line", help_hint(command));
  if (option->value.empty()) {
    if (joined) wrong("option takes no value", name, "write " + name + " alone");
    value = "on";
  } else if (!joined) {
    if (at == arguments.size()) wrong("option needs a value", name, "write " + name + " " + option->value);
    value = arguments[at++];
  }
  if (!line.options.emplace(option->name, value).second) wrong("option given twice", name, "give it once");
}

void check_operands(const CommandSpec& command, const ParsedLine& line) {
  if (line.operands.size() < command.operands.size())
    wrong("missing " + command.operands[line.operands.size()], "command line",
          "usage: sheetform " + command.name + " " + command.usage);
  if (line.operands.size() > command.operands.size())
    wrong("too many operands", line.operands[command.operands.size()], help_hint(command));
}

bool is_option(const std::string& argument) { return argument.size() > 1 && argument[0] == '-'; }

}  // namespace

std::string ParsedLine::get(const std::string& name, const std::string& fallback) const {
  const auto found = options.find(name);
  return found == options.end() ? fallback : found->second;
}

ParsedLine parse_line(const CommandSpec& command, const std::vector<std::string>& arguments) {
  ParsedLine line;
  for (const std::string& a : arguments) {
    if (a == "--") break;
    if (a == "--help" || a == "-h") line.help = true;
  }
  if (line.help) return line;
  bool only_operands = false;
  for (std::size_t at = 0; at < arguments.size();) {
    if (!only_operands && arguments[at] == "--") {
      only_operands = true;
      ++at;
    } else if (!only_operands && is_option(arguments[at])) {
      read_option(command, arguments, at, line);
    } else {
      line.operands.push_back(arguments[at++]);
    }
  }
  check_operands(command, line);
  return line;
}

std::int64_t whole_number(const std::string& option, const std::string& text, std::int64_t low,
                          std::int64_t high) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < low || value > high)
    wrong("\"" + text.substr(0, 40) + "\" is no whole number from " + std::to_string(low) + " to " +
              std::to_string(high),
          option, "give one");
  return value;
}

}  // namespace sheetform::server
