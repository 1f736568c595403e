#include "sheetform/mesh/symmetry.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "sheetform/mesh/sample.h"

namespace sheetform {
namespace {

constexpr int kVoters = 600, kScouts = 250, kPairs = 1000,
              kJudges = 5000;                   // samples: voting, approach, polish, verdict
constexpr int kDirections = 20, kOffsets = 48;  // bins: a side of a cube's face; half the diagonal each way
constexpr int kWinners = 16, kMostPlanes = 8;
constexpr int kFarSteps = 5, kNearSteps = 12;
constexpr double kMostMean = 0.002, kMostP99 = 0.01;  // of the diagonal
constexpr double kHopeless = 0.02;                    // mean after a few steps
constexpr double kTrim = 0.9;                         // share of the pairs that are used, the nearest ones

struct MirrorPlane {
  Vector3 normal = Vector3::UnitX();
  double offset = 0;
  Vector3 mirrored(const Vector3& p) const { return p - 2 * (normal.dot(p) - offset) * normal; }
};

MirrorPlane oriented(MirrorPlane plane) {
  int axis = 0;
  plane.normal.cwiseAbs().maxCoeff(&axis);
  if (plane.normal[axis] < 0) plane.normal = -plane.normal, plane.offset = -plane.offset;
  return plane;
}

Vector3 centre_of(const std::vector<SurfaceSample>& samples) {
  Vector3 sum = Vector3::Zero();
  for (const SurfaceSample& s : samples) sum += s.point;
  return sum / static_cast<double>(samples.size());
}

std::vector<MirrorPlane> principal_planes(const std::vector<SurfaceSample>& samples) {
  const Vector3 centre = centre_of(samples);
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const SurfaceSample& s : samples) moments += (s.point - centre) * (s.point - centre).transpose();
  const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments).eigenvectors();
  std::vector<MirrorPlane> planes;
  for (int k = 0; k < 3; ++k) planes.push_back({axes.col(k), axes.col(k).dot(centre)});
  return planes;
}

// Counts planes in bins of direction (half of a cube's faces) and offset from the centre.
class Ballot {
 public:
  Ballot(const Vector3& centre, double reach)
      : centre_(centre), reach_(reach), bins_(3 * kDirections * kDirections * kOffsets) {}

  void vote(const MirrorPlane& raw) {
    const MirrorPlane plane = oriented(raw);
    int axis = 0;
    plane.normal.maxCoeff(&axis);
    const double u = plane.normal[(axis + 1) % 3] / plane.normal[axis],
                 v = plane.normal[(axis + 2) % 3] / plane.normal[axis];
    const double offset = (plane.offset - plane.normal.dot(centre_)) / reach_;
    const int bin =
        ((axis * kDirections + slot(u, kDirections)) * kDirections + slot(v, kDirections)) * kOffsets +
        slot(offset, kOffsets);
    Bin& b = bins_[static_cast<std::size_t>(bin)];
    ++b.votes;
    b.normal += plane.normal;
    b.offset += plane.offset;
  }

  std::vector<MirrorPlane> winners(int count) const {
    std::vector<int> order(bins_.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return bins_[a].votes > bins_[b].votes; });
    std::vector<MirrorPlane> planes;
    for (int i = 0; i < count && bins_[order[i]].votes > 1; ++i) {
      const Bin& b = bins_[order[i]];
      const double length = b.normal.norm();
      planes.push_back({b.normal / length, b.offset / b.votes});
    }
    return planes;
  }

 private:
  struct Bin {
    int votes = 0;
    Vector3 normal = Vector3::Zero();
    double offset = 0;
  };
  static int slot(double x, int slots) {
    return std::clamp(static_cast<int>((x + 1) / 2 * slots), 0, slots - 1);
  }

  Vector3 centre_;
  double reach_;
  std::vector<Bin> bins_;
};

// Every pair of samples whose normals mirror each other votes for the plane between its points.
std::vector<MirrorPlane> voted_planes(const std::vector<SurfaceSample>& samples, double diagonal) {
  Ballot ballot(centre_of(samples), diagonal / 2);
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Vector3 d = samples[i].point - samples[j].point;
      const double length = d.norm();
      if (length < 0.02 * diagonal) continue;
      const Vector3 n = d / length;
      const Vector3 image = samples[j].normal - 2 * n.dot(samples[j].normal) * n;
      if ((image - samples[i].normal).squaredNorm() > 0.06) continue;  // 14 degrees
      ballot.vote({n, n.dot(samples[i].point + samples[j].point) / 2});
    }
  return ballot.winners(kWinners);
}

struct Pair {
  Vector3 from, to, normal;  // normal: of the mesh at `to`
  double distance2;
};

// The plane whose mirror image of all `from` is nearest to the `to` (least squares, closed form).
MirrorPlane best_plane(const std::vector<Pair>& pairs) {
  Vector3 from = Vector3::Zero(), to = Vector3::Zero();
  for (const Pair& p : pairs) from += p.from, to += p.to;
  from /= static_cast<double>(pairs.size()), to /= static_cast<double>(pairs.size());
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Pair& p : pairs) sum += (p.from - from) * (p.to - to).transpose();
  const Eigen::Matrix3d symmetric = sum + sum.transpose();
  const Vector3 normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(symmetric).eigenvectors().col(0);
  return {normal, normal.dot(from + to) / 2};
}

// Mirrored samples and the points of the mesh nearest to them, the nearest pairs only. Returns the mean
// distance of all.
double match(const ClosestPointTree& tree, const SurfaceMesh& mesh, const std::vector<SurfaceSample>& samples,
             const MirrorPlane& plane, std::vector<Pair>& pairs) {
  pairs.clear();
  double sum = 0;
  for (const SurfaceSample& s : samples) {
    const ClosestPoint c = tree.closest(plane.mirrored(s.point));
    if (c.face < 0) continue;
    pairs.push_back({s.point, c.point, mesh.face_normal_raw(c.face).normalized(), c.squared_distance});
    sum += std::sqrt(c.squared_distance);
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.distance2 < b.distance2; });
  pairs.resize(static_cast<std::size_t>(kTrim * static_cast<double>(pairs.size())));
  return sum / static_cast<double>(samples.size());
}

// A Gauss-Newton step that reduces the distances along the normals: mirrored points may slide along the
// surface.
MirrorPlane sliding_step(const std::vector<Pair>& pairs, const MirrorPlane& plane, const Vector3& centre,
                         double diagonal) {
  const Vector3 t1 = plane.normal.unitOrthogonal(), t2 = plane.normal.cross(t1);
  const double offset = (plane.offset - plane.normal.dot(centre)) / diagonal;  // lengths in diagonals
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  Vector3 right = Vector3::Zero();
  for (const Pair& p : pairs) {
    const Vector3 from = (p.from - centre) / diagonal;
    const double height = plane.normal.dot(from) - offset, across = p.normal.dot(plane.normal);
    const Vector3 row = -2 * Vector3(t1.dot(from) * across + height * p.normal.dot(t1),
                                     t2.dot(from) * across + height * p.normal.dot(t2), -across);
    matrix += row * row.transpose();
    right -= row * p.normal.dot(plane.mirrored(p.from) - p.to) / diagonal;
  }
  matrix.diagonal() *= 1 + 1e-9;  // round shapes leave directions free
  matrix.diagonal().array() += 1e-12 * matrix.trace();
  const Vector3 step = matrix.ldlt().solve(right);
  if (!step.allFinite() || step.head<2>().norm() > 0.3) return plane;
  const Vector3 normal = (plane.normal + step[0] * t1 + step[1] * t2).normalized();
  return {normal, (offset + step[2]) * diagonal + normal.dot(centre)};
}

// A few steps from far away; false when they lead nowhere.
bool approach(const ClosestPointTree& tree, const SurfaceMesh& mesh,
              const std::vector<SurfaceSample>& samples, double diagonal, MirrorPlane& plane) {
  std::vector<Pair> pairs;
  double mean = 0;
  for (int step = 0; step < kFarSteps; ++step) {
    mean = match(tree, mesh, samples, plane, pairs);
    if (pairs.empty()) return false;
    plane = best_plane(pairs);
  }
  return mean < kHopeless * diagonal;
}

// Steps that converge fast from nearby; keeps the best plane met.
void polish(const ClosestPointTree& tree, const SurfaceMesh& mesh, const std::vector<SurfaceSample>& samples,
            const Vector3& centre, double diagonal, MirrorPlane& plane) {
  std::vector<Pair> pairs;
  MirrorPlane next = plane;
  double best = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kNearSteps; ++step) {
    const double mean = match(tree, mesh, samples, next, pairs);
    if (!(mean < best * (1 - 1e-4))) break;
    best = mean, plane = next;
    next = sliding_step(pairs, plane, centre, diagonal);
  }
}

SymmetryPlane measured(const ClosestPointTree& tree, const std::vector<SurfaceSample>& samples,
                       double diagonal, const MirrorPlane& raw) {
  const MirrorPlane plane = oriented(raw);
  std::vector<double> distances;
  for (const SurfaceSample& s : samples)
    distances.push_back(std::sqrt(tree.closest(plane.mirrored(s.point)).squared_distance) / diagonal);
  std::sort(distances.begin(), distances.end());
  SymmetryPlane result{plane.normal, plane.offset, 0, 0};
  if (distances.empty()) return result;
  result.mean_distance =
      std::accumulate(distances.begin(), distances.end(), 0.0) / static_cast<double>(distances.size());
  result.p99_distance = distances[distances.size() * 99 / 100];
  return result;
}

bool alike(const MirrorPlane& a, const MirrorPlane& b, const Vector3& centre, double diagonal) {
  const double way = a.normal.dot(b.normal);
  const double shift =
      (a.offset - a.normal.dot(centre)) - std::copysign(1.0, way) * (b.offset - b.normal.dot(centre));
  return std::abs(way) > std::cos(2 * M_PI / 180) && std::abs(shift) < 0.005 * diagonal;
}

}  // namespace

std::vector<SymmetryPlane> detect_symmetry(const SurfaceMesh& mesh, const ClosestPointTree& tree,
                                           const RunContext& context) {
  const double diagonal = bounding_box_diagonal(mesh.points);
  const std::vector<SurfaceSample> judges = sample_evenly(mesh, kJudges), pairs = sample_evenly(mesh, kPairs),
                                   scouts = sample_evenly(mesh, kScouts);
  if (judges.empty()) return {};
  const Vector3 centre = centre_of(judges);
  std::vector<MirrorPlane> candidates = principal_planes(judges), polished;
  for (const MirrorPlane& plane : voted_planes(sample_evenly(mesh, kVoters), diagonal))
    candidates.push_back(plane);
  auto known = [&](const MirrorPlane& plane) {
    return std::any_of(polished.begin(), polished.end(),
                       [&](const MirrorPlane& p) { return alike(p, plane, centre, diagonal); });
  };
  std::vector<SymmetryPlane> found;
  for (MirrorPlane& plane : candidates) {
    context.checkpoint();
    if (!approach(tree, mesh, scouts, diagonal, plane) || known(plane)) continue;
    polish(tree, mesh, pairs, centre, diagonal, plane);
    if (known(plane)) continue;
    polished.push_back(plane);
    const SymmetryPlane result = measured(tree, judges, diagonal, plane);
    if (result.mean_distance < kMostMean && result.p99_distance < kMostP99) found.push_back(result);
  }
  std::stable_sort(found.begin(), found.end(), [](const SymmetryPlane& a, const SymmetryPlane& b) {
    return a.mean_distance < b.mean_distance;
  });
  if (found.size() > kMostPlanes) found.resize(kMostPlanes);
  return found;
}

SymmetryPlane measure_symmetry(const SurfaceMesh& mesh, const ClosestPointTree& tree, const Vector3& normal,
                               double offset) {
  const double length = normal.norm();
  return measured(tree, sample_evenly(mesh, kJudges), bounding_box_diagonal(mesh.points),
                  {normal / length, offset / length});
}

}  // namespace sheetform
