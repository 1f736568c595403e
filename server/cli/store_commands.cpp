// `sheetform backup`, `restore`, `token`: the care of a data folder.
#include <cstdio>

#include "server/base/file_output.h"
#include "server/cli/commands.h"
#include "server/http/token_file.h"
#include "server/mapping/errors.h"
#include "server/store/backup.h"

namespace sheetform::server {
namespace {

const OptionSpec kDataOption{"--data", "DIR", "Folder of the store. Default ./sheetform-data.", ""};

std::filesystem::path data_of(const ParsedLine& line) { return line.get("--data", "sheetform-data"); }

/// Runs a care-taking step; its failures are about what the user named.
template <class F>
auto named_failures(F&& step) {
  try {
    return step();
  } catch (const Error&) {
    throw;
  } catch (const std::runtime_error& e) {
    throw Error(ErrorCode::kUnreadableMesh, e.what());
  }
}

void print_summary(const char* what, const BackupSummary& s) {
  std::printf("%s: %lld jobs, %lld uploads, %lld result files\n", what, static_cast<long long>(s.jobs),
              static_cast<long long>(s.inputs), static_cast<long long>(s.results));
}

TokenFile tokens_of(const ParsedLine& line) { return TokenFile(data_of(line) / "tokens.json"); }

int add_token(const ParsedLine& line) {
  const std::string name = line.operands.at(1);
  if (!is_token_name(name))
    throw Error(ErrorCode::kInvalidParameter, "the name may hold letters, digits, dots and dashes only",
                name);
  const std::optional<std::string> scopes = normal_scopes(line.get("--scopes", "read submit"));
  if (!scopes)
    throw Error(ErrorCode::kInvalidParameter, "unknown scope", "--scopes",
                "give some of read, submit, jobs:all, admin");
  std::printf("%s\n", tokens_of(line).add(name, *scopes).c_str());
  std::fprintf(stderr, "This is the only time the token is shown.\n");
  return kExitOk;
}

int remove_token(const ParsedLine& line) {
  if (tokens_of(line).remove(line.operands.at(1))) return kExitOk;
  throw Error(ErrorCode::kInvalidParameter, "there is no token of this name", line.operands[1],
              "see `sheetform token list -`");
}

int list_tokens(const ParsedLine& line) {
  for (const TokenRecord& r : tokens_of(line).list())
    std::printf("%-20s %-30s %s\n", r.name.c_str(), r.scopes.c_str(), api::rfc3339(r.created).c_str());
  return kExitOk;
}

}  // namespace

CommandSpec backup_spec() {
  CommandSpec spec;
  spec.name = "backup";
  spec.usage = "DIR [--data DIR]";
  spec.text = "Copies a store, also of a running server, into the new folder DIR, and checks the copy.";
  spec.operands = {"DIR"};
  spec.options = {kDataOption, {"--verify", "", "Check the backup in DIR again instead of making one.", ""}};
  return spec;
}

int backup_command(const ParsedLine& line) {
  keep_files_private();
  return named_failures([&] {
    const std::filesystem::path target = line.operands[0];
    if (!line.has("--verify")) print_summary("copied", make_backup(data_of(line), target));
    print_summary("checked", verify_backup(target));
    return kExitOk;
  });
}

CommandSpec restore_spec() {
  CommandSpec spec;
  spec.name = "restore";
  spec.usage = "DIR [--data DIR]";
  spec.text = "Checks the backup in DIR and makes a store of it in an empty data folder.";
  spec.operands = {"DIR"};
  spec.options = {kDataOption};
  return spec;
}

int restore_command(const ParsedLine& line) {
  keep_files_private();
  return named_failures([&] {
    print_summary("restored", restore_backup(line.operands[0], data_of(line)));
    return kExitOk;
  });
}

CommandSpec token_spec() {
  CommandSpec spec;
  spec.name = "token";
  spec.usage = "add|remove|list NAME [--scopes \"read submit\"] [--data DIR]";
  spec.text =
      "Makes, takes back and lists the tokens that open a server to others. A running server notices at "
      "once.";
  spec.operands = {"ACTION", "NAME"};
  spec.options = {kDataOption,
                  {"--scopes", "LIST",
                   "What the token may do: read, submit, jobs:all (see the jobs of others), admin. Default "
                   "\"read submit\".",
                   ""}};
  spec.notes =
      "`sheetform token list -` lists all. Send a token as `Authorization: Bearer TOKEN` or `X-Api-Key: "
      "TOKEN`.";
  return spec;
}

int token_command(const ParsedLine& line) {
  return named_failures([&] {
    const std::string& action = line.operands[0];
    if (action == "add") return add_token(line);
    if (action == "remove") return remove_token(line);
    if (action == "list") return list_tokens(line);
    throw Error(ErrorCode::kInvalidParameter, "there is no action " + action, "token",
                "give add, remove or list");
  });
}

}  // namespace sheetform::server
