#include "sheetform/ruling/follow_crosses.h"

#include <cmath>

namespace sheetform {
namespace {

constexpr double kSays = 0.05;  // strength from which on the direction of least curvature chooses the arm

}  // namespace

void follow_crosses(const SurfaceMesh& mesh, const std::vector<Vector3>& crosses, SurfaceGuide& guide) {
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Vector3& normal = guide.normal[f];
    Vector3 wanted = guide.strength[f] > kSays ? guide.ruling_direction[f] : Vector3(Vector3::Zero());
    Vector3 sum = Vector3::Zero();
    for (int v : mesh.faces[f]) {
      const Vector3 arm = crosses[v] - normal * normal.dot(crosses[v]);
      if (!(arm.norm() > 1e-6 * crosses[v].norm())) continue;
      if (wanted.isZero(0)) wanted = arm;
      const Vector3 a = arm.normalized(), b = normal.cross(a);
      const Vector3& nearest = std::abs(a.dot(wanted)) >= std::abs(b.dot(wanted)) ? a : b;
      sum += nearest.dot(wanted) >= 0 ? nearest : Vector3(-nearest);
    }
    if (!(sum.norm() > 0.5)) continue;
    guide.ruling_direction[f] = sum.normalized();
    guide.strength[f] = 1;
  }
}

}  // namespace sheetform
