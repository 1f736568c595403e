#include "server/http/auth.h"

#include <algorithm>
#include <cctype>

#include "server/base/digest.h"
#include "server/base/identity.h"

namespace sheetform::server {
namespace {

constexpr std::string_view kPrefix = "sf_";
constexpr std::size_t kIdBytes = 6, kSecretBytes = 32;

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

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

}  // namespace

std::string make_token(Principal& principal) {
  principal.token_id = to_hex(random_bytes(kIdBytes));
  const std::string token =
      std::string(kPrefix) + principal.token_id + "_" + to_hex(random_bytes(kSecretBytes));
  principal.token_hash = sha256(token);
  return token;
}

std::string token_of(const RequestHead& head) {
  const std::string authorization = head.field("authorization");
  if (lower(std::string_view(authorization).substr(0, 7)) == "bearer ") return authorization.substr(7);
  if (head.has("x-api-key")) return head.field("x-api-key");
  return cookie_value(head.field("cookie"));
}

std::optional<Principal> principal_of(const JobStore& store, const std::string& token) {
  const std::size_t id_end = token.find('_', kPrefix.size());
  if (token.rfind(kPrefix, 0) != 0 || id_end == std::string::npos) return std::nullopt;
  const auto principal = store.find_principal(token.substr(kPrefix.size(), id_end - kPrefix.size()));
  const std::string known = principal ? principal->token_hash : std::string(32, '\0');
  return equal_in_constant_time(sha256(token), known) ? principal : std::nullopt;
}

std::string host_name(const std::string& host_field) {
  std::string host = lower(host_field);
  if (!host.empty() && host.front() == '[') return host.substr(1, std::min(host.find(']'), host.size()) - 1);
  return host.substr(0, host.find(':'));
}

bool host_allowed(const AuthOptions& options, const RequestHead& head) {
  return options.hosts.empty() || options.hosts.count(host_name(head.field("host"))) != 0;
}

bool origin_allowed(const AuthOptions& options, const RequestHead& head) {
  if (!head.has("origin")) return true;
  const std::string origin = lower(head.field("origin")), host = lower(head.field("host"));
  return origin == "http://" + host || origin == "https://" + host || options.origins.count(origin) != 0;
}

}  // namespace sheetform::server
