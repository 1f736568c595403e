// The address of an export, "format?query" of any content: options within bounds, or an Error that names the
// word.
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "server/http/request_head.h"
#include "sheetform/base/error.h"
#include "sheetform/blueprint/exports.h"

namespace {

using namespace sheetform;

void check(const ExportRequest& request) {
  const BlueprintOptions& o = request.blueprint;
  for (const double x : {o.sheet_width, o.sheet_height, o.margin, o.gap, o.kerf, o.thickness, o.label_height,
                         o.ruling_step, o.tab_depth, o.tab_pitch, request.pdf.page_margin,
                         request.pdf.overlap, request.frame.radius, request.frame.text_height})
    if (!std::isfinite(x) || std::abs(x) > 1e5) std::abort();
  if (o.copies < 1 || o.copies > 100 || o.turns < 1 || o.turns > 64 || request.sheet < 0) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::size_t mark = std::min(text.find('?'), text.size());
  server::Query pairs;
  if (!server::parse_query(text.substr(std::min(mark + 1, text.size())), pairs)) return 0;
  try {
    check(read_export_request(text.substr(0, mark), {pairs.begin(), pairs.end()}));
  } catch (const Error& e) {
    if (e.code() != ErrorCode::kInvalidParameter || e.summary().empty() || e.where().empty()) std::abort();
  }
  return 0;
}
