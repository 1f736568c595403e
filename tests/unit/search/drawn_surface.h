// Drawings and shapes as the search sees them.
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "sheetform/base/error.h"
#include "sheetform/mesh/creases.h"
#include "sheetform/search/layout_search.h"
#include "support/drawing.h"
#include "support/shapes.h"

namespace sheetform {

/// A mesh as a SearchSurface; it is its own input. Keep it where it is: the surface points into it.
struct SearchBed {
  RunContext context;
  ClosestPointTree tree;
  SearchSurface surface;

  explicit SearchBed(SurfaceMesh mesh) : tree(mesh.points, mesh.faces) {
    surface.versions.assign(mesh.points.size(), 0);
    const std::vector<char> smooth(mesh.edges.size(), 0);
    surface.guide = surface_guide(mesh, principal_curvature(mesh, smooth, {}, context));
    surface.mesh = std::move(mesh);
    surface.input = &tree;
  }
  SearchBed(const SearchBed&) = delete;
  SearchBed& operator=(const SearchBed&) = delete;
};

/// A drawing rolled to a tube around z, cells as wide as high.
inline shapes::Canvas rolled(int columns, int steps = 6, double radius = 0.3) {
  shapes::Canvas canvas;
  canvas.steps = steps;
  canvas.roll = true;
  canvas.place = [=](double x, double y) {
    const double a = 2 * shapes::kPi * x / columns;
    return Vector3(radius * std::cos(a), radius * std::sin(a), 2 * shapes::kPi * radius * y / columns);
  };
  return canvas;
}

/// A drawing bent to a part of a cylinder around the vertical axis: developable. `arc`: radians for one cell.
inline shapes::Canvas bent(double arc, int steps = 6, double cell = 0.2) {
  shapes::Canvas canvas;
  canvas.steps = steps;
  canvas.place = [=](double x, double y) {
    const double radius = cell / arc;
    return Vector3(radius * std::cos(arc * x), radius * std::sin(arc * x), cell * y);
  };
  return canvas;
}

/// These edges become a crease of the drawing.
inline void make_crease(shapes::Drawing& d, const std::vector<int>& edges) {
  const int path = d.network.add_path(PathKind::kCrease);
  for (int e : edges) d.network.edge_path[e] = path;
}

/// Network edges inside of the surface.
inline int inner_edges(const SurfaceMesh& mesh, const PathNetwork& network) {
  int n = 0;
  for (int e = 0; e < mesh.edge_count(); ++e) n += network.used(e) && !mesh.edges[e].border();
  return n;
}

/// Every patch fits, alone and with its neighbours.
inline void expect_viable(LayoutSearch& search, double e_max, std::size_t sides = 6) {
  for (const Patch& p : search.layout().patches) EXPECT_EQ(p.defect, TopologyDefect::kNone);
  const LayoutEvaluation& e = search.evaluation();
  EXPECT_EQ(e.failing, 0);
  EXPECT_LE(e.max_error, e_max);
  for (const auto& p : e.patches) EXPECT_LE(p->corners.size(), sides);
}

/// Evaluation parameters for shapes of about the size 1.
inline EvaluationParams evaluation_params(double e_max) {
  EvaluationParams params;
  params.e_max = e_max;
  params.spacing = 0.05;
  return params;
}

/// A search that begins with the network of a drawing.
struct Begun {
  SearchBed bed;
  CrossField field;
  TracingGraph graph;
  std::unique_ptr<LayoutSearch> search;

  Begun(const shapes::Drawing& d, double e_max) : Begun(d, evaluation_params(e_max)) {}
  Begun(const shapes::Drawing& d, const EvaluationParams& evaluation) : bed(d.mesh) {
    const SurfaceMesh& mesh = bed.surface.mesh;
    const std::vector<char> smooth(mesh.edges.size(), 0);
    const CurvatureField curvature = principal_curvature(mesh, smooth, {}, bed.context);
    field = cross_field(mesh, smooth, curvature, nullptr, {}, bed.context);
    graph = tracing_graph(mesh, smooth, field, {}, bed.context);
    SearchParams params;
    params.evaluation = evaluation;
    search = std::make_unique<LayoutSearch>(bed.surface, d.network, graph, std::vector<Path>{}, params,
                                            bed.context);
  }
  const PathNetwork& network() const { return search->network().network(); }
};

/// Everything before the search, for a closed or open shape.
struct Searched {
  SearchBed bed;
  std::vector<char> crease;
  CrossField field;
  TracingGraph graph;
  std::unique_ptr<LayoutSearch> search;

  Searched(const TriangleSoup& soup, double e_max, EvaluationParams evaluation = {})
      : bed(normalised(soup)), crease(detect_creases(bed.surface.mesh, 40)) {
    const SurfaceMesh& mesh = bed.surface.mesh;
    const CurvatureField curvature = principal_curvature(mesh, crease, {}, bed.context);
    field = cross_field(mesh, crease, curvature, nullptr, {}, bed.context);
    graph = tracing_graph(mesh, crease, field, {}, bed.context);
    TraceParams trace;
    trace.seeds = 60;
    PathNetwork network = bare_network(mesh);
    add_creases(mesh, crease, network);
    SearchParams params;
    params.evaluation = evaluation;
    params.evaluation.e_max = e_max;
    search = std::make_unique<LayoutSearch>(bed.surface, std::move(network), graph,
                                            trace_candidates(mesh, graph, field, trace, bed.context), params,
                                            bed.context);
  }
  /// From the bare network to one whose arches have gone as far as they can.
  void reduce() {
    search->insert();
    search->remove_paths();
    search->remove_arches();
  }
  static SurfaceMesh normalised(TriangleSoup soup) {
    const double diagonal = bounding_box_diagonal(soup.points);
    for (Vector3& p : soup.points) p /= diagonal;
    return build_surface_mesh(std::move(soup.points), std::move(soup.faces));
  }
};

/// What `steps` make of a Searched sphere is the same with one thread and with three.
template <class Steps>
void expect_same_for_any_number_of_threads(double e_max, const Steps& steps) {
  std::vector<std::vector<int>> networks;
  std::vector<std::vector<Vector3>> points;
  for (int threads : {1, 3}) {
    Searched s(shapes::sphere(12), e_max);
    s.bed.context.threads = threads;
    steps(s);
    networks.push_back(s.search->network().network().edge_path);
    points.push_back(s.bed.surface.mesh.points);
  }
  EXPECT_EQ(networks[0], networks[1]);
  EXPECT_EQ(points[0], points[1]);
}

}  // namespace sheetform
