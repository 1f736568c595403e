// Who asks: tokens, the page's cookie, hosts and origins that are ours.
#pragma once
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "server/http/principal.h"
#include "server/http/request_head.h"
#include "server/http/token_file.h"
#include "server/store/job_store.h"

namespace sheetform::server {

inline constexpr const char* kSessionCookie = "sheetform_session";

struct AuthOptions {
  bool needed = false;            ///< requests without a token are refused
  std::set<std::string> hosts;    ///< names that Host may have, lower case, without port; empty: any
  bool any_address = false;       ///< Host may also be any IP address: nobody can make one point elsewhere
  std::set<std::string> origins;  ///< allowed besides the server's own
};

/// The token that a request carries: Authorization: Bearer, X-Api-Key, or the cookie. Empty when there is
/// none.
std::string token_of(const RequestHead& head);

/// Knows the tokens, and which of them owns which jobs.
class Gatekeeper {
 public:
  Gatekeeper(JobStore& store, std::filesystem::path tokens, std::string secret)
      : store_(store), tokens_(std::move(tokens), std::move(secret)) {}
  bool any_token() const { return tokens_.any(); }
  /// None when the token is wrong.
  std::optional<Principal> find(const std::string& token);

 private:
  JobStore& store_;
  TokenRegister tokens_;
  std::mutex mutex_;
  std::map<std::string, std::int64_t> ids_;  ///< by name
};

/// Host without port, lower case; brackets of IPv6 kept off.
std::string host_name(const std::string& host_field);

/// Whether Host is one of ours: stops pages of others whose name was pointed at this machine (DNS rebinding).
bool host_allowed(const AuthOptions& options, const RequestHead& head);

/// Whether a request that changes something may come from where it says it comes: no Origin, our own, or
/// allowed.
bool origin_allowed(const AuthOptions& options, const RequestHead& head);

}  // namespace sheetform::server
