// The program: finds the command, runs it, says on stderr why it failed.
#include <cstdio>
#include <exception>
#include <new>
#include <system_error>

#include "server/base/file_output.h"
#include "server/base/version.h"
#include "server/cli/commands.h"
#include "server/cli/help.h"
#include "server/jobs/nursery.h"
#include "server/jobs/refusal.h"
#include "server/jobs/worker_command.h"
#include "server/mapping/errors.h"
#include "server/store/store_error.h"

namespace sheetform::server {
namespace {

struct Command {
  CommandSpec (*spec)();
  int (*run)(const ParsedLine&);
};

CommandSpec version_spec() { return {"version", "", "Says which version this is.", {}, {}, ""}; }

int version_command(const ParsedLine&) {
  std::printf("sheetform %s\n", kVersion);
  return kExitOk;
}

constexpr Command kCommands[] = {{decompose_spec, decompose_command}, {sweep_spec, sweep_command},
                                 {verify_spec, verify_command},       {serve_spec, serve_command},
                                 {token_spec, token_command},         {backup_spec, backup_command},
                                 {restore_spec, restore_command},     {healthcheck_spec, healthcheck_command},
                                 {version_spec, version_command}};

std::vector<CommandSpec> specs() {
  std::vector<CommandSpec> list;
  for (const Command& c : kCommands) list.push_back(c.spec());
  return list;
}

const Command* find_command(const std::string& name) {
  for (const Command& c : kCommands)
    if (c.spec().name == name) return &c;
  return nullptr;
}

int run_command(const std::vector<std::string>& arguments) {
  const std::string name = arguments.empty() ? "--help" : arguments[0];
  if (name == "--help" || name == "-h" || name == "help") {
    std::fputs(program_help(specs()).c_str(), arguments.empty() ? stderr : stdout);
    return arguments.empty() ? kExitUsage : kExitOk;
  }
  if (name == "worker") return worker_command();
  if (name == "nursery") return nursery_command();
  const Command* command = find_command(name == "--version" ? "version" : name);
  if (command == nullptr)
    throw Error(ErrorCode::kInvalidParameter, "there is no command " + name, "command line",
                "see `sheetform --help`");
  const CommandSpec spec = command->spec();
  const ParsedLine line = parse_line(spec, {arguments.begin() + 1, arguments.end()});
  if (line.help) {
    std::fputs(command_help(spec).c_str(), stdout);
    return kExitOk;
  }
  return command->run(line);
}

int complain(const char* what, int status) {
  std::fprintf(stderr, "sheetform: %s\n", what);
  return status;
}

int guarded_main(const std::vector<std::string>& arguments) {
  try {
    return run_command(arguments);
  } catch (const Error& e) {
    return complain(e.what(), exit_status(e.code()));
  } catch (const FileError& e) {
    return complain((std::string(e.what()) + "; free some space or choose another folder").c_str(),
                    kExitOurs);
  } catch (const Refusal& e) {
    return complain((e.problem().detail + "; " + e.problem().fix).c_str(), kExitUsage);
  } catch (const StoreError& e) {
    return complain((std::string("the store cannot be used: ") + e.what()).c_str(), kExitOurs);
  } catch (const std::system_error& e) {
    return complain(e.what(), kExitOurs);  // what the system refused: an address, a folder
  } catch (const std::bad_alloc&) {
    return complain("out of memory; simplify the mesh, or give the machine more memory", kExitOurs);
  } catch (const std::exception& e) {
    return complain((std::string("internal error: ") + e.what() + "; please report it").c_str(), kExitOurs);
  }
}

}  // namespace
}  // namespace sheetform::server

int main(int argc, char** argv) {
  return sheetform::server::guarded_main({argv + (argc > 0 ? 1 : 0), argv + argc});
}
