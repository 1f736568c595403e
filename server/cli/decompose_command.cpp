// `sheetform decompose MESH -o DIR ...`: one run in this process, files into a folder.
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <thread>

#include "server/base/file_output.h"
#include "server/cli/commands.h"
#include "server/cli/progress_display.h"
#include "server/mapping/errors.h"
#include "server/mapping/parameters.h"
#include "server/mapping/run.h"

namespace sheetform::server {
namespace {

constexpr std::uint64_t kLargestFile = std::uint64_t{256} << 20;

std::atomic<bool> stop_requested{false};
void request_stop(int) { stop_requested = true; }

std::string option_text(const api::ParameterDefinition& d) {
  std::string text = d.text + " Takes " + d.values();
  if (!d.unit.empty()) text += " (" + d.unit + ")";
  if (d.default_value.is_null()) return text + ".";
  std::string value = api::dump(d.default_value);
  if (d.default_value.is_boolean()) value = d.default_value.get<bool>() ? "on" : "off";
  if (d.default_value.is_string()) value = d.default_value.get<std::string>();
  return text + "; default " + value + ".";
}

std::string value_name(const api::ParameterDefinition& d) {
  switch (d.type) {
    case api::ParameterType::kNumber:
      return d.unit == "mm" ? "MM" : "NUMBER";
    case api::ParameterType::kInteger:
      return "N";
    case api::ParameterType::kBoolean:
      return "on|off";
    case api::ParameterType::kNumberOrOff:
      return "DEGREES|off";
    case api::ParameterType::kPlane:
      return "off|auto|NX,NY,NZ,D";
    case api::ParameterType::kChoice:
      break;
  }
  std::string text;
  for (const std::string& choice : d.choices) text += (text.empty() ? "" : "|") + choice;
  return text;
}

/// The parameters named on the line, by wire name, in wire types.
api::Json given_parameters(const ParsedLine& line) {
  if (line.has("--scale") && line.has("--target-size"))
    throw Error(ErrorCode::kInvalidParameter, "both --scale and --target-size are given", "--target-size",
                "give one of them");
  if (line.has("--field"))
    throw Error(ErrorCode::kInvalidParameter,
                "a direction field from a file is not supported by this version", "--field",
                "leave it out; the field is then computed from the mesh");
  api::Json values = api::Json::object();
  for (const api::ParameterDefinition& d : api::parameter_definitions()) {
    if (!line.has(d.flag())) continue;
    try {
      values[d.name] = api::parameter_from_text(d, line.get(d.flag()));
    } catch (const api::InvalidParameter& e) {
      throw Error(ErrorCode::kInvalidParameter, e.what(), d.flag(), e.fix());
    }
  }
  return values;
}

int thread_count(const ParsedLine& line) {
  if (line.has("--threads"))
    return static_cast<int>(whole_number("--threads", line.get("--threads"), 1, 1024));
  const unsigned cores = std::thread::hardware_concurrency();
  return cores > 0 ? static_cast<int>(cores) : 1;
}

RunContext context_for(const ParsedLine& line, ProgressDisplay& display) {
  RunContext context;
  context.cancelled = &stop_requested;
  context.threads = thread_count(line);
  context.progress = [&display](Stage stage, double fraction, const std::string& message) {
    display.show(to_string(stage), fraction, message);
  };
  return context;
}

std::string percent(double fraction) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g %%", fraction * 100);
  return text;
}

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
  spec.options = {{"--output", "DIR", "Folder of the result; made when it is not there. Required.", "-o"}};
  for (const api::ParameterDefinition& d : api::parameter_definitions())
    spec.options.push_back({d.flag(), value_name(d), option_text(d), ""});
  spec.options.push_back({"--field", "FILE", "A cross field to follow instead of the computed one.", ""});
  spec.options.push_back(
      {"--threads", "N", "Threads to use; the result does not depend on it. Default: one a core.", ""});
  spec.options.push_back({"--quiet", "", "No progress.", "-q"});
  return spec;
}

int decompose_command(const ParsedLine& line) {
  if (!line.has("--output"))
    throw Error(ErrorCode::kInvalidParameter, "no folder for the result is given", "-o", "add -o DIR");
  const api::Json parameters = understood_parameters(given_parameters(line));
  const std::string path = line.operands[0], folder = line.get("--output");
  std::signal(SIGINT, request_stop);
  std::signal(SIGTERM, request_stop);
  ProgressDisplay display(stderr, ::isatty(STDERR_FILENO) == 1, line.has("--quiet"));
  RunContext context = context_for(line, display);
  const std::string bytes = read_input_file(path, kLargestFile);
  const Outcome outcome =
      run_decomposition(bytes, std::filesystem::path(path).filename().string(), parameters, context);
  write_files(folder, outcome.files);
  display.finish();
  print_summary(outcome, folder, display.seconds());
  return kExitOk;
}

}  // namespace sheetform::server
