// What a query may hold, as proto/openapi.yaml says it: names, and where it says so, values and ranges.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/http/request_head.h"
#include "sheetform_api/json_text.h"

namespace sheetform::server {

struct QueryRule {
  std::string name;
  std::vector<std::string> values;              ///< empty: any
  std::optional<std::int64_t> lowest, highest;  ///< of a whole number
};

struct QueryRules {
  bool open = false;  ///< the handler knows more names than are listed, and checks all of them itself
  std::vector<QueryRule> list;
};

/// The rules of one operation. Throws std::out_of_range or api::Json::exception when it is not described.
QueryRules query_rules(const api::Json& description, const std::string& method, const std::string& path);

/// Throws Refusal kInvalidQueryParameter, naming the parameter and what it takes.
void check_query(const QueryRules& rules, const Query& query);

}  // namespace sheetform::server
