// The parameters of a decomposition as proto/schemas/parameters.schema.json defines them: the one definition
// that the server, the command line, the page and the documentation are made from.
#pragma once
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "sheetform_api/json_text.h"

namespace sheetform::api {

enum class ParameterType {
  kNumber,
  kInteger,
  kBoolean,      ///< on or off
  kChoice,       ///< one of `choices`
  kNumberOrOff,  ///< a number, or the text "off"
  kPlane,        ///< one of `choices`, or the text NX,NY,NZ,D
};

struct ParameterDefinition {
  std::string name;         ///< as on the wire, e.g. "e_max"
  std::string title, text;  ///< for people
  std::string unit, group;
  ParameterType type = ParameterType::kNumber;
  std::optional<double> minimum, maximum;
  bool exclusive_minimum = false;
  std::vector<std::string> choices;
  Json default_value;  ///< null: none
  bool advanced = false;
  int order = 0;
  Json schema;  ///< the property itself

  std::string flag() const;    ///< on the command line, e.g. "--e-max"
  std::string values() const;  ///< what it takes, for people, e.g. "a number above 0, at most 0.5"
};

struct ParameterGroup {
  std::string id, title, text;
};

/// A parameter is unknown, of the wrong type or out of range.
class InvalidParameter : public std::runtime_error {
 public:
  InvalidParameter(std::string name, const std::string& what, std::string fix)
      : std::runtime_error(what), name_(std::move(name)), fix_(std::move(fix)) {}
  const std::string& name() const { return name_; }
  const std::string& fix() const { return fix_; }

 private:
  std::string name_, fix_;
};

/// The schema as it stands in the file.
std::string_view parameter_schema_text();
const Json& parameter_schema();
/// In their order for people.
const std::vector<ParameterDefinition>& parameter_definitions();
const std::vector<ParameterGroup>& parameter_groups();
/// nullptr when there is none of that name.
const ParameterDefinition* find_parameter(std::string_view name);

/// The typed value of a text, as a query or a command line gives it ("0.02", "on", "auto"); checked.
/// Throws InvalidParameter.
Json parameter_from_text(const ParameterDefinition& definition, std::string_view text);

/// Values by name. Checks names, types and ranges, and fills in the defaults. Parameters without value and
/// default are absent from the answer; null stands for absent. Throws InvalidParameter.
Json complete_parameters(const Json& given);
/// What an unknown name may stand for, by names and titles: "scale (Millimetres for one unit)" for "units".
/// Empty: nothing is like it.
std::string similar_parameters(std::string_view name);
/// Whether who writes the name `wanted` may mean `known`: it is part of that name or of its title, or few
/// letters differ. Words of less than three letters mean nothing.
bool may_mean(std::string_view wanted, std::string_view known, std::string_view title);

// A sweep has the same parameters, but for the tolerance: e_max is a list, and e_max_mm is none of them.

inline constexpr const char* kTolerance = "e_max";
inline constexpr std::size_t kSweepPoints = 10;  ///< most tolerances of one sweep

bool is_sweep_parameter(std::string_view name);
Json sweep_tolerances_schema();
/// Tolerances from a text: "0.05,0.02,0.01". Throws InvalidParameter.
Json sweep_tolerances_from_text(std::string_view text);
/// As complete_parameters; the tolerances come out ascending. Throws InvalidParameter.
Json complete_sweep_parameters(const Json& given);

}  // namespace sheetform::api
