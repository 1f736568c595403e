#include "server/cli/help.h"

#include <algorithm>

namespace sheetform::server {
namespace {

constexpr std::size_t kWidth = 100;

/// Text in lines of at most kWidth, each begun by `indent` spaces; the first line goes on after `used`
/// columns.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t used) {
  std::string out, line;
  std::size_t room = kWidth - std::max(indent, used);
  const auto flush = [&] {
    out += line + "\n" + std::string(indent, ' ');
    line.clear();
    room = kWidth - indent;
  };
  for (std::size_t at = 0; at < text.size();) {
    std::size_t space = text.find(' ', at);
    if (space == std::string::npos) space = text.size();
    const std::string word = text.substr(at, space - at);
    if (!line.empty() && line.size() + 1 + word.size() > room) flush();
    line += (line.empty() ? "" : " ") + word;
    at = space + 1;
  }
  return out + line;
}

std::string option_help(const OptionSpec& o) {
  constexpr std::size_t kColumn = 26;
  std::string head =
      "  " + (o.alias.empty() ? "" : o.alias + ", ") + o.name + (o.value.empty() ? "" : " " + o.value);
  head +=
      head.size() + 1 < kColumn ? std::string(kColumn - head.size(), ' ') : "\n" + std::string(kColumn, ' ');
  return head + wrapped(o.text, kColumn, kColumn) + "\n";
}

}  // namespace

std::string program_help(const std::vector<CommandSpec>& commands) {
  std::string text =
      "sheetform cuts a surface into sheets that are made flat and bent into shape.\n\n"
      "usage: sheetform COMMAND ...\n\ncommands:\n";
  for (const CommandSpec& c : commands) {
    const std::string head = "  " + c.name + std::string(c.name.size() < 12 ? 12 - c.name.size() : 1, ' ');
    text += head + wrapped(c.text, 14, 14) + "\n";
  }
  return text +
         "\n`sheetform COMMAND --help` tells more about one of them.\n\n"
         "example: sheetform decompose bunny.obj -o bunny-sheets --e-max 0.02 --target-size 400\n"
         "         writes the parts to cut (layout.svg), the bent shape (ruled.obj) and a report "
         "(layout.json).\n\n"
         "Exit status: 0 done; 64 wrong usage; 65 the input is at fault (the last line says what, where and "
         "what to\n"
         "do); 70 our fault.\n";
}

std::string command_help(const CommandSpec& command) {
  std::string text =
      "usage: sheetform " + command.name + " " + command.usage + "\n\n" + wrapped(command.text, 0, 0) + "\n";
  if (!command.options.empty()) text += "\noptions:\n";
  for (const OptionSpec& o : command.options) text += option_help(o);
  if (!command.notes.empty()) text += "\n" + command.notes + "\n";
  return text;
}

}  // namespace sheetform::server
