#include "sheetform_api/api_description.h"

#include "sheetform_api/parameter_schema.h"

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

std::string build_description() {
  OrderedJson description = OrderedJson::parse(sheetform_openapi_begin, sheetform_openapi_end);
  description["components"]["schemas"]["Parameters"] =
      in_openapi_words(OrderedJson::parse(parameter_schema_text()));
  return dump(description);
}

}  // namespace

const std::string& api_description() {
  static const std::string text = build_description();
  return text;
}

}  // namespace sheetform::api
