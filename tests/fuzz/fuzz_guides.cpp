// Any bytes as the strokes that a user has drawn: read or refused with words, never more.
#include <cstdint>
#include <cstdlib>

#include "server/mapping/guides_file.h"
#include "sheetform/base/error.h"

namespace {

using namespace sheetform;

void require(bool good) {
  if (!good) std::abort();
}

void check_points(const std::vector<Vector3>& points, std::size_t least) {
  require(points.size() >= least && points.size() <= server::kMostStrokePoints);
  for (const Vector3& p : points) require(p.allFinite());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const UserGuides guides = server::read_guides({reinterpret_cast<const char*>(data), size});
    require(!guides.empty() && guides.seams.size() <= server::kMostStrokes &&
            guides.keep_out.size() <= server::kMostStrokes);
    for (const SeamStroke& s : guides.seams) check_points(s.points, s.closed ? 3 : 2);
    for (const BrushStroke& b : guides.keep_out) check_points(b.points, 1), require(b.radius > 0);
  } catch (const Error& e) {
    require(!e.summary().empty() && !e.where().empty() && !e.fix().empty());
  }
  return 0;
}
