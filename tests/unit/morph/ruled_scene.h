// A grid shape cut along some of its rows and columns, with rulings: what both morphs take.
#pragma once
#include <algorithm>
#include <vector>

#include "sheetform/morph/full_morph.h"
#include "sheetform/search/evaluator.h"
#include "support/shapes.h"

namespace sheetform {

/// Which lines of a shapes::grid become paths.
struct GridCuts {
  shapes::Grid grid;
  std::vector<int> columns, rows;
};

struct RuledScene {
  SearchSurface surface;  ///< scaled to a bounding box with diagonal 1
  ClosestPointTree tree;
  CurvatureField curvature;
  PatchLayout layout;
  EvaluationParams params;
  std::vector<std::vector<double>> arch_samples;
  std::vector<std::shared_ptr<const PatchEvaluation>> patches;
  LayoutEvaluation reduced;  ///< least squares, no reweighting
  FullMorphProblem problem;

  RuledScene(const TriangleSoup& soup, const GridCuts& cuts, double spacing = 0.03) {
    surface.mesh = scaled(soup);
    tree = ClosestPointTree(surface.mesh.points, surface.mesh.faces);
    RunContext context;
    curvature = principal_curvature(surface.mesh, {}, {}, context);
    surface.versions.assign(surface.mesh.points.size(), 0);
    surface.guide = surface_guide(surface.mesh, curvature);
    surface.input = &tree;
    layout = extract_layout(surface.mesh, network(cuts), surface.versions, {});
    params.spacing = spacing;
    LayoutEvaluator evaluator(surface, params, context);
    reduced = evaluator.layout(layout, 0);
    patches = reduced.patches;
    for (const Arch& a : layout.arches) arch_samples.push_back(sample_arch(surface.mesh, a, spacing));
    problem = full_morph_problem(surface.mesh, layout, ruled_patches(), arch_samples, &curvature, context);
  }
  RuledScene(const RuledScene&) = delete;
  RuledScene& operator=(const RuledScene&) = delete;

  std::vector<RuledPatch> ruled_patches() const {
    std::vector<RuledPatch> ruled(patches.size());
    for (std::size_t p = 0; p < patches.size(); ++p)
      ruled[p] = {patches[p]->chart.get(),
                  ruling_lines(layout.patches[p], patches[p]->polygon, patches[p]->rulings, arch_samples)};
    return ruled;
  }

  /// Per patch: the largest displacement of a ruling's point in the reduced morph.
  std::vector<double> reduced_displacement() const {
    std::vector<double> worst(patches.size(), 0);
    for (std::size_t p = 0; p < patches.size(); ++p)
      for (MorphSample s : patches[p]->samples) {
        if (s.weight <= 0) continue;
        for (int& u : s.unknown) u = reduced.unknowns[p][u];
        worst[p] = std::max(worst[p], (s.at(reduced.position) - s.target).norm());
      }
    return worst;
  }

 private:
  static SurfaceMesh scaled(TriangleSoup soup) {
    const double diagonal = bounding_box_diagonal(soup.points);
    for (Vector3& p : soup.points) p /= diagonal;
    return build_surface_mesh(std::move(soup.points), std::move(soup.faces));
  }
  PathNetwork network(const GridCuts& cuts) const {
    PathNetwork net = bare_network(surface.mesh);
    const auto& g = cuts.grid;
    const int cu = g.wrap_u ? g.nu : g.nu + 1, cv = g.wrap_v ? g.nv : g.nv + 1;
    const auto mark = [&](int a, int b, int path) { net.edge_path[surface.mesh.find_edge(a, b)] = path; };
    for (int i : cuts.columns) {
      const int path = net.add_path(PathKind::kTraced);
      for (int j = 0; j < g.nv; ++j) mark(j % cv * cu + i % cu, (j + 1) % cv * cu + i % cu, path);
    }
    for (int j : cuts.rows) {
      const int path = net.add_path(PathKind::kTraced);
      for (int i = 0; i < g.nu; ++i) mark(j % cv * cu + i % cu, j % cv * cu + (i + 1) % cu, path);
    }
    return net;
  }
};

inline const RuledScene& torus_sections() {
  static const RuledScene scene(shapes::torus(48, 24),
                                {{48, 24, true, true}, {0, 4, 12, 24, 30, 42}, {0, 5, 12, 18}});
  return scene;
}
inline const RuledScene& saddle_parts() {
  static const RuledScene scene(shapes::saddle(24, 0.8), {{24, 24}, {8}, {14}});
  return scene;
}
inline const RuledScene& flat_parts() {
  static const RuledScene scene(shapes::plane(16), {{16, 16}, {6}, {5, 10}});
  return scene;
}

inline double largest(const std::vector<double>& x) { return *std::max_element(x.begin(), x.end()); }

}  // namespace sheetform
