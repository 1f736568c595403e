#include "sheetform_api/api_description.h"

#include "sheetform_api/parameter_schema.h"
#include "sheetform_api/problem.h"

extern "C" const char sheetform_openapi_begin[], sheetform_openapi_end[];

namespace sheetform::api {
namespace {

/// A schema of JSON Schema 2020-12 in the words of OpenAPI 3.0.
OrderedJson in_openapi_words(OrderedJson schema) {
  if (!schema.is_object()) return schema;
  for (const char* unknown : {"$schema", "$id"}) schema.erase(unknown);
  if (schema.contains("const")) {
    schema["enum"] = OrderedJson::array({schema["const"]});
    schema.erase("const");
  }
  if (schema.contains("exclusiveMinimum")) {
    schema["minimum"] = schema["exclusiveMinimum"];
    schema["exclusiveMinimum"] = true;
  }
  for (auto& [name, part] : schema.items()) {
    if (name == "oneOf")
      for (OrderedJson& one : part) one = in_openapi_words(one);
    if (name == "properties")
      for (auto& [key, property] : part.items()) property = in_openapi_words(property);
  }
  return schema;
}

/// All types there are, and what each means.
void list_problems(OrderedJson& type) {
  std::string text = type.value("description", "");
  for (const ProblemKind& kind : problem_kinds()) {
    type["enum"].push_back(type_uri(kind.type));
    text += "\n- `" + std::string(kind.slug) + "` (" + std::to_string(kind.status) + "): " + kind.title;
    if (kind.retryable) text += "; the same request may succeed later";
  }
  type["description"] = text;
}

std::string build_description() {
  OrderedJson description = OrderedJson::parse(sheetform_openapi_begin, sheetform_openapi_end);
  description["components"]["schemas"]["Parameters"] =
      in_openapi_words(OrderedJson::parse(parameter_schema_text()));
  list_problems(description["components"]["schemas"]["Problem"]["properties"]["type"]);
  return dump(description);
}

}  // namespace

const std::string& api_description() {
  static const std::string text = build_description();
  return text;
}

}  // namespace sheetform::api
