// Any bytes as the cross field that a user gives for a mesh of three vertices and two faces: read or refused
// with words, never more.
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "server/mapping/field_file.h"
#include "sheetform/base/error.h"

namespace {

using namespace sheetform;

constexpr std::size_t kVertices = 3, kFaces = 2;

void require(bool good) {
  if (!good) std::abort();
}

void check(const std::vector<Vector3>& directions) {
  for (const Vector3& d : directions) require(d.isZero(0) || std::abs(d.norm() - 1) < 1e-9);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const UserField field =
        server::read_field({reinterpret_cast<const char*>(data), size}, kVertices, kFaces);
    require(field.per_vertex.empty() != field.per_face.empty());
    require(field.per_vertex.empty() || field.per_vertex.size() == kVertices);
    require(field.per_face.empty() || field.per_face.size() == kFaces);
    check(field.per_vertex);
    check(field.per_face);
  } catch (const Error& e) {
    require(!e.summary().empty() && !e.where().empty() && !e.fix().empty());
  }
  return 0;
}
