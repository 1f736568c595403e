// Exports of a stored result: what may be asked for, in words, and the file made of it. Knows both the
// messages and core's exports.
#pragma once
#include <map>
#include <string>
#include <string_view>

#include "server/base/file_output.h"
#include "sheetform_api/json_text.h"

namespace sheetform::server {

/// A file that is wanted of a stored result, by the words of the query.
struct ExportWish {
  std::string format;
  std::map<std::string, std::string> query;
  // Where it comes from, written into every file; all may be empty.
  std::string job, model, input_digest, link;
};

/// Throws Error kInvalidParameter (where: the name in the query, or "format").
void check_export(const ExportWish& wish);
/// Throws Error kInvalidParameter when these are no profiles (core's read_profiles).
void check_profiles(const std::string& json);

/// What can be asked for: formats with their addresses below `root`, and every parameter of the query.
/// profiles: the operator's own, JSON or empty.
api::Json exports_document(const std::string& root, const std::string& profiles);

/// The wish as JSON, for the way to the child process.
api::Json to_json(const ExportWish& wish, const std::string& profiles);
/// Makes the file. Throws Error as core's export_result does, and nlohmann's exceptions for other JSON.
OutputFile run_export(std::string_view ruled_obj, std::string_view layout_json, const api::Json& wish);

}  // namespace sheetform::server
