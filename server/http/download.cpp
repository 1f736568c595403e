#include "server/http/download.h"

#include "server/base/digest.h"
#include "server/base/identity.h"
#include "server/http/conditional.h"
#include "server/http/request_head.h"
#include "server/jobs/refusal.h"

namespace sheetform::server {
namespace {

using api::ProblemType;

bool may_be_shown(const std::string& type) {
  return type == "image/svg+xml" || type == "application/pdf" || type == "application/json";
}

/// RFC 6266: a plain name for all, and the whole name in UTF-8.
std::string disposition(const Download& d) {
  std::string plain;
  for (const char c : d.filename)
    plain += c == ' ' || percent_encode(std::string_view(&c, 1), "-_.").size() == 1 ? c : '_';
  const std::string kind = d.inline_wanted && may_be_shown(d.media_type) ? "inline" : "attachment";
  return kind + "; filename=\"" + plain + "\"; filename*=UTF-8''" + percent_encode(d.filename, "-_.");
}

void describe(Answer& answer, const Download& d, const std::string& tag) {
  if (d.modified) answer.with("Last-Modified", http_date(*d.modified));
  answer.with("ETag", tag)
      .with("Accept-Ranges", "bytes")
      .with("Cache-Control", d.modified ? "private, max-age=31536000, immutable" : "private, no-cache")
      .with("Repr-Digest", "sha-256=:" + to_base64(d.digest) + ":");
}

void add_content(Answer& answer, const Download& d, const ByteRange& range) {
  answer.media_type = d.media_type;
  answer.pieces = std::make_shared<PiecewiseContent>();
  answer.pieces->length = d.bytes == 0 ? 0 : range.length();
  answer.pieces->read = [read = d.read, first = range.first](std::uint64_t offset, std::uint64_t most) {
    return read(first + offset, most);
  };
  answer.with("Content-Disposition", disposition(d));
  // A drawing that is shown must not run anything, whatever it holds.
  answer.with("Content-Security-Policy", "sandbox; default-src 'none'; style-src 'unsafe-inline'");
}

Answer no_such_range(const Exchange& x, std::uint64_t bytes) {
  api::Problem problem;
  problem.type = ProblemType::kRangeNotSatisfiable;
  problem.detail = "the file has " + std::to_string(bytes) + " bytes";
  problem.where = "Range";
  problem.instance = x.head.path;
  problem.request_id = x.request_id;
  return problem_answer(problem).with("Content-Range", "bytes */" + std::to_string(bytes));
}

}  // namespace

Answer send_download(const Exchange& x, const Download& d) {
  const std::string tag = "\"sha256-" + to_hex(d.digest) + "\"";
  Answer answer;
  switch (check_preconditions(x.head, tag, d.modified.value_or(std::numeric_limits<std::int64_t>::max()))) {
    case Precondition::kFailed:
      throw Refusal(ProblemType::kPreconditionFailed, "the file is not the one named in If-Match", {},
                    "If-Match");
    case Precondition::kNotModified:
      answer.status = 304;
      describe(answer, d, tag);
      return answer;
    case Precondition::kGo:
      break;
  }
  const RangeChoice choice = choose_range(effective_range(x.head, tag), d.bytes);
  if (choice.kind == RangeChoice::Kind::kUnsatisfiable) return no_such_range(x, d.bytes);
  describe(answer, d, tag);
  const bool part = choice.kind == RangeChoice::Kind::kPart;
  const ByteRange range = part ? choice.range : ByteRange{0, d.bytes == 0 ? 0 : d.bytes - 1};
  answer.status = part ? 206 : 200;
  if (part)
    answer.with("Content-Range", "bytes " + std::to_string(range.first) + "-" + std::to_string(range.last) +
                                     "/" + std::to_string(d.bytes));
  add_content(answer, d, range);
  return answer;
}

bool wants_inline(const Exchange& x) {
  const std::string value = x.parameter("inline").value_or("0");
  if (value != "0" && value != "1")
    throw Refusal(api::ProblemType::kInvalidQueryParameter, "inline is malformed", "give 0 or 1", "inline");
  return value == "1";
}

}  // namespace sheetform::server
