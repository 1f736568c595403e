#include "sheetform/search/flatten.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace sheetform {
namespace {

constexpr int kRounds = 40;

struct Plane {
  Vector3 centre, normal;
  double height(const Vector3& p) const { return normal.dot(p - centre); }
};

Plane fitted(const std::vector<int>& patch, const std::vector<Vector3>& points) {
  Plane plane{Vector3::Zero(), Vector3::Zero()};
  for (int i : patch) plane.centre += points[i] / static_cast<double>(patch.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (int i : patch) {
    const Vector3 d = points[i] - plane.centre;
    spread += d * d.transpose();
  }
  plane.normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
  return plane;
}

double worst(const Plane& plane, const std::vector<int>& patch, const std::vector<Vector3>& points) {
  double most = 0;
  for (int i : patch) most = std::max(most, std::abs(plane.height(points[i])));
  return most;
}

}  // namespace

void flatten(const std::vector<std::vector<int>>& patches, const std::vector<char>& on_plane, double slack,
             std::vector<Vector3>& points) {
  std::vector<const std::vector<int>*> flat;
  std::vector<Plane> planes;
  for (const std::vector<int>& patch : patches) {
    if (patch.size() < 3) continue;
    const Plane plane = fitted(patch, points);
    if (worst(plane, patch, points) <= slack) flat.push_back(&patch), planes.push_back(plane);
  }
  // The planes stay; a point of several goes to where they meet.
  for (int round = 0; round < kRounds; ++round)
    for (std::size_t k = 0; k < flat.size(); ++k)
      for (int i : *flat[k]) {
        points[i] -= planes[k].height(points[i]) * planes[k].normal;
        if (!on_plane.empty() && on_plane[i]) points[i].x() = 0;
      }
}

}  // namespace sheetform
