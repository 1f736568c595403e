// `sheetform decompose MESH -o DIR ...`: one run in this process, files into a folder.
#include <unistd.h>

#include "server/base/file_output.h"
#include "server/cli/commands.h"
#include "server/cli/run_line.h"
#include "server/mapping/errors.h"
#include "server/mapping/parameters.h"
#include "server/mapping/run.h"

namespace sheetform::server {
namespace {

void print_summary(const Outcome& outcome, const std::string& folder, double seconds) {
  for (const std::string& note : outcome.notes) std::printf("note: %s\n", note.c_str());
  const api::Json& r = outcome.report;
  std::printf("%d parts; largest distance %s of the diagonal, tolerance %s %s; %.1f s\n",
              r.value("patches", 0), percent(r.value("hausdorff", 0.0)).c_str(),
              percent(r.value("e_max", 0.0)).c_str(), r.value("e_max_met", false) ? "met" : "NOT met",
              seconds);
  for (const OutputFile& file : outcome.files)
    std::printf("%s/%s  (%.1f kB)\n", folder.c_str(), file.name.c_str(),
                static_cast<double>(file.content.size()) / 1000);
}

}  // namespace

CommandSpec decompose_spec() {
  CommandSpec spec;
  spec.name = "decompose";
  spec.usage = "MESH -o DIR [options]";
  spec.text =
      "Reads a mesh (OBJ, STL, PLY, OFF), decomposes it and writes the result into the folder DIR: "
      "layout.svg to cut, ruled.obj in 3D, layout.json with structure and report.";
  spec.operands = {"MESH"};
  spec.options = run_options();
  return spec;
}

int decompose_command(const ParsedLine& line) {
  const std::string folder = output_folder(line);
  const api::Json parameters = understood_parameters(given_parameters(line));
  const std::string path = line.operands[0];
  ProgressDisplay display(stderr, ::isatty(STDERR_FILENO) == 1, line.has("--quiet"));
  RunContext context = context_for(line, display);
  const std::string bytes = read_run_input(line);
  const Outcome outcome =
      run_decomposition(bytes, std::filesystem::path(path).filename().string(), parameters, context);
  write_files(folder, outcome.files);
  display.finish();
  print_summary(outcome, folder, display.seconds());
  return kExitOk;
}

}  // namespace sheetform::server
