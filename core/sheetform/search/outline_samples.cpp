#include "sheetform/search/outline_samples.h"

#include <algorithm>
#include <cmath>

namespace sheetform {
namespace {

constexpr double kSlack = 0.1;  // of e_max: by how much the polyline may leave the arch
constexpr double kFlat = 1.0;   // 1/diagonal: a curvature that rulings take notice of

// How much the rulings beside the edge end at it: 1 across it, 0 along it or where nothing bends.
double demand(const SearchSurface& surface, int edge) {
  const SurfaceMesh& mesh = surface.mesh;
  const auto& e = mesh.edges[edge];
  const Vector3 along = (mesh.points[e.v1] - mesh.points[e.v0]).normalized();
  double most = 0;
  for (int f : {e.f0, e.f1}) {
    if (f < 0) continue;
    const double c = surface.guide.ruling_direction[f].dot(along);
    double bend = kFlat;
    if (surface.curvature != nullptr) {
      bend = 0;
      for (int v : mesh.faces[f]) bend = std::max(bend, std::abs(surface.curvature->k_max[v]));
    }
    most = std::max(most, std::min(bend / kFlat, 1.0) * (1 - surface.guide.strength[f] * c * c * c * c));
  }
  return most;
}

// Distance from the arch's vertices between two coordinates to the chord.
double deviation(const SurfaceMesh& mesh, const Arch& arch, double from, double to) {
  const Vector3 a = arch_point(mesh, arch, from), d = arch_point(mesh, arch, to) - a;
  const double length2 = std::max(d.squaredNorm(), 1e-300);
  double worst = 0;
  for (int i = static_cast<int>(from) + 1; i < to; ++i) {
    const Vector3 w = mesh.points[arch.vertices[i]] - a;
    worst = std::max(worst, (w - std::clamp(w.dot(d) / length2, 0.0, 1.0) * d).norm());
  }
  return worst;
}

// The arch measured by how many samples it wants.
class Measure {
 public:
  Measure(const SearchSurface& surface, const Arch& arch, const EvaluationParams& params) : wanted_(1, 0) {
    for (int e : arch.edges)
      wanted_.push_back(wanted_.back() + surface.mesh.edge_length(e) *
                                             std::max(demand(surface, e), params.sparsest) / params.spacing);
  }
  double whole() const { return wanted_.back(); }
  double of(double at) const {
    const std::size_t i = std::min(static_cast<std::size_t>(at), wanted_.size() - 2);
    return wanted_[i] + (at - static_cast<double>(i)) * (wanted_[i + 1] - wanted_[i]);
  }
  double at(double want) const {
    const auto next = std::upper_bound(wanted_.begin() + 1, wanted_.end() - 1, want);
    const double span = std::max(*next - *(next - 1), 1e-300);
    return static_cast<double>(next - 1 - wanted_.begin()) +
           std::clamp((want - *(next - 1)) / span, 0.0, 1.0);
  }

 private:
  std::vector<double> wanted_;  // from the start to each vertex
};

}  // namespace

std::vector<double> outline_samples(const SearchSurface& surface, const Arch& arch,
                                    const EvaluationParams& params) {
  const auto edges = static_cast<double>(arch.edges.size());
  if (surface.is_straight(arch)) return {0, edges};
  if (std::binary_search(params.plain_arches.begin(), params.plain_arches.end(), arch.key))
    return sample_arch(surface.mesh, arch, params.bounds.divide(arch.length, params.plain_spacing));
  if (params.bounds.least > 0 || params.sparsest >= 1)
    return sample_arch(surface.mesh, arch, params.bounds.divide(arch.length, params.spacing));
  const Measure measure(surface, arch, params);
  const int least = arch.closed() ? 6 : 2;
  const int segments = std::max(least, static_cast<int>(std::lround(measure.whole())));
  std::vector<double> ends;  // of segments, the next one last
  for (int s = segments; s > 0; --s)
    ends.push_back(s == segments ? edges : measure.at(measure.whole() * s / segments));
  std::vector<double> at{0};
  while (!ends.empty()) {
    const double from = at.back(), to = ends.back();
    const double length = (arch_point(surface.mesh, arch, to) - arch_point(surface.mesh, arch, from)).norm();
    const bool leaves =
        length > 1.5 * params.spacing && deviation(surface.mesh, arch, from, to) > kSlack * params.e_max;
    if (leaves || length > params.bounds.most) {
      ends.push_back(measure.at((measure.of(from) + measure.of(to)) / 2));
    } else {
      at.push_back(to);
      ends.pop_back();
    }
  }
  return at;
}

}  // namespace sheetform
