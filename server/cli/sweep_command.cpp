// `sheetform sweep MESH -o DIR --e-max 0.05,0.02,0.01`: one run for several tolerances, a folder for each.
#include <unistd.h>

#include <charconv>

#include "server/base/file_output.h"
#include "server/cli/commands.h"
#include "server/cli/run_line.h"
#include "server/mapping/errors.h"
#include "server/mapping/parameters.h"
#include "server/mapping/run.h"

namespace sheetform::server {
namespace {

constexpr const char* kTolerances = "--e-max";

[[noreturn]] void refuse_tolerances(const std::string& what) {
  throw Error(ErrorCode::kInvalidParameter, what, kTolerances,
              "give fractions of the diagonal with commas between, as in 0.05,0.02,0.01");
}

/// Numbers with commas between; their range is the business of the sweep.
std::vector<double> tolerances(const std::string& text) {
  std::vector<double> values;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    double value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc()) refuse_tolerances("\"" + text + "\" is no list of numbers");
    values.push_back(value);
    if (next == end) return values;
    if (*next != ',') refuse_tolerances("\"" + text + "\" is no list of numbers");
    at = next + 1;
  }
}

void print_curve(const SweepOutcome& outcome) {
  std::printf("%10s %8s %12s %12s\n", "tolerance", "parts", "cut length", "distance");
  for (const api::Json& r : outcome.curve) {
    std::printf("%10s %8d %12.3f %12s%s\n", percent(r.value("e_max", 0.0)).c_str(), r.value("patches", 0),
                r.value("cut_length", 0.0), percent(r.value("hausdorff", 0.0)).c_str(),
                r.value("e_max_met", false) ? "" : "  NOT met");
  }
}

}  // namespace

CommandSpec sweep_spec() {
  CommandSpec spec;
  spec.name = "sweep";
  spec.usage = "MESH -o DIR --e-max LIST [options]";
  spec.text =
      "Decomposes a mesh for several tolerances in one run that shares all work they have in common. Writes "
      "a "
      "folder DIR/TOLERANCE for each, as decompose does, and the curve of parts and cut length against "
      "error: DIR/sweep.csv and DIR/sweep.json.";
  spec.operands = {"MESH"};
  for (OptionSpec& option : run_options()) {
    if (option.name == "--e-max-mm") continue;
    if (option.name == kTolerances)
      option.value = "LIST", option.text =
                                 "Tolerances as fractions of the bounding-box diagonal, commas "
                                 "between: 0.05,0.02,0.01. Required.";
    spec.options.push_back(option);
  }
  return spec;
}

int sweep_command(const ParsedLine& line) {
  const std::string folder = output_folder(line), path = line.operands[0];
  if (!line.has(kTolerances)) refuse_tolerances("no tolerances are given");
  const std::vector<double> e_max = tolerances(line.get(kTolerances));
  ParsedLine others = line;
  others.options.erase(kTolerances);
  const api::Json parameters = understood_parameters(given_parameters(others));
  ProgressDisplay display(stderr, ::isatty(STDERR_FILENO) == 1, line.has("--quiet"));
  RunContext context = context_for(line, display);
  const std::string bytes = read_run_input(line);
  std::vector<SweepStep> steps;
  const SweepOutcome outcome =
      run_sweep(bytes, std::filesystem::path(path).filename().string(), parameters, e_max, context,
                [&](SweepStep step) { steps.push_back(std::move(step)); });
  write_files(folder, outcome.files);
  for (const SweepStep& step : steps)
    write_files(std::filesystem::path(folder) / step.point, step.outcome.files);
  display.finish();
  print_curve(outcome);
  std::printf("%s/sweep.csv, sweep.json and a folder for each tolerance; %.1f s\n", folder.c_str(),
              display.seconds());
  return kExitOk;
}

}  // namespace sheetform::server
