#include "sheetform_api/parameter_schema.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numeric>

extern "C" const char sheetform_parameters_schema_begin[], sheetform_parameters_schema_end[];

namespace sheetform::api {
namespace {

constexpr std::string_view kOff = "off";

/// Shortest decimal without an exponent; the ranges of the schema are short numbers.
std::string shortest(double value) {
  char text[64];
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::fixed).ptr;
  return std::string(text, end);
}

/// The member of a union that is a number, or null.
const Json& number_part(const Json& schema) {
  static const Json none;
  if (!schema.contains("oneOf")) return schema;
  for (const Json& part : schema["oneOf"])
    if (part.value("type", "") == "number") return part;
  return none;
}

ParameterType type_of(const Json& schema) {
  if (schema.contains("oneOf"))
    return number_part(schema).is_null() ? ParameterType::kPlane : ParameterType::kNumberOrOff;
  if (schema.contains("enum")) return ParameterType::kChoice;
  const std::string type = schema.at("type");
  if (type == "boolean") return ParameterType::kBoolean;
  return type == "integer" ? ParameterType::kInteger : ParameterType::kNumber;
}

std::vector<std::string> choices_of(const Json& schema) {
  if (schema.contains("enum")) return schema["enum"].get<std::vector<std::string>>();
  if (schema.contains("oneOf"))
    for (const Json& part : schema["oneOf"])
      if (part.contains("enum")) return part["enum"].get<std::vector<std::string>>();
  return {};
}

void read_range(const Json& part, ParameterDefinition& definition) {
  if (part.contains("minimum")) definition.minimum = part["minimum"].get<double>();
  if (part.contains("maximum")) definition.maximum = part["maximum"].get<double>();
  if (part.contains("exclusiveMinimum")) {
    definition.minimum = part["exclusiveMinimum"].get<double>();
    definition.exclusive_minimum = true;
  }
}

ParameterDefinition read_definition(const std::string& name, const Json& schema) {
  ParameterDefinition d;
  d.name = name;
  d.title = schema.at("title");
  d.text = schema.at("description");
  d.unit = schema.value("x-unit", "");
  d.group = schema.at("x-group");
  d.type = type_of(schema);
  d.choices = choices_of(schema);
  if (const Json& part = number_part(schema); part.is_object()) read_range(part, d);
  if (schema.contains("default")) d.default_value = schema["default"];
  d.advanced = schema.value("x-advanced", false);
  d.order = schema.at("x-order");
  d.schema = schema;
  return d;
}

std::vector<ParameterDefinition> read_definitions() {
  std::vector<ParameterDefinition> list;
  for (const auto& [name, schema] : parameter_schema().at("properties").items())
    list.push_back(read_definition(name, schema));
  std::sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.order < b.order; });
  return list;
}

bool in_range(const ParameterDefinition& d, double value) {
  if (!std::isfinite(value)) return false;
  if (d.minimum && (d.exclusive_minimum ? value <= *d.minimum : value < *d.minimum)) return false;
  return !d.maximum || value <= *d.maximum;
}

/// Reads the whole text as one number; a leading plus is no number.
bool read_number(std::string_view text, double& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

bool is_plane(std::string_view text) {
  double values[4];
  for (int i = 0; i < 4; ++i) {
    const std::size_t comma = i < 3 ? text.find(',') : text.size();
    if (comma == std::string_view::npos || !read_number(text.substr(0, comma), values[i])) return false;
    if (!std::isfinite(values[i])) return false;
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return std::hypot(values[0], values[1], values[2]) > 0;
}

constexpr std::size_t kLikeLetters = 3;   // shorter words are in too many others
constexpr std::size_t kLongestName = 60;  // nobody means anything by a longer one

/// In lower case, without an s at the end: names and titles are compared by them.
std::string letters_of(std::string_view text) {
  std::string letters;
  for (const char c : text)
    if (std::isalpha(static_cast<unsigned char>(c)))
      letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (!letters.empty() && letters.back() == 's') letters.pop_back();
  return letters;
}

/// Letters to put in, take out or change to make one word of the other.
std::size_t letters_between(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t corner = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t change = corner + (a[i] == b[j] ? 0 : 1);
      corner = row[j + 1];
      row[j + 1] = std::min({change, corner + 1, row[j] + 1});
    }
  }
  return row.back();
}

bool is_choice(const ParameterDefinition& d, const std::string& text) {
  return std::find(d.choices.begin(), d.choices.end(), text) != d.choices.end();
}

bool fits(const ParameterDefinition& d, const Json& value) {
  switch (d.type) {
    case ParameterType::kNumber:
      return value.is_number() && in_range(d, value.get<double>());
    case ParameterType::kInteger:
      return value.is_number_integer() && in_range(d, value.get<double>());
    case ParameterType::kBoolean:
      return value.is_boolean();
    case ParameterType::kChoice:
      return value.is_string() && is_choice(d, value.get<std::string>());
    case ParameterType::kNumberOrOff:
      return value.is_number() ? in_range(d, value.get<double>()) : value == Json(kOff);
    case ParameterType::kPlane:
      return value.is_string() &&
             (is_choice(d, value.get<std::string>()) || is_plane(value.get<std::string>()));
  }
  return false;
}

/// " (mm)", or " (of the diagonal; 0.02 is 2 %)".
std::string unit_text(const ParameterDefinition& d) {
  if (d.unit.empty()) return {};
  return " (" + d.unit + (d.schema.value("x-display", "") == "percent" ? "; 0.02 is 2 %)" : ")");
}

[[noreturn]] void refuse(const ParameterDefinition& d, const std::string& got) {
  throw InvalidParameter(d.name, d.name + " cannot be " + (got.empty() ? "empty" : got.substr(0, 60)),
                         "give " + d.values() + unit_text(d));
}

Json boolean_from_text(const ParameterDefinition& d, std::string_view text) {
  if (text == "on" || text == "true" || text == "1") return true;
  if (text == "off" || text == "false" || text == "0") return false;
  refuse(d, std::string(text));
}

Json number_from_text(const ParameterDefinition& d, std::string_view text) {
  double value = 0;
  if (!read_number(text, value)) refuse(d, std::string(text));
  return value;
}

Json integer_from_text(const ParameterDefinition& d, std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) refuse(d, std::string(text));
  return value;
}

Json value_from_text(const ParameterDefinition& d, std::string_view text) {
  switch (d.type) {
    case ParameterType::kNumber:
      return number_from_text(d, text);
    case ParameterType::kInteger:
      return integer_from_text(d, text);
    case ParameterType::kBoolean:
      return boolean_from_text(d, text);
    case ParameterType::kNumberOrOff:
      if (text != kOff) return number_from_text(d, text);
      return std::string(text);
    case ParameterType::kChoice:
    case ParameterType::kPlane:
      return std::string(text);
  }
  return nullptr;
}

[[noreturn]] void refuse_unknown(const std::string& name) {
  const std::string like = similar_parameters(name);
  throw InvalidParameter(name.substr(0, 60), "there is no parameter " + name.substr(0, 60),
                         (like.empty() ? "" : "you may mean " + like + "; ") +
                             "see the list of parameters; names are written with underscores");
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 < words.size() ? ", " : " or ") + words[i];
  return text;
}

[[noreturn]] void refuse_tolerances(const std::string& what) {
  throw InvalidParameter(kTolerance, what,
                         "give 1 to " + std::to_string(kSweepPoints) +
                             " different fractions of the diagonal, as in e_max=0.05,0.02,0.01");
}

/// Ascending; each is checked as the tolerance of a decomposition.
Json checked_tolerances(const Json& list) {
  if (!list.is_array() || list.empty() || list.size() > kSweepPoints)
    refuse_tolerances("e_max of a sweep is a list of 1 to " + std::to_string(kSweepPoints) + " tolerances");
  for (const Json& value : list)
    if (const ParameterDefinition& d = *find_parameter(kTolerance); !fits(d, value)) refuse(d, dump(value));
  std::vector<double> values = list.get<std::vector<double>>();
  std::sort(values.begin(), values.end());
  if (std::adjacent_find(values.begin(), values.end()) != values.end())
    refuse_tolerances("a tolerance is given twice");
  return values;
}

std::string range_text(const ParameterDefinition& d) {
  std::string text;
  if (d.minimum) text += (d.exclusive_minimum ? " above " : " from ") + shortest(*d.minimum);
  if (d.maximum) text += (!d.minimum || d.exclusive_minimum ? " up to " : " to ") + shortest(*d.maximum);
  return text;
}

}  // namespace

std::string ParameterDefinition::flag() const {
  std::string option = "--" + name;
  std::replace(option.begin(), option.end(), '_', '-');
  return option;
}

std::string ParameterDefinition::values() const {
  switch (type) {
    case ParameterType::kNumber:
      return "a number" + range_text(*this);
    case ParameterType::kInteger:
      return "a whole number" + range_text(*this);
    case ParameterType::kBoolean:
      return "on or off";
    case ParameterType::kChoice:
      return joined(choices);
    case ParameterType::kNumberOrOff:
      return "a number" + range_text(*this) + ", or off";
    case ParameterType::kPlane:
      return joined(choices) + ", or NX,NY,NZ,D";
  }
  return {};
}

std::string_view parameter_schema_text() {
  return {sheetform_parameters_schema_begin,
          static_cast<std::size_t>(sheetform_parameters_schema_end - sheetform_parameters_schema_begin)};
}

const Json& parameter_schema() {
  static const Json schema = Json::parse(parameter_schema_text());
  return schema;
}

const std::vector<ParameterDefinition>& parameter_definitions() {
  static const std::vector<ParameterDefinition> list = read_definitions();
  return list;
}

const std::vector<ParameterGroup>& parameter_groups() {
  static const std::vector<ParameterGroup> list = [] {
    std::vector<ParameterGroup> groups;
    for (const Json& g : parameter_schema().at("x-groups"))
      groups.push_back({g.at("id"), g.at("title"), g.at("text")});
    return groups;
  }();
  return list;
}

const ParameterDefinition* find_parameter(std::string_view name) {
  for (const ParameterDefinition& d : parameter_definitions())
    if (d.name == name) return &d;
  return nullptr;
}

Json parameter_from_text(const ParameterDefinition& definition, std::string_view text) {
  Json value = value_from_text(definition, text);
  if (!fits(definition, value)) refuse(definition, std::string(text));
  return value;
}

bool may_mean(std::string_view wanted, std::string_view known, std::string_view title) {
  const std::string word = letters_of(wanted.substr(0, kLongestName)), name = letters_of(known);
  if (word.size() < kLikeLetters) return false;
  if (name.find(word) != std::string::npos || letters_of(title).find(word) != std::string::npos) return true;
  return letters_between(word, name) <= word.size() / 4 + 1;
}

std::string similar_parameters(std::string_view name) {
  std::string list;
  for (const ParameterDefinition& d : parameter_definitions())
    if (may_mean(name, d.name, d.title)) list += (list.empty() ? "" : ", ") + d.name + " (" + d.title + ")";
  return list;
}

Json complete_parameters(const Json& given) {
  for (const auto& [name, value] : given.items()) {
    const ParameterDefinition* d = find_parameter(name);
    if (d == nullptr) refuse_unknown(name);
    if (!value.is_null() && !fits(*d, value)) refuse(*d, dump(value));
  }
  Json all = Json::object();
  for (const ParameterDefinition& d : parameter_definitions()) {
    const auto found = given.find(d.name);
    if (found != given.end() && !found->is_null())
      all[d.name] = *found;
    else if (!d.default_value.is_null())
      all[d.name] = d.default_value;
  }
  return all;
}

bool is_sweep_parameter(std::string_view name) {
  return name != "e_max_mm" && find_parameter(name) != nullptr;
}

Json sweep_tolerances_schema() {
  Json each = find_parameter(kTolerance)->schema;
  for (const char* word : {"title", "description", "default", "x-group", "x-order"}) each.erase(word);
  const Json& whole = find_parameter(kTolerance)->schema;
  return {{"type", "array"},
          {"items", std::move(each)},
          {"minItems", 1},
          {"maxItems", kSweepPoints},
          {"uniqueItems", true},
          {"x-group", whole.at("x-group")},
          {"x-order", whole.at("x-order")}};
}

Json sweep_tolerances_from_text(std::string_view text) {
  Json list = Json::array();
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    list.push_back(parameter_from_text(*find_parameter(kTolerance), text.substr(at, end - at)));
    at = end + 1;
  }
  return list;
}

Json complete_sweep_parameters(const Json& given) {
  Json others = given;
  others.erase(kTolerance);
  for (const auto& [name, value] : others.items())
    if (!is_sweep_parameter(name) && find_parameter(name) != nullptr)
      throw InvalidParameter(name, name + " is no parameter of a sweep",
                             "give the tolerances as fractions of the diagonal in e_max");
  Json all = complete_parameters(others);
  all[kTolerance] = checked_tolerances(given.value(kTolerance, Json()));
  return all;
}

}  // namespace sheetform::api
