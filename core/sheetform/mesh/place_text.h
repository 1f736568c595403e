// Places as words.
#pragma once
#include <string>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// A place for people, and for programs that mark it: "(12.5, 0, -3.25)", seven significant digits.
std::string text_of(const Vector3& place);

}  // namespace sheetform
