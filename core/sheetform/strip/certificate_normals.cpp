// How far the sheets' normals are from those of the input.
#include <algorithm>
#include <cmath>

#include "sheetform/strip/certificate.h"
#include "sheetform/strip/certificate_checks.h"
#include "sheetform/strip/one_way_distance.h"

namespace sheetform {
namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846;

using certificate::AreaSample;
using certificate::OneWayDistance;
using certificate::SampleHits;
using certificate::Strips;
using certificate::Surface;
using Faces = std::vector<std::array<int, 3>>;

struct TiltSample {
  Vector3 point;
  double angle;  // degrees
  int patch;
};

Vector3 normal_of(const Surface& surface, int face) {
  const auto& t = surface.faces[face];
  return (surface.points[t[1]] - surface.points[t[0]]).cross(surface.points[t[2]] - surface.points[t[0]]);
}

// patch(own face, hit face).
template <class PatchOf>
std::vector<TiltSample> tilts(const Surface& from, const Surface& to, const std::vector<AreaSample>& samples,
                              const std::vector<int>& hits, const PatchOf& patch) {
  std::vector<TiltSample> out;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (hits[i] < 0) continue;
    const Vector3 a = normal_of(from, samples[i].face), b = normal_of(to, hits[i]);
    out.push_back({samples[i].point, kDegrees * angle_between(a, b), patch(samples[i].face, hits[i])});
  }
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
  std::nth_element(samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(k), samples.end(),
                   [](const TiltSample* a, const TiltSample* b) {
                     return a->angle != b->angle ? a->angle < b->angle : a < b;  // all of one array
                   });
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

NormalReport certificate::normals_at(const std::vector<Vector3>& points, const Faces& faces,
                                     const StripMesh& result, const SampleHits& hits) {
  NormalReport report;
  report.patch_quantile.assign(result.patches.size(), 0);
  const Strips strips(result);
  const Surface in{points, faces}, out{result.points, strips.faces};
  const std::vector<int>& patch_of = strips.patch_of;
  take(tilts(in, out, hits.on_input, hits.to_result, [&](int, int hit) { return patch_of[hit]; }), report);
  take(tilts(out, in, hits.on_result, hits.to_input, [&](int own, int) { return patch_of[own]; }), report);
  return report;
}

NormalReport measure_normals(const std::vector<Vector3>& points, const Faces& faces,
                             const ClosestPointTree& tree, const StripMesh& result, int samples,
                             RunContext& context) {
  const Strips strips(result);
  SampleHits hits;
  if (!faces.empty() && !strips.faces.empty()) {
    const Surface in{points, faces}, out{result.points, strips.faces};
    const ClosestPointTree strip_tree(out.points, out.faces, context);
    hits = {certificate::area_samples(points, faces, samples),
            certificate::area_samples(out.points, out.faces, samples),
            {},
            {}};
    OneWayDistance(in, out, strip_tree, nullptr, 0, context).measure(hits.on_input, &hits.to_result);
    OneWayDistance(out, in, tree, nullptr, 0, context).measure(hits.on_result, &hits.to_input);
  }
  return certificate::normals_at(points, faces, result, hits);
}

}  // namespace sheetform
