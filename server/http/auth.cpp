#include "server/http/auth.h"

#include <arpa/inet.h>

#include <algorithm>

#include "server/http/field_text.h"

namespace sheetform::server {
namespace {

std::string cookie_value(const std::string& field) {
  const std::string wanted = std::string(kSessionCookie) + "=";
  for (std::size_t at = 0; at < field.size();) {
    const std::size_t end = std::min(field.find(';', at), field.size());
    std::string one = field.substr(at, end - at);
    one.erase(0, std::min(one.find_first_not_of(' '), one.size()));
    if (one.rfind(wanted, 0) == 0) return one.substr(wanted.size());
    at = end + 1;
  }
  return {};
}

bool is_address(const std::string& host) {
  in6_addr room{};
  return ::inet_pton(AF_INET, host.c_str(), &room) == 1 || ::inet_pton(AF_INET6, host.c_str(), &room) == 1;
}

}  // namespace

std::string token_of(const RequestHead& head) {
  const std::string authorization = head.field("authorization");
  if (lower(std::string_view(authorization).substr(0, 7)) == "bearer ") return authorization.substr(7);
  if (head.has("x-api-key")) return head.field("x-api-key");
  return cookie_value(head.field("cookie"));
}

std::string host_name(const std::string& host_field) {
  std::string host = lower(host_field);
  if (!host.empty() && host.front() == '[') return host.substr(1, std::min(host.find(']'), host.size()) - 1);
  return host.substr(0, host.find(':'));
}

bool host_allowed(const AuthOptions& options, const RequestHead& head) {
  const std::string host = host_name(head.field("host"));
  return options.hosts.empty() || options.hosts.count(host) != 0 || (options.any_address && is_address(host));
}

bool origin_allowed(const AuthOptions& options, const RequestHead& head) {
  if (!head.has("origin")) return true;
  const std::string origin = lower(head.field("origin")), host = lower(head.field("host"));
  return origin == "http://" + host || origin == "https://" + host || options.origins.count(origin) != 0;
}

}  // namespace sheetform::server
