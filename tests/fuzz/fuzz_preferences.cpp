// Prefer, Host, Authorization and Cookie of any content, a line each.
#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdlib>

#include "server/http/auth.h"
#include "server/http/conditional.h"

using namespace sheetform::server;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view text(reinterpret_cast<const char*>(data), size);
  RequestHead head;
  for (const char* field : {"prefer", "host", "authorization", "cookie", "origin"}) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    if (end > 0) head.fields.emplace_back(field, text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  if (const auto wait = preferred_wait(head.field("prefer")); wait && *wait < 0) std::abort();
  const std::string host = host_name(head.field("host"));
  if (std::any_of(host.begin(), host.end(),
                  [](char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }))
    std::abort();
  AuthOptions ours;
  ours.hosts = {"localhost"};
  if (host_allowed(ours, head) && head.has("host") && host != "localhost") std::abort();
  (void)origin_allowed(ours, head);
  (void)token_of(head);
  return 0;
}
