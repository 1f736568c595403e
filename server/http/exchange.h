// One request as the handlers see it.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "server/http/answer.h"
#include "server/http/body_reader.h"
#include "server/http/principal.h"
#include "server/http/request_head.h"

namespace sheetform::server {

struct Exchange {
  const RequestHead& head;
  BodyReader& body;
  std::string peer;  ///< address of the other side
  std::string request_id;
  Query query;
  std::vector<std::string> captures;  ///< what stood for {...} in the route
  Principal principal;                ///< who asks

  /// Value of a query parameter, none when it is absent. Given twice: Refusal kInvalidQueryParameter.
  std::optional<std::string> parameter(const std::string& name) const;
  /// The jobs that this principal may see: none = all, else those of this id.
  std::optional<std::int64_t> visible() const;
};

}  // namespace sheetform::server
