// Reading of command lines: options with one value or none, and operands. Knows no command.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "sheetform/base/error.h"

namespace sheetform::server {

/// One option of a command. value: what stands for its value in the help ("FILE"), empty for a switch.
struct OptionSpec {
  std::string name;  ///< with dashes: "--e-max"
  std::string value;
  std::string text;   ///< for the help
  std::string alias;  ///< short form, e.g. "-o"; may be empty
};

/// A command with what it takes.
struct CommandSpec {
  std::string name, usage, text;
  std::vector<std::string> operands;  ///< names; all are required
  std::vector<OptionSpec> options;
  std::string notes;  ///< stands at the end of the help
};

struct ParsedLine {
  std::map<std::string, std::string> options;  ///< by name with dashes; switches have the value "on"
  std::vector<std::string> operands;
  bool help = false;

  bool has(const std::string& name) const { return options.count(name) != 0; }
  /// The value, or `fallback` when the option was not given.
  std::string get(const std::string& name, const std::string& fallback = {}) const;
};

/// Understands "--name value", "--name=value", "-o value" and "--" (all that follows are operands). Unknown,
/// repeated and valueless options and a wrong number of operands throw Error kInvalidParameter (where: the
/// option).
ParsedLine parse_line(const CommandSpec& command, const std::vector<std::string>& arguments);

/// A whole number in [low, high], or Error kInvalidParameter naming the option.
std::int64_t whole_number(const std::string& option, const std::string& text, std::int64_t low,
                          std::int64_t high);

}  // namespace sheetform::server
