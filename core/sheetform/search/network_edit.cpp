#include "sheetform/search/network_edit.h"

#include <algorithm>

namespace sheetform {

std::vector<int> EditableNetwork::path_edges(const Path& path) const {
  std::vector<int> edges;
  const std::size_t n = path.vertices.size();
  for (std::size_t i = 0; i + 1 < n + (path.loop ? 1 : 0); ++i)
    edges.push_back(mesh_->find_edge(path.vertices[i], path.vertices[(i + 1) % n]));
  return edges;
}

// The used edges at v and the two new ones must alternate around v: A, B, A, B.
bool EditableNetwork::alternates(int v, int edge_in, int edge_out) const {
  int used = 0, between = 0;
  bool inside = false;
  for (const int* e = mesh_->ring_begin_of(v); e != mesh_->ring_end_of(v); ++e) {
    if (*e == edge_in || *e == edge_out) {
      inside = !inside;
    } else if (network_.used(*e)) {
      ++used;
      between += inside;
    }
  }
  return used == 0 || (used == 2 && between == 1);
}

// A path may end on a border or crease vertex where nothing else ends on the same side.
bool EditableNetwork::end_fits(int v, int edge) const {
  std::vector<int> fixed, other;
  int position = 0, at = -1;
  for (const int* e = mesh_->ring_begin_of(v); e != mesh_->ring_end_of(v); ++e, ++position) {
    if (*e == edge) at = position;
    if (!network_.used(*e)) continue;
    (is_held(network_.kinds[network_.edge_path[*e]]) ? fixed : other).push_back(position);
  }
  if (fixed.size() != 2) return false;
  if (other.empty()) return true;
  if (other.size() > 1 || mesh_->border_vertex[v]) return false;
  const auto side = [&](int p) { return p > fixed[0] && p < fixed[1]; };
  return side(at) != side(other[0]);
}

bool EditableNetwork::fits(const Path& path) const {
  const std::vector<int> edges = path_edges(path);
  for (int e : edges)
    if (e < 0 || network_.used(e)) return false;
  const int n = static_cast<int>(path.vertices.size());
  for (int i = 0; i < n; ++i) {
    const int v = path.vertices[i];
    const bool first = i == 0 && !path.loop, last = i == n - 1 && !path.loop;
    if (first || last) {
      if (!end_fits(v, first ? edges.front() : edges.back())) return false;
      continue;
    }
    if (sheet_used_[2 * v + (path.dirs[i] & 1)]) return false;
    const int in = edges[(i + static_cast<int>(edges.size()) - 1) % edges.size()], out = edges[i];
    if (!alternates(v, in, out)) return false;
  }
  return true;
}

int EditableNetwork::insert(const Path& path, PathKind kind) {
  const int id = insert_edges(path_edges(path), kind);
  for (std::size_t i = 0; i < path.vertices.size(); ++i)
    sheet_used_[2 * path.vertices[i] + (path.dirs[i] & 1)] = 1;
  return id;
}

int EditableNetwork::insert_edges(const std::vector<int>& edges, PathKind kind) {
  const int id = network_.add_path(kind);
  for (int e : edges) network_.edge_path[e] = id;
  return id;
}

void EditableNetwork::remove_edges(const std::vector<int>& edges) {
  for (int e : edges) network_.edge_path[e] = PathNetwork::kFree;
}

void EditableNetwork::restore_edges(const std::vector<int>& edges, const std::vector<int>& paths) {
  for (std::size_t i = 0; i < edges.size(); ++i) network_.edge_path[edges[i]] = paths[i];
}

std::vector<int> EditableNetwork::edges_of_path(int path) const {
  std::vector<int> edges;
  for (int e = 0; e < mesh_->edge_count(); ++e)
    if (network_.edge_path[e] == path) edges.push_back(e);
  return edges;
}

bool EditableNetwork::leaves_loose_end(const std::vector<int>& edges) const {
  std::vector<int> ends;
  for (int e : edges) ends.push_back(mesh_->edges[e].v0), ends.push_back(mesh_->edges[e].v1);
  std::sort(ends.begin(), ends.end());
  for (std::size_t i = 0; i < ends.size();) {
    std::size_t j = i;
    while (j < ends.size() && ends[j] == ends[i]) ++j;
    if (network_degree(*mesh_, network_, ends[i]) - static_cast<int>(j - i) == 1) return true;
    i = j;
  }
  return false;
}

}  // namespace sheetform
