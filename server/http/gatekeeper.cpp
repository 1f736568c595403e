#include "server/http/auth.h"

namespace sheetform::server {

std::optional<Principal> Gatekeeper::find(const std::string& token) {
  const std::optional<TokenRecord> record = tokens_.find(token);
  if (!record) return std::nullopt;
  const std::lock_guard lock(mutex_);
  auto known = ids_.find(record->name);
  // The number first: a store that cannot give one must not leave an entry behind.
  if (known == ids_.end()) known = ids_.emplace(record->name, store_.principal_id(record->name)).first;
  return Principal{known->second, record->name, record->scopes};
}

}  // namespace sheetform::server
