#include "server/http/router.h"

#include <string_view>

namespace sheetform::server {
namespace {

/// Takes the next segment (up to a slash) off the path, which begins with one.
std::string_view take_segment(std::string_view& path) {
  path.remove_prefix(1);
  const std::size_t end = std::min(path.find('/'), path.size());
  const std::string_view segment = path.substr(0, end);
  path.remove_prefix(end);
  return segment;
}

bool fits(std::string_view pattern, std::string_view path, std::vector<std::string>& captures) {
  captures.clear();
  while (!pattern.empty() && !path.empty()) {
    const std::string_view wanted = take_segment(pattern), given = take_segment(path);
    if (!wanted.empty() && wanted.front() == '{') {
      if (given.empty()) return false;
      captures.emplace_back(given);
    } else if (wanted != given) {
      return false;
    }
  }
  return pattern.empty() && path.empty();
}

}  // namespace

void Router::describe(const api::Json& description) {
  for (Route& route : routes_) {
    const bool described = description.at("paths").contains(route.path);
    route.query = query_rules(description, route.method, described ? route.path : route.path + "/");
  }
}

RouteMatch Router::match(const std::string& method, const std::string& path) const {
  RouteMatch match;
  for (const Route& route : routes_) {
    std::vector<std::string> captures;
    if (!fits(route.path, path, captures)) continue;
    match.allowed +=
        (match.allowed.empty() ? "" : ", ") + route.method + (route.method == "GET" ? ", HEAD" : "");
    if (route.method != method && !(route.method == "GET" && method == "HEAD")) continue;
    match.route = &route;
    match.captures = std::move(captures);
  }
  return match;
}

}  // namespace sheetform::server
