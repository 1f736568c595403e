// The description of the process `decompose`, made from the schema of the parameters.
#pragma once
#include <string>
#include <vector>

#include "sheetform_api/json_text.h"

namespace sheetform::api {

inline constexpr const char* kDecompose = "decompose";
inline constexpr const char* kMeshMediaTypes[] = {"application/octet-stream", "model/obj", "model/stl",
                                                  "application/x-ply", "model/off"};

/// A file that a result may hold.
struct OutputDefinition {
  const char* name;
  const char* media_type;
  const char* title;
};
const std::vector<OutputDefinition>& output_definitions();
/// Title of a result file; empty for names not in the list.
std::string output_title(const std::string& name);

/// OGC process summary and full process. `root` is the path of the API, `version` that of the program.
Json process_summary(const std::string& root, const std::string& version);
OrderedJson process_description(const std::string& root, const std::string& version);

}  // namespace sheetform::api
