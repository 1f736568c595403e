// How far the sheets' normals are from those of the input.
#include <algorithm>
#include <cmath>

#include "sheetform/strip/certificate.h"
#include "sheetform/strip/certificate_checks.h"

namespace sheetform {
namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846;

using Faces = std::vector<std::array<int, 3>>;

struct TiltSample {
  Vector3 point;
  double angle;  // degrees
  int patch;
};

Vector3 normal_of(const std::vector<Vector3>& points, const std::array<int, 3>& t) {
  return (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
}

// Samples on one surface against the closest faces of the other. patch(own face, hit face).
template <class PatchOf>
std::vector<TiltSample> tilts(const std::vector<Vector3>& points, const Faces& faces,
                              const std::vector<Vector3>& other_points, const Faces& other_faces,
                              const ClosestPointTree& tree, int samples, const PatchOf& patch,
                              const RunContext& context) {
  const std::vector<certificate::AreaSample> from = certificate::area_samples(points, faces, samples);
  std::vector<TiltSample> out(from.size());
  constexpr int kChunk = 512;
  const int n = static_cast<int>(from.size());
  parallel_for(context, (n + kChunk - 1) / kChunk, [&](int chunk) {
    context.checkpoint();
    for (int i = chunk * kChunk; i < std::min(n, (chunk + 1) * kChunk); ++i) {
      const ClosestPoint hit = tree.closest(from[i].point);
      if (hit.face < 0) continue;
      const Vector3 a = normal_of(points, faces[from[i].face]),
                    b = normal_of(other_points, other_faces[hit.face]);
      out[i] = {from[i].point, kDegrees * angle_between(a, b), patch(from[i].face, hit.face)};
    }
  });
  context.checkpoint();
  return out;
}

double mean_angle(const std::vector<TiltSample>& samples) {
  double sum = 0;
  for (const TiltSample& s : samples) sum += s.angle;
  return samples.empty() ? 0 : sum / static_cast<double>(samples.size());
}

// The sample that kNormalShare of the samples do not exceed; null for none.
const TiltSample* quantile(std::vector<const TiltSample*> samples) {
  if (samples.empty()) return nullptr;
  const auto k = std::min(samples.size() - 1, static_cast<std::size_t>(NormalReport::kShare *
                                                                       static_cast<double>(samples.size())));
  std::stable_sort(samples.begin(), samples.end(),
                   [](const TiltSample* a, const TiltSample* b) { return a->angle < b->angle; });
  return samples[k];
}

// Takes one way into the report.
void take(const std::vector<TiltSample>& samples, NormalReport& report) {
  std::vector<const TiltSample*> all;
  std::vector<std::vector<const TiltSample*>> of_patch(report.patch_quantile.size());
  for (const TiltSample& s : samples) {
    all.push_back(&s);
    of_patch[s.patch].push_back(&s);
  }
  report.mean += mean_angle(samples) / 2;
  if (const TiltSample* s = quantile(std::move(all))) report.quantile = std::max(report.quantile, s->angle);
  for (std::size_t p = 0; p < of_patch.size(); ++p) {
    const TiltSample* s = quantile(std::move(of_patch[p]));
    if (s == nullptr || s->angle <= report.patch_quantile[p]) continue;
    report.patch_quantile[p] = s->angle;
    if (s->angle > report.worst) report.worst = s->angle, report.worst_place = s->point;
  }
}

}  // namespace

NormalReport measure_normals(const std::vector<Vector3>& points, const Faces& faces,
                             const ClosestPointTree& tree, const StripMesh& result, int samples,
                             RunContext& context) {
  NormalReport report;
  report.patch_quantile.assign(result.patches.size(), 0);
  Faces strips;
  std::vector<int> patch_of;
  for (std::size_t p = 0; p < result.patches.size(); ++p)
    for (const StripMesh::Triangle& t : result.patches[p].triangles) {
      strips.push_back(t.v);
      patch_of.push_back(static_cast<int>(p));
    }
  if (faces.empty() || strips.empty()) return report;
  const ClosestPointTree strip_tree(result.points, strips, context);
  take(tilts(
           points, faces, result.points, strips, strip_tree, samples,
           [&](int, int hit) { return patch_of[hit]; }, context),
       report);
  take(tilts(
           result.points, strips, points, faces, tree, samples, [&](int own, int) { return patch_of[own]; },
           context),
       report);
  return report;
}

}  // namespace sheetform
