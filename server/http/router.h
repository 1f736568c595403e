// From method and path to a handler. A list of templates, no regular expressions.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "server/http/exchange.h"
#include "server/http/query_rules.h"

namespace sheetform::server {

using Handler = std::function<Answer(Exchange&)>;

struct Route {
  std::string method;  ///< GET also answers HEAD
  std::string path;    ///< with {name} for one segment
  std::string scope;   ///< what a principal needs; empty: nothing, not even a token
  Handler handler;
  QueryRules query = {};
};

struct RouteMatch {
  const Route* route = nullptr;  ///< none: 404, or 405 when `allowed` is not empty
  std::vector<std::string> captures;
  std::string allowed;  ///< methods of this path, for the header Allow
};

class Router {
 public:
  void add(Route route) { routes_.push_back(std::move(route)); }
  RouteMatch match(const std::string& method, const std::string& path) const;
  /// Fills in what the query of each route may hold. Throws when one is not described.
  void describe(const api::Json& description);
  const std::vector<Route>& routes() const { return routes_; }

 private:
  std::vector<Route> routes_;
};

}  // namespace sheetform::server
