// Any bytes as a form: the parts do not depend on how the body was cut, and heads come out clean. The first
// line is the Content-Type.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "server/http/multipart.h"

namespace {

using namespace sheetform::server;

struct Heard {
  std::vector<std::string> parts;  ///< name, file name, type and data of each
  int open = 0;
  bool good = false;
  bool operator==(const Heard& other) const {
    // What was heard before a fault may end anywhere.
    return good == other.good && (!good || (parts == other.parts && open == other.open));
  }
};

Heard read(const std::string& boundary, std::string_view body, std::size_t piece) {
  Heard heard;
  MultipartReader reader(boundary,
                         {[&](const PartHead& h) {
                            if (heard.open++ != 0) std::abort();  // a part within a part
                            heard.parts.push_back(h.name + "\n" + h.filename + "\n" + h.content_type + "\n");
                          },
                          [&](std::string_view d) {
                            if (heard.open != 1) std::abort();
                            heard.parts.back() += d;
                          },
                          [&] { --heard.open; }});
  bool good = true;
  for (std::size_t at = 0; good && at < body.size(); at += piece) good = reader.add(body.substr(at, piece));
  heard.good = good && reader.complete();
  if (!heard.good && reader.error().empty()) std::abort();
  if (heard.good && heard.open != 0) std::abort();
  return heard;
}

void check_name(std::string_view bytes) {
  const std::string name = display_name(bytes);
  if (name.size() > 128 || name.find('/') != std::string::npos || name.find('\0') != std::string::npos ||
      (!name.empty() && name[0] == '.') || display_name(name) != name)
    std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), std::min<std::size_t>(size, 4096));
  const std::size_t line = std::min(bytes.find('\n'), bytes.size());
  check_name(bytes);
  const std::string boundary = multipart_boundary(std::string(bytes.substr(0, line)));
  if (boundary.empty()) return 0;
  const std::string_view body = bytes.substr(std::min(line + 1, bytes.size()));
  const Heard whole = read(boundary, body, std::max<std::size_t>(body.size(), 1));
  for (const std::size_t piece : {1, 2, 7})
    if (!(read(boundary, body, piece) == whole)) std::abort();
  return 0;
}
