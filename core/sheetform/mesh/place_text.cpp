#include "sheetform/mesh/place_text.h"

#include <cmath>
#include <cstdio>

namespace sheetform {

std::string text_of(const Vector3& place) {
  // What rounding left of a zero says nothing.
  const double least = 1e-9 * place.cwiseAbs().maxCoeff();
  const Vector3 p = place.unaryExpr([least](double x) { return std::abs(x) > least ? x : 0.0; });
  char text[80];
  std::snprintf(text, sizeof text, "(%.7g, %.7g, %.7g)", p.x(), p.y(), p.z());
  return text;
}

}  // namespace sheetform
