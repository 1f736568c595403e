// Range, If-Range, If-Match, If-None-Match and If-Modified-Since of any content. Two bytes give the length of
// the file; a line each for the fields.
#include <array>
#include <cstdint>
#include <cstdlib>

#include "server/http/conditional.h"

namespace {

using namespace sheetform::server;

constexpr const char* kTag = "\"sha256-00\"";
constexpr std::array<const char*, 5> kFields{"range", "if-range", "if-match", "if-none-match",
                                             "if-modified-since"};

void require(bool good) {
  if (!good) std::abort();
}

RequestHead head_of(std::string_view text) {
  RequestHead head;
  for (const char* field : kFields) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    if (end > 0) head.fields.emplace_back(field, text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return head;
}

void check_range(const std::string& field, std::uint64_t length) {
  const RangeChoice choice = choose_range(field, length);
  if (choice.kind != RangeChoice::Kind::kPart) return;
  require(choice.range.first <= choice.range.last && choice.range.last < length);
  require(choice.range.length() <= length);
}

void check_date(const std::string& text) {
  if (const auto seconds = parse_http_date(text)) {
    const std::string written = http_date(*seconds);
    if (!written.empty() && written.size() == 29) require(parse_http_date(written) == seconds);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::uint64_t length = data[0] + 256u * data[1];
  const RequestHead head = head_of({reinterpret_cast<const char*>(data) + 2, size - 2});
  check_range(effective_range(head, kTag), length);
  check_range(head.field("range"), UINT64_MAX);
  (void)check_preconditions(head, kTag, 1'700'000'000);
  check_date(head.field("if-modified-since"));
  require(names_tag(kTag, kTag, false));
  return 0;
}
