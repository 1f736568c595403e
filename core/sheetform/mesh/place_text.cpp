#include "sheetform/mesh/place_text.h"

#include <cstdio>

namespace sheetform {

std::string text_of(const Vector3& place) {
  char text[80];
  std::snprintf(text, sizeof text, "(%.7g, %.7g, %.7g)", place.x(), place.y(), place.z());
  return text;
}

}  // namespace sheetform
