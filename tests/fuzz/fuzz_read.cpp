// Any bytes: a reader gives a sound mesh or an Error, never anything else. SHEETFORM_FUZZ_FORMAT is the name
// hint.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "sheetform/base/error.h"
#include "sheetform/mesh/mesh_io.h"

namespace {

void check(const sheetform::MeshFile& file, const sheetform::ReadLimits& limits) {
  if (file.soup.faces.empty() || file.polygon.size() != file.soup.faces.size()) std::abort();
  if (file.soup.points.size() > limits.vertices || file.soup.faces.size() > limits.faces) std::abort();
  for (const auto& f : file.soup.faces)
    for (const int v : f)
      if (v < 0 || static_cast<std::size_t>(v) >= file.soup.points.size()) std::abort();
  for (const auto& p : file.soup.points)
    for (const double x : p)
      if (!(std::abs(x) <= limits.coordinate)) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const sheetform::ReadLimits limits;
  try {
    check(sheetform::read_mesh(bytes, SHEETFORM_FUZZ_FORMAT, limits), limits);
  } catch (const sheetform::Error& e) {
    if (e.code() == sheetform::ErrorCode::kInternal || e.summary().empty()) std::abort();
  }
  return 0;
}
