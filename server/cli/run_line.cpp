#include "server/cli/run_line.h"

#include <atomic>
#include <csignal>
#include <thread>

#include "server/base/file_output.h"
#include "server/base/input_bundle.h"
#include "sheetform/base/error.h"

namespace sheetform::server {
namespace {

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
      return d.unit == "mm" ? "MM|off" : "DEGREES|off";
    case api::ParameterType::kPlane:
      return "off|auto|NX,NY,NZ,D";
    case api::ParameterType::kChoice:
      break;
  }
  std::string text;
  for (const std::string& choice : d.choices) text += (text.empty() ? "" : "|") + choice;
  return text;
}

int thread_count(const ParsedLine& line) {
  if (line.has("--threads"))
    return static_cast<int>(whole_number("--threads", line.get("--threads"), 1, 1024));
  const unsigned cores = std::thread::hardware_concurrency();
  return cores > 0 ? static_cast<int>(cores) : 1;
}

// The file that an option names, empty without the option.
std::string read_beside(const ParsedLine& line, const std::string& option, std::size_t most,
                        const std::string& fix) {
  if (!line.has(option)) return {};
  std::string bytes = read_input_file(line.get(option), most);
  if (bytes.empty()) throw Error(ErrorCode::kInvalidParameter, "the file is empty", option, fix);
  return bytes;
}

}  // namespace

std::vector<OptionSpec> run_options() {
  std::vector<OptionSpec> options = {
      {"--output", "DIR", "Folder of the result; made when it is not there. Required.", "-o"}};
  for (const api::ParameterDefinition& d : api::parameter_definitions())
    options.push_back({d.flag(), value_name(d), option_text(d), ""});
  options.push_back({"--field", "FILE",
                     "A cross field to follow instead of the computed one: one direction for each "
                     "triangle or vertex, as .rosy or JSON.",
                     ""});
  options.push_back(
      {"--guides", "FILE",
       "Strokes drawn on the mesh, as JSON: lines that become seams, and brush strokes where no "
       "seam is wanted.",
       ""});
  options.push_back(
      {"--threads", "N", "Threads to use; the result does not depend on it. Default: one a core.", ""});
  options.push_back({"--quiet", "", "No progress.", "-q"});
  return options;
}

api::Json given_parameters(const ParsedLine& line) {
  if (line.has("--scale") && line.has("--target-size"))
    throw Error(ErrorCode::kInvalidParameter, "both --scale and --target-size are given", "--target-size",
                "give one of them");
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

std::string read_run_input(const ParsedLine& line) {
  std::string bytes = read_input_file(line.operands[0], kLargestFile);
  const std::string field =
      read_beside(line, "--field", kFieldFileBytes,
                  "give one direction for each triangle or vertex, or leave the option out");
  const std::string guides =
      read_beside(line, "--guides", kGuidesFileBytes, "give a stroke at least, or leave the option out");
  return bytes + after_mesh(bytes.size(), field, guides);
}

std::string output_folder(const ParsedLine& line) {
  if (!line.has("--output"))
    throw Error(ErrorCode::kInvalidParameter, "no folder for the result is given", "-o", "add -o DIR");
  return line.get("--output");
}

RunContext context_for(const ParsedLine& line, ProgressDisplay& display) {
  std::signal(SIGINT, request_stop);
  std::signal(SIGTERM, request_stop);
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

}  // namespace sheetform::server
