// Connectivity of any list of triangles, manifold or not: what the certificate counts with.
#pragma once
#include <array>
#include <vector>

#include "sheetform/base/run_context.h"

namespace sheetform {

using Triple = std::array<int, 3>;

/// Every edge of a list of triangles with all its uses, sorted by (a, b). Cost O(n) for vertices of few
/// faces, O(n log n) at worst.
struct EdgeTable {
  struct Use {
    int a, b, face;  ///< in the direction in which `face` runs it
  };
  struct Edge {
    int a, b;          ///< a < b
    int first, count;  ///< its uses are uses[first, first + count)
  };
  std::vector<Use> uses;
  std::vector<Edge> edges;

  EdgeTable() = default;
  /// Indices are not negative. Throws as context.checkpoint() does, and nothing else.
  explicit EdgeTable(const std::vector<Triple>& faces, const RunContext& context = {});
  int find(int a, int b) const;  ///< index into edges, -1 if there is none
  const Use& use(const Edge& e, int k) const { return uses[e.first + k]; }
};

struct Topology {
  int vertices = 0, edges = 0, faces = 0, components = 0, border_loops = 0;
  int repeated_face = -1;       ///< a face that names a vertex twice; -1: none
  int nonmanifold_edge = -1;    ///< index of an edge with three faces or more
  int nonmanifold_vertex = -1;  ///< a vertex whose faces form several fans
  int misoriented_edge = -1;    ///< index of an edge that two faces run the same way
  std::vector<int> component;   ///< of each face, numbered by lowest face
  int euler() const { return vertices - edges + faces; }
  bool manifold() const { return repeated_face < 0 && nonmanifold_edge < 0 && nonmanifold_vertex < 0; }
  bool oriented() const { return misoriented_edge < 0; }
};

/// `vertices`: indices lie in [0, vertices). Border loops are counted right only for manifolds.
Topology topology_of(const std::vector<Triple>& faces, const EdgeTable& table, int vertices);

}  // namespace sheetform
