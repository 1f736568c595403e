// Any bytes in the chunked coding: body and end do not depend on how the bytes were cut.
#include <cstdint>
#include <cstdlib>

#include "server/http/body_reader.h"

namespace {

using sheetform::server::ChunkDecoder;

struct Decoded {
  std::string body;
  bool good = true, done = false;
  std::size_t left = 0;
};

Decoded decode(std::string_view bytes, std::size_t piece) {
  Decoded d;
  ChunkDecoder decoder;
  for (std::size_t at = 0; d.good && !decoder.done() && at < bytes.size(); at += piece) {
    std::string_view input = bytes.substr(at, piece);
    d.good = decoder.decode(input, d.body);
    d.left = input.size() + (bytes.size() - std::min(bytes.size(), at + piece));
  }
  d.done = decoder.done();
  return d;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const Decoded whole = decode(bytes, size + 1);
  if (whole.body.size() > size) std::abort();
  for (const std::size_t piece : {1, 3}) {
    const Decoded cut = decode(bytes, piece);
    if (cut.good != whole.good || cut.done != whole.done) std::abort();
    if (whole.done && (cut.body != whole.body || cut.left != whole.left)) std::abort();
  }
  return 0;
}
