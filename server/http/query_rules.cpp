#include "server/http/query_rules.h"

#include <algorithm>
#include <cctype>
#include <charconv>

#include "server/jobs/refusal.h"

namespace sheetform::server {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& detail, const std::string& fix) {
  throw Refusal(api::ProblemType::kInvalidQueryParameter, detail, fix, name.substr(0, 60));
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

const api::Json& resolved(const api::Json& description, const api::Json& node) {
  if (!node.contains("$ref")) return node;
  return description.at(api::Json::json_pointer(node.at("$ref").get<std::string>().substr(1)));
}

void add_rule(const api::Json& parameter, QueryRules& rules) {
  if (parameter.at("in") != "query") return;
  const api::Json& schema = parameter.at("schema");
  if (schema.value("type", "") == "object") {
    rules.open = true;
    return;
  }
  QueryRule rule{parameter.at("name"), schema.value("enum", std::vector<std::string>{}), {}, {}};
  if (schema.value("type", "") == "integer") {
    rule.lowest = schema.at("minimum").get<std::int64_t>();
    rule.highest = schema.at("maximum").get<std::int64_t>();
  }
  rules.list.push_back(std::move(rule));
}

void check_value(const QueryRule& rule, const std::string& value) {
  if (!rule.values.empty() && std::find(rule.values.begin(), rule.values.end(), value) == rule.values.end())
    refuse(rule.name, rule.name + " is malformed", "give " + joined(rule.values));
  if (!rule.lowest) return;
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  if (error != std::errc() || end != value.data() + value.size() || number < *rule.lowest ||
      number > *rule.highest)
    refuse(rule.name, rule.name + " is malformed",
           "give a number from " + std::to_string(*rule.lowest) + " to " + std::to_string(*rule.highest));
}

}  // namespace

QueryRules query_rules(const api::Json& description, const std::string& method, const std::string& path) {
  const api::Json& item = description.at("paths").at(path);
  std::string key = method;
  std::transform(key.begin(), key.end(), key.begin(), [](unsigned char c) { return std::tolower(c); });
  QueryRules rules;
  for (const api::Json* owner : {&item, &item.at(key)})
    if (const auto list = owner->find("parameters"); list != owner->end())
      for (const api::Json& parameter : *list) add_rule(resolved(description, parameter), rules);
  return rules;
}

void check_query(const QueryRules& rules, const Query& query) {
  if (rules.open) return;
  std::vector<std::string> known, given;
  for (const QueryRule& rule : rules.list) known.push_back(rule.name);
  for (const auto& [name, value] : query) {
    const auto rule = std::find_if(rules.list.begin(), rules.list.end(),
                                   [&](const QueryRule& r) { return r.name == name; });
    if (rule == rules.list.end())
      refuse(name, "there is no such parameter here",
             known.empty() ? "leave it out; there are none" : "leave it out; there are " + joined(known));
    if (std::find(given.begin(), given.end(), name) != given.end())
      refuse(name, "the parameter is given twice", "give it once");
    check_value(*rule, value);
    given.push_back(name);
  }
}

}  // namespace sheetform::server
