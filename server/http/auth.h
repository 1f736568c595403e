// Who asks: tokens, the page's cookie, hosts and origins that are ours.
#pragma once
#include <optional>
#include <set>
#include <string>

#include "server/http/request_head.h"
#include "server/store/job_store.h"

namespace sheetform::server {

inline constexpr const char* kSessionCookie = "sheetform_session";

struct AuthOptions {
  bool needed = false;            ///< requests without a token are refused
  std::set<std::string> hosts;    ///< names that Host may have, lower case, without port; empty: any
  std::set<std::string> origins;  ///< allowed besides the server's own
};

/// A new token, to be shown once: sf_<id>_<secret>. Fills id and hash of the principal.
std::string make_token(Principal& principal);

/// The token that a request carries: Authorization: Bearer, X-Api-Key, or the cookie. Empty when there is
/// none.
std::string token_of(const RequestHead& head);

/// The principal of a token; none when it is wrong or disabled. The time does not tell how wrong.
std::optional<Principal> principal_of(const JobStore& store, const std::string& token);

/// Host without port, lower case; brackets of IPv6 kept off.
std::string host_name(const std::string& host_field);

/// Whether Host is one of ours: stops pages of others whose name was pointed at this machine (DNS rebinding).
bool host_allowed(const AuthOptions& options, const RequestHead& head);

/// Whether a request that changes something may come from where it says it comes: no Origin, our own, or
/// allowed.
bool origin_allowed(const AuthOptions& options, const RequestHead& head);

}  // namespace sheetform::server
