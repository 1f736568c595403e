// The strips as one surface, and points spread evenly over a surface, for the certificate's measurements.
#include <cstdint>

#include "sheetform/strip/certificate_checks.h"

namespace sheetform::certificate {
namespace {

double unit_noise(std::uint64_t i) {  // SplitMix64, a fixed stream: results depend on no seed
  std::uint64_t z = (i + 1) * 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-53;
}

double fraction(double x) { return x - static_cast<double>(static_cast<std::int64_t>(x)); }  // of x >= 0

}  // namespace

Strips::Strips(const StripMesh& result) {
  for (std::size_t p = 0; p < result.patches.size(); ++p)
    for (const StripMesh::Triangle& t : result.patches[p].triangles) {
      faces.push_back(t.v);
      patch_of.push_back(static_cast<int>(p));
    }
}

// Inside a face the R2 sequence (Roberts) spreads them.
std::vector<AreaSample> area_samples(const std::vector<Vector3>& points,
                                     const std::vector<std::array<int, 3>>& faces, int n) {
  std::vector<double> sum(faces.size());
  double total = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const Vector3& a = points[faces[f][0]];
    sum[f] = total += (points[faces[f][1]] - a).cross(points[faces[f][2]] - a).norm() / 2;
  }
  std::vector<AreaSample> out;
  if (!(total > 0)) return out;
  std::size_t f = 0;
  for (int i = 0; i < n; ++i) {
    const double target = (i + unit_noise(static_cast<std::uint64_t>(i))) / n * total;
    while (f + 1 < faces.size() && sum[f] <= target) ++f;
    double a = fraction(0.5 + i * 0.7548776662466927), b = fraction(0.5 + i * 0.5698402909980532);
    if (a + b > 1) a = 1 - a, b = 1 - b;
    const auto& t = faces[f];
    out.push_back({(1 - a - b) * points[t[0]] + a * points[t[1]] + b * points[t[2]], static_cast<int>(f)});
  }
  return out;
}

}  // namespace sheetform::certificate
