// The descriptions of the processes `decompose` and `sweep`, made from the schema of the parameters.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "sheetform_api/json_text.h"

namespace sheetform::api {

inline constexpr const char* kDecompose = "decompose";
inline constexpr const char* kSweep = "sweep";  ///< the same for several tolerances in one job
inline constexpr const char* kProcesses[] = {kDecompose, kSweep};
inline constexpr const char* kMeshMediaTypes[] = {"application/octet-stream", "model/obj", "model/stl",
                                                  "application/x-ply", "model/off"};

/// A file that a result may hold.
struct OutputDefinition {
  const char* name;
  const char* media_type;
  const char* title;
  bool of_sweep = false;
};
const std::vector<OutputDefinition>& output_definitions();
/// Title of a result file; empty for names not in the list.
std::string output_title(const std::string& name);

/// Name of the file `name` of one point of a sweep: "0.02-layout.svg". `point`: its tolerance as the curve
/// names it.
std::string point_file(const std::string& point, const std::string& name);

bool is_process(std::string_view id);
/// OGC process summary and full process of one of kProcesses. `root` is the path of the API, `version` that
/// of the program.
Json process_summary(const std::string& id, const std::string& root, const std::string& version);
OrderedJson process_description(const std::string& id, const std::string& root, const std::string& version);

}  // namespace sheetform::api
