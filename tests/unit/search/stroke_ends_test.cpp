#include "sheetform/search/stroke_ends.h"

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace sheetform {
namespace {

// A mesh with some of its edges drawn, and the ends lengthened.
struct Extended {
  SurfaceMesh mesh;
  PathNetwork network;
  int drawn = 0, added = 0, loose = 0;

  template <class IsDrawn>
  Extended(TriangleSoup soup, const IsDrawn& is_drawn)
      : mesh(build_surface_mesh(std::move(soup.points), std::move(soup.faces))) {
    std::vector<char> edges(mesh.edges.size(), 0);
    for (int e = 0; e < mesh.edge_count(); ++e)
      edges[e] = is_drawn(mesh.points[mesh.edges[e].v0]) && is_drawn(mesh.points[mesh.edges[e].v1]);
    RunContext context;
    const std::vector<char> none(mesh.edges.size(), 0);
    const CurvatureField curvature = principal_curvature(mesh, none, {}, context);
    const CrossField field = cross_field(mesh, edges, curvature, nullptr, {}, context);
    const TracingGraph graph = tracing_graph(mesh, edges, field, {}, context);
    network = bare_network(mesh);
    add_creases(mesh, edges, network, PathKind::kDrawn);
    for (char e : edges) drawn += e;
    extend_drawn_ends(mesh, graph, field, network, context);
    for (int e = 0; e < mesh.edge_count(); ++e)
      added += network.used(e) && network.kinds[network.edge_path[e]] == PathKind::kCut;
    for (int v = 0; v < mesh.vertex_count(); ++v) loose += network_degree(mesh, network, v) == 1;
  }
};

TEST(StrokeEnds, GoStraightOnToTheBorder) {
  const Extended x(shapes::plane(20), [](const Vector3& p) {
    return std::abs(p.y() - 0.5) < 1e-9 && p.x() > 0.29 && p.x() < 0.71;
  });
  EXPECT_EQ(x.drawn, 8);
  EXPECT_EQ(x.loose, 0);
  EXPECT_EQ(x.added, 12);
  for (int e = 0; e < x.mesh.edge_count(); ++e)
    EXPECT_TRUE(!x.network.used(e) || x.mesh.edges[e].border() ||
                std::abs(x.mesh.points[x.mesh.edges[e].v0].y() - 0.5) < 1e-9);
}

TEST(StrokeEnds, OnAClosedSurfaceTheyGoAroundToTheirOtherEnd) {
  const Extended x(shapes::torus(48, 24), [](const Vector3& p) {
    return std::abs(p.z() - 0.4) < 1e-9 && p.x() > 0 && p.y() > 0;  // a quarter of the circle on top
  });
  EXPECT_GT(x.drawn, 8);
  EXPECT_EQ(x.loose, 0);
  EXPECT_GE(x.drawn + x.added, 47);
}

TEST(StrokeEnds, OnASphereNothingStaysLoose) {
  const Extended x(shapes::sphere(16), [](const Vector3& p) {
    return std::abs(p.z()) < 1e-9 && p.x() > 0 && std::abs(p.y()) < 0.5;
  });
  EXPECT_GT(x.drawn, 3);
  EXPECT_EQ(x.loose, 0);
}

}  // namespace
}  // namespace sheetform
