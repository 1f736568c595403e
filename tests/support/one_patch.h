// A shape that is one patch, taken through the stages up to the rulings.
#pragma once
#include <algorithm>
#include <cmath>

#include "sheetform/ruling/rulings.h"
#include "support/shapes.h"

namespace sheetform::shapes {

struct OnePatch {
  SurfaceMesh mesh;
  PathNetwork network;
  PatchLayout layout;
  PatchChart chart;

  explicit OnePatch(TriangleSoup soup, const ChartParams& params = {})
      : mesh(build_surface_mesh(std::move(soup.points), std::move(soup.faces))), network(bare_network(mesh)) {
    layout = extract_layout(mesh, network, std::vector<int>(mesh.points.size(), 0), {});
    chart = parametrize(mesh, layout, patch(), params);
  }
  const Patch& patch() const { return layout.patches.at(0); }

  SurfaceGuide guide() const {
    RunContext context;
    return surface_guide(mesh,
                         principal_curvature(mesh, std::vector<char>(mesh.edges.size(), 0), {}, context));
  }
  PatchPolygon polygon(double spacing) const {
    std::vector<std::vector<double>> samples;
    for (const Arch& a : layout.arches) samples.push_back(sample_arch(mesh, a, spacing));
    return patch_polygon(mesh, layout, patch(), chart, samples);
  }
};

/// A sector of a cone with its apex at the origin: `angle` of the flat sheet, slant length 1, `tilt` of the
/// generators against the plane. Rings of n triangles around the apex.
inline TriangleSoup cone_sector(int n, int rings, double angle, double tilt) {
  // The flat angle shrinks by cos(tilt) when the sheet is rolled.
  const double around = angle / std::cos(tilt);
  TriangleSoup soup;
  soup.points.emplace_back(0, 0, 0);
  for (int r = 1; r <= rings; ++r)
    for (int i = 0; i <= n; ++i) {
      const double s = double(r) / rings, a = around * i / n;
      soup.points.emplace_back(s * std::cos(tilt) * std::cos(a), s * std::cos(tilt) * std::sin(a),
                               -s * std::sin(tilt));
    }
  const auto id = [&](int r, int i) { return 1 + (r - 1) * (n + 1) + i; };
  for (int i = 0; i < n; ++i) {
    soup.faces.push_back({0, id(1, i), id(1, i + 1)});
    for (int r = 1; r < rings; ++r) {
      soup.faces.push_back({id(r, i), id(r + 1, i), id(r + 1, i + 1)});
      soup.faces.push_back({id(r, i), id(r + 1, i + 1), id(r, i + 1)});
    }
  }
  return soup;
}

/// Largest |flat length / length - 1| over the triangles' edges.
inline double worst_strain(const SurfaceMesh& mesh, const Patch& patch, const PatchChart& chart) {
  double worst = 0;
  for (std::size_t i = 0; i < chart.triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const auto& f = mesh.faces[patch.faces[i]];
      const double length = (mesh.points[f[(k + 1) % 3]] - mesh.points[f[k]]).norm();
      const double flat =
          (chart.uv[chart.triangles[i][(k + 1) % 3]] - chart.uv[chart.triangles[i][k]]).norm();
      worst = std::max(worst, std::abs(flat / length - 1));
    }
  return worst;
}

}  // namespace sheetform::shapes
