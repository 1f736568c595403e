#include "sheetform/search/flatten.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

namespace sheetform {
namespace {

constexpr int kRounds = 40;
constexpr double kLeastHeight = 0.1;  // of what a triangle had

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

// Twice its area.
Vector3 normal_of(const std::array<int, 3>& t, const std::vector<Vector3>& points) {
  return (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
}

bool collapses(const std::array<int, 3>& t, const std::vector<Vector3>& before,
               const std::vector<Vector3>& after) {
  return normal_of(t, before).dot(normal_of(t, after)) <= 0 ||
         smallest_height(t, after) < kLeastHeight * smallest_height(t, before);
}

}  // namespace

void flatten(const std::vector<std::vector<int>>& patches, const std::vector<std::array<int, 3>>& triangles,
             const std::vector<char>& on_plane, double slack, std::vector<Vector3>& points) {
  std::vector<const std::vector<int>*> flat;
  std::vector<Plane> planes;
  for (const std::vector<int>& patch : patches) {
    if (patch.size() < 3) continue;
    const Plane plane = fitted(patch, points);
    if (worst(plane, patch, points) <= slack) flat.push_back(&patch), planes.push_back(plane);
  }
  std::vector<char> stays(points.size(), 0);
  for (bool again = true; again;) {
    // The planes stay; a point of several goes to where they meet.
    std::vector<Vector3> moved = points;
    for (int round = 0; round < kRounds; ++round)
      for (std::size_t k = 0; k < flat.size(); ++k)
        for (int i : *flat[k]) {
          if (stays[i]) continue;
          moved[i] -= planes[k].height(moved[i]) * planes[k].normal;
          if (!on_plane.empty() && on_plane[i]) moved[i].x() = 0;
        }
    again = false;
    for (const auto& t : triangles)
      if (collapses(t, points, moved))
        for (int i : t) again |= !std::exchange(stays[i], 1);
    if (!again) points = std::move(moved);
  }
}

}  // namespace sheetform
