#include "server/cli/command_line.h"

#include <gtest/gtest.h>

#include "server/cli/commands.h"
#include "server/cli/help.h"
#include "sheetform_api/parameter_schema.h"

namespace sheetform::server {
namespace {

CommandSpec sample() {
  return {"cut", "MESH -o DIR", "Cuts.", {"MESH"}, {{"--output", "DIR", "", "-o"}, {"--quiet", "", "", "-q"}},
          ""};
}

std::string refused_at(const std::vector<std::string>& arguments) {
  try {
    (void)parse_line(sample(), arguments);
    return "taken";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::kInvalidParameter);
    EXPECT_FALSE(e.fix().empty());
    return e.where();
  }
}

TEST(CommandLine, ReadsEveryForm) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"a.obj", "-o", "d"},
                                                    {"--output", "d", "a.obj"},
                                                    {"--output=d", "a.obj"},
                                                    {"-o", "d", "--", "a.obj"}}) {
    const ParsedLine line = parse_line(sample(), arguments);
    EXPECT_EQ(line.get("--output"), "d");
    EXPECT_EQ(line.operands, std::vector<std::string>{"a.obj"});
    EXPECT_FALSE(line.has("--quiet"));
  }
  EXPECT_EQ(parse_line(sample(), {"--", "-q"}).operands[0], "-q");
  EXPECT_EQ(parse_line(sample(), {"a", "--output="}).get("--output", "x"), "");
}

TEST(CommandLine, RefusesWithThePlace) {
  EXPECT_EQ(refused_at({"a", "--colour", "red"}), "command line");
  EXPECT_EQ(refused_at({"a", "-o"}), "-o");
  EXPECT_EQ(refused_at({"a", "--quiet=1"}), "--quiet");
  EXPECT_EQ(refused_at({"a", "-q", "--quiet"}), "--quiet");
  EXPECT_EQ(refused_at({}), "command line");
  EXPECT_EQ(refused_at({"a", "b"}), "b");
}

TEST(CommandLine, WholeNumbers) {
  EXPECT_EQ(whole_number("--threads", "8", 1, 64), 8);
  for (const char* text : {"", "0", "65", "-1", "8x", "8.0", "99999999999999999999"})
    EXPECT_THROW((void)whole_number("--threads", text, 1, 64), Error) << text;
}

TEST(CommandLine, HelpNamesEveryParameter) {
  const std::string help = command_help(decompose_spec());
  for (const api::ParameterDefinition& d : api::parameter_definitions())
    EXPECT_NE(help.find(d.flag() + " "), std::string::npos) << d.flag();
}

TEST(CommandLine, HelpFitsOnAScreen) {
  std::istringstream lines(command_help(decompose_spec()));
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 101u) << line;
}

}  // namespace
}  // namespace sheetform::server
