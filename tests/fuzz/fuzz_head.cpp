// Any bytes as the head of a request: what is accepted keeps every promise that the rest of the server relies
// on.
#include <cstdint>
#include <cstdlib>

#include "server/http/request_head.h"

namespace {

using namespace sheetform::server;

void require(bool good) {
  if (!good) std::abort();
}

bool has_control(const std::string& text) {
  for (const char c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) return true;
  return false;
}

void check_path(const std::string& path) {
  require(!path.empty() && path[0] == '/' && path.size() <= kPathBytes && !has_control(path));
  const std::string closed = path + "/";
  require(closed.find("/../") == std::string::npos && closed.find("/./") == std::string::npos);
  require(path.find("//") == std::string::npos);
}

void check_query(const std::string& text) {
  Query query;
  if (!parse_query(text, query)) return;
  std::string again;
  for (const auto& [name, value] : query) {
    require(!has_control(name) && !has_control(value));
    again += percent_encode(name) + "=" + percent_encode(value) + "&";
  }
  Query same;
  require(parse_query(again, same) && same == query);
}

void check_framing(const RequestHead& head) {
  require(!(head.chunked && head.content_length));
  require(!head.has_body() || (head.method != "GET" && head.method != "HEAD"));
  require(!head.chunked || head.minor_version == 1);
  require(head.minor_version == 0 || head.has("host"));
  require(head.fields.size() <= kHeadFields);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  RequestHead head;
  HeadError error;
  if (!parse_request_head(bytes.substr(0, find_head_end(bytes)), head, error)) {
    require(!error.detail.empty());
    return 0;
  }
  check_path(head.path);
  check_query(head.query);
  check_framing(head);
  return 0;
}
