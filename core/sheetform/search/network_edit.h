// Changing the network: inserting paths that do not touch tangentially, removing paths and arches.
#pragma once
#include <vector>

#include "sheetform/layout/layout.h"
#include "sheetform/tracing/tracing.h"

namespace sheetform {

/// The network with what is needed to tell tangential contacts in O(path length) (method.md 4.2).
class EditableNetwork {
 public:
  EditableNetwork(const SurfaceMesh& mesh, PathNetwork network) : mesh_(&mesh), network_(std::move(network)) {
    sheet_used_.assign(2 * mesh.points.size(), 0);
  }
  const PathNetwork& network() const { return network_; }

  /// Whether the path can be inserted: all its edges are free, it crosses others only transversally, and it
  /// shares no vertex with a path of its own direction.
  bool fits(const Path& path) const;
  /// Marks the path's edges; returns its id.
  int insert(const Path& path, PathKind kind);
  /// Marks edges without directions (cuts).
  int insert_edges(const std::vector<int>& edges, PathKind kind);
  /// Frees these edges.
  void remove_edges(const std::vector<int>& edges);
  void restore_edges(const std::vector<int>& edges, const std::vector<int>& paths);
  std::vector<int> edges_of_path(int path) const;
  /// True when freeing the edges leaves a loose end: a network vertex of degree 1.
  bool leaves_loose_end(const std::vector<int>& edges) const;
  std::vector<int> path_edges(const Path& path) const;

 private:
  bool alternates(int v, int edge_in, int edge_out) const;
  bool end_fits(int v, int edge) const;
  const SurfaceMesh* mesh_;
  PathNetwork network_;
  std::vector<char> sheet_used_;  // 2 * vertex + direction mod 2
};

}  // namespace sheetform
