#include "sheetform/layout/layout.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

namespace sheetform {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

std::uint64_t mix(std::uint64_t h, std::uint64_t x) {
  h ^= x + 0x9e3779b97f4a7c15ull + (h << 6) + (h >> 2);
  h *= 0xff51afd7ed558ccdull;
  return h ^ (h >> 32);
}

// Angle of the surface at each vertex.
std::vector<double> vertex_angles(const SurfaceMesh& mesh) {
  std::vector<double> angle(mesh.points.size(), 0);
  for (const auto& t : mesh.faces)
    for (int k = 0; k < 3; ++k) {
      const Vector3 a = mesh.points[t[(k + 1) % 3]] - mesh.points[t[k]];
      const Vector3 b = mesh.points[t[(k + 2) % 3]] - mesh.points[t[k]];
      angle[t[k]] += angle_between(a, b);
    }
  return angle;
}

class Extractor {
 public:
  Extractor(const SurfaceMesh& mesh, const PathNetwork& network, const std::vector<int>& versions,
            const LayoutRules& rules)
      : mesh_(mesh), net_(network), versions_(versions), rules_(rules) {}

  PatchLayout run(std::vector<int> faces) {
    out_.face_patch.assign(mesh_.faces.size(), -1);
    if (!std::is_sorted(faces.begin(), faces.end())) std::sort(faces.begin(), faces.end());
    take(faces);
    return finished();
  }

  PatchLayout run_after(PatchLayout before) {
    const std::vector<char> changed = changed_patches(before);
    std::vector<int> faces;
    for (int f = 0; f < mesh_.face_count(); ++f)
      if (changed[before.face_patch[f]]) before.face_patch[f] = -1, faces.push_back(f);
    out_.face_patch = std::move(before.face_patch);
    take(faces);
    for (std::size_t p = 0; p < changed.size(); ++p)
      if (!changed[p]) keep(before.patches[p]);
    number_by_lowest_face();
    return finished();
  }

 private:
  // By patch of an earlier layout: whether an edge or a vertex of it is other than it was.
  std::vector<char> changed_patches(const PatchLayout& before) const {
    std::vector<char> changed(before.patches.size(), 0);
    const auto mark = [&](int e) {
      for (int f : {mesh_.edges[e].f0, mesh_.edges[e].f1})
        if (f >= 0) changed[before.face_patch[f]] = 1;
    };
    for (int e = 0; e < mesh_.edge_count(); ++e)
      if ((before.edge_arch[e] >= 0) != net_.used(e)) mark(e);
    for (int v = 0; v < mesh_.vertex_count(); ++v)
      if (before.versions[v] != versions_[v])
        std::for_each(mesh_.ring_begin_of(v), mesh_.ring_end_of(v), mark);
    return changed;
  }

  void keep(Patch& old) {
    Patch& patch = out_.patches.emplace_back();
    patch.faces = std::move(old.faces), patch.outline = std::move(old.outline);
    patch.area = old.area, patch.moves = old.moves, patch.inner_vertices = old.inner_vertices;
  }

  // As if all faces had been flooded in their order.
  void number_by_lowest_face() {
    std::sort(out_.patches.begin(), out_.patches.end(),
              [](const Patch& a, const Patch& b) { return a.faces.front() < b.faces.front(); });
    for (std::size_t p = 0; p < out_.patches.size(); ++p)
      for (int f : out_.patches[p].faces) out_.face_patch[f] = static_cast<int>(p);
  }

  // Patches of these faces, which ascend.
  void take(const std::vector<int>& faces) {
    for (int f : faces) flood(f);
    for (int f : faces) collect(f);
  }

  // What follows from the outlines.
  PatchLayout finished() {
    out_.node.assign(mesh_.points.size(), 0);
    out_.edge_arch.assign(mesh_.edges.size(), -1);
    mark_nodes();
    chain_arches();
    walk_boundaries();
    for (std::size_t p = 0; p < out_.patches.size(); ++p) judge(static_cast<int>(p));
    return std::move(out_);
  }

  // Labels all faces that hang together with this one.
  void flood(int seed) {
    if (out_.face_patch[seed] >= 0) return;
    const int id = static_cast<int>(out_.patches.size());
    out_.patches.emplace_back();
    std::vector<int> stack{seed};
    out_.face_patch[seed] = id;
    while (!stack.empty()) {
      const int f = stack.back();
      stack.pop_back();
      for (int k = 0; k < 3; ++k) {
        const int g = mesh_.face_neighbours[f][k];
        if (g >= 0 && out_.face_patch[g] < 0 && !net_.used(mesh_.face_edges[f][k]))
          out_.face_patch[g] = id, stack.push_back(g);
      }
    }
  }

  // Gives a labelled face to its patch; all that follows looks at outlines alone.
  void collect(int f) {
    const int id = out_.face_patch[f];
    Patch& patch = out_.patches[id];
    patch.faces.push_back(f);
    patch.area += mesh_.face_normal_raw(f).norm() / 2;
    for (int k = 0; k < 3; ++k)
      if (net_.used(mesh_.face_edges[f][k])) patch.outline.push_back(3 * f + k);
    for (int v : mesh_.faces[f])
      if (versions_[v] != 0) patch.moves += mix(v, versions_[v]);
  }

  void mark_nodes() {
    for (const Patch& patch : out_.patches)  // outlines are loops: every vertex starts an edge
      for (int side : patch.outline) mark_node(mesh_.faces[side / 3][side % 3]);
  }

  void mark_node(int v) {
    int degree = 0, first = -1;
    bool differ = false;
    for (const int* e = mesh_.ring_begin_of(v); e != mesh_.ring_end_of(v); ++e) {
      const int path = net_.edge_path[*e];
      if (path == PathNetwork::kFree) continue;
      if (degree++ == 0) first = path;
      differ |= path != first;
    }
    out_.node[v] = degree == 0                     ? PatchLayout::kNone
                   : degree != 2                   ? PatchLayout::kMeeting
                   : differ || net_.pinned_node[v] ? PatchLayout::kBend
                                                   : PatchLayout::kNone;
  }

  int next_edge(int v, int from) const {
    for (const int* e = mesh_.ring_begin_of(v); e != mesh_.ring_end_of(v); ++e)
      if (*e != from && net_.used(*e)) return *e;
    return -1;
  }

  // The face on the left of the directed edge a -> b, -1 outside.
  int left_face(int e, int a) const {
    const auto& edge = mesh_.edges[e];
    for (int f : {edge.f0, edge.f1}) {
      if (f < 0) continue;
      for (int k = 0; k < 3; ++k)
        if (mesh_.face_edges[f][k] == e && mesh_.faces[f][k] == a) return f;
    }
    return -1;
  }

  int side(int e, int from) const {
    const int f = left_face(e, from);
    return f < 0 ? Arch::kOutside : out_.face_patch[f] < 0 ? Arch::kUnknown : out_.face_patch[f];
  }

  // From edge e on through vertex v, to the last edge before a node (or around a closed arch, back to e).
  std::pair<int, int> run_to_end(int e, int v) const {
    for (int last = e; !out_.node[v];) {
      const int next = next_edge(v, last);
      if (next < 0 || next == e) return {-1, -1};  // closed
      v = mesh_.edges[next].other(v);
      last = next;
      if (out_.node[v]) return {v, last};
    }
    return {v, e};
  }

  // Where an arch starts does not depend on how it was found: at the end with the lower (vertex, edge), and a
  // closed one without nodes at its lowest vertex, towards the lower neighbour.
  void trace_arch(int e) {
    auto a = run_to_end(e, mesh_.edges[e].v0), b = run_to_end(e, mesh_.edges[e].v1);
    if (a.first < 0) {
      int v = mesh_.edges[e].v0, lowest = v, at = e;
      for (int x = e; (x = next_edge(v, x)) != e;) v = mesh_.edges[x].other(v), lowest = std::min(lowest, v);
      at = next_edge(lowest, -1);
      const int other = next_edge(lowest, at);
      a = b = {lowest, mesh_.edges[at].other(lowest) < mesh_.edges[other].other(lowest) ? at : other};
    }
    walk_arch(std::min(a, b).first, std::min(a, b).second);
  }

  void walk_arch(int v, int e) {
    const int id = static_cast<int>(out_.arches.size());
    out_.arches.emplace_back();
    Arch& arch = out_.arches.back();
    arch.path = net_.edge_path[e];
    const int start = v;
    arch.vertices.push_back(v);
    arch.left = side(e, v);
    arch.right = side(e, mesh_.edges[e].other(v));
    while (e >= 0) {
      out_.edge_arch[e] = id;
      arch.edges.push_back(e);
      arch.length += mesh_.edge_length(e);
      v = mesh_.edges[e].other(v);
      arch.vertices.push_back(v);
      if (v == start || out_.node[v]) break;
      e = next_edge(v, e);
    }
    arch.key = static_cast<std::uint64_t>(arch.path);  // corners depend on which paths meet
    for (int w : arch.vertices)
      arch.key = mix(arch.key, (static_cast<std::uint64_t>(w) << 32) ^ static_cast<unsigned>(versions_[w]));
  }

  void chain_arches() {
    for (const Patch& patch : out_.patches)
      for (int side : patch.outline)
        if (const int e = mesh_.face_edges[side / 3][side % 3]; out_.edge_arch[e] < 0) trace_arch(e);
  }

  // The next boundary half-edge after corner k of f, turning inside the patch.
  std::pair<int, int> successor(int f, int k) const {
    const int v = mesh_.faces[f][(k + 1) % 3];
    k = (k + 1) % 3;
    while (!net_.used(mesh_.face_edges[f][k])) {
      f = mesh_.edges[mesh_.face_edges[f][k]].other_face(f);
      for (k = 0; mesh_.faces[f][k] != v;) ++k;
    }
    return {f, k};
  }

  // Cyclic sequence of arch uses of the loop through half-edge (f, k).
  std::vector<ArchUse> walk_loop(int f, int k) {
    std::vector<ArchUse> uses;
    const int f0 = f, k0 = k;
    do {
      seen_[3 * f + k] = 1;
      const int arch = out_.edge_arch[mesh_.face_edges[f][k]];
      const int v = mesh_.faces[f][k];
      // A new arch begins at a node, or at the seam of a closed arch.
      if (uses.empty() || out_.node[v]) uses.push_back({arch, is_forward(arch, mesh_.face_edges[f][k], v)});
      std::tie(f, k) = successor(f, k);
    } while (f != f0 || k != k0);
    return uses;
  }

  bool is_forward(int arch, int edge, int from) const {
    const Arch& a = out_.arches[arch];
    if (a.edges.size() == 1) return a.vertices[0] == from;
    for (std::size_t i = 0; i < a.edges.size(); ++i)
      if (a.edges[i] == edge) return a.vertices[i] == from;
    return true;
  }

  void walk_boundaries() {
    seen_.assign(3 * mesh_.faces.size(), 0);
    for (std::size_t p = 0; p < out_.patches.size(); ++p)
      for (int side : out_.patches[p].outline) {
        if (seen_[side]) continue;
        // Start at a node, so that no arch is entered in its middle.
        auto [g, j] = std::pair{side / 3, side % 3};
        while (!out_.node[mesh_.faces[g][j]]) {
          std::tie(g, j) = successor(g, j);
          if (3 * g + j == side) break;
        }
        auto uses = walk_loop(g, j);
        if (out_.patches[p].loops++ == 0) out_.patches[p].boundary = std::move(uses);
      }
  }

  // Of the patch cut open: inner vertices - inner edges + faces (vertices and edges of the outline cancel).
  int euler(int p) {
    Patch& patch = out_.patches[p];
    if (patch.inner_vertices < 0) patch.inner_vertices = count_inner_vertices(p);
    const auto faces = static_cast<int>(patch.faces.size()), outer = static_cast<int>(patch.outline.size());
    return patch.inner_vertices - (3 * faces - outer) / 2 + faces;
  }

  int count_inner_vertices(int p) {
    const Patch& patch = out_.patches[p];
    int vertices = 0;
    const auto count = [&](int v, int by, int mark) {
      if (stamp(v) != mark) stamp(v) = mark, vertices += by;
    };
    for (int f : patch.faces)
      for (int v : mesh_.faces[f]) count(v, 1, 2 * p + 1);
    for (int side : patch.outline)
      for (int corner : {side % 3, (side % 3 + 1) % 3}) count(mesh_.faces[side / 3][corner], -1, 2 * p + 2);
    return vertices;
  }

  int& stamp(int v) {
    if (stamps_.empty()) stamps_.assign(mesh_.points.size(), 0);
    return stamps_[v];
  }

  void judge(int p) {
    Patch& patch = out_.patches[p];
    const bool disk = patch.loops == 1 && euler(p) == 1;
    patch.defect = disk ? contact(patch) : TopologyDefect::kNotADisk;
    patch.key = mix(patch.faces.size() + patch.moves, static_cast<std::uint64_t>(patch.loops));
    for (const ArchUse& use : patch.boundary) {
      const std::vector<int>& line = out_.arches[use.arch].vertices;
      const char start =
          out_.node[use.forward ? line.front() : line.back()];  // what is a corner depends on it
      patch.key = mix(patch.key, (out_.arches[use.arch].key * 2 + use.forward) * 4 + start);
    }
  }

  // A patch may meet itself along a seam, never at a single vertex.
  TopologyDefect contact(const Patch& patch) {
    bool seam = false;
    std::vector<int> visits;
    for (const ArchUse& use : patch.boundary) {
      const Arch& a = out_.arches[use.arch];
      const bool self = a.left == a.right;
      seam |= self;
      if (a.closed() && self) return TopologyDefect::kNotADisk;
      const int first = use.forward ? a.vertices.front() : a.vertices.back();
      visits.push_back(first);
      const bool may_end = rules_.darts && !is_held(net_.kinds[a.path]);
      if (self && !may_end)
        for (int end : {a.vertices.front(), a.vertices.back()})
          if (network_degree(mesh_, net_, end) == 1) return TopologyDefect::kDangling;
    }
    if (seam && !rules_.self_seams) return TopologyDefect::kSelfSeam;
    std::sort(visits.begin(), visits.end());
    for (std::size_t i = 0; i + 1 < visits.size(); ++i)
      if (visits[i] == visits[i + 1] && !on_self_seam(patch, visits[i]))
        return TopologyDefect::kTouchesItself;
    return TopologyDefect::kNone;
  }

  bool on_self_seam(const Patch& patch, int v) const {
    for (const ArchUse& use : patch.boundary) {
      const Arch& a = out_.arches[use.arch];
      if (a.left == a.right && (a.vertices.front() == v || a.vertices.back() == v)) return true;
    }
    return false;
  }

  const SurfaceMesh& mesh_;
  const PathNetwork& net_;
  const std::vector<int>& versions_;
  const LayoutRules& rules_;
  PatchLayout out_;
  std::vector<char> seen_;
  std::vector<int> stamps_;
};

}  // namespace

PathNetwork bare_network(const SurfaceMesh& mesh) {
  PathNetwork network;
  network.add_path(PathKind::kBorder);
  network.edge_path.assign(mesh.edges.size(), PathNetwork::kFree);
  network.pinned_node.assign(mesh.points.size(), 0);
  for (int e = 0; e < mesh.edge_count(); ++e)
    if (mesh.edges[e].border()) network.edge_path[e] = 0;
  const std::vector<double> angles = vertex_angles(mesh);
  for (int v = 0; v < mesh.vertex_count(); ++v)
    network.pinned_node[v] =
        mesh.border_vertex[v] && (angles[v] < 126 * kDegree || angles[v] > 243 * kDegree);
  return network;
}

void add_creases(const SurfaceMesh& mesh, const std::vector<char>& crease_edge, PathNetwork& network,
                 PathKind kind) {
  const auto creases_at = [&](int v) {
    std::vector<int> edges;
    for (const int* e = mesh.ring_begin_of(v); e != mesh.ring_end_of(v); ++e)
      if (crease_edge[*e]) edges.push_back(*e);
    return edges;
  };
  const auto ends_at = [&](int v) {
    const auto edges = creases_at(v);
    if (edges.size() != 2 || mesh.border_vertex[v]) return true;
    const Vector3 a = mesh.points[mesh.edges[edges[0]].other(v)] - mesh.points[v];
    const Vector3 b = mesh.points[mesh.edges[edges[1]].other(v)] - mesh.points[v];
    return a.normalized().dot(b.normalized()) > -std::cos(50 * kDegree);
  };
  const auto follow = [&](int v, int e) {
    const int path = network.add_path(kind);
    while (network.edge_path[e] == PathNetwork::kFree) {
      network.edge_path[e] = path;
      v = mesh.edges[e].other(v);
      if (ends_at(v)) break;
      const auto edges = creases_at(v);
      e = edges[0] == e ? edges[1] : edges[0];
    }
  };
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    if (!ends_at(v)) continue;
    for (int e : creases_at(v))
      if (network.edge_path[e] == PathNetwork::kFree) follow(v, e);
  }
  for (int e = 0; e < mesh.edge_count(); ++e)
    if (crease_edge[e] && network.edge_path[e] == PathNetwork::kFree) follow(mesh.edges[e].v0, e);
}

void add_symmetry(const std::vector<char>& plane_edge, PathNetwork& network) {
  const int path = network.add_path(PathKind::kSymmetry);
  for (std::size_t e = 0; e < plane_edge.size(); ++e)
    if (plane_edge[e]) network.edge_path[e] = path;
}

int network_degree(const SurfaceMesh& mesh, const PathNetwork& network, int v) {
  int degree = 0;
  for (const int* e = mesh.ring_begin_of(v); e != mesh.ring_end_of(v); ++e) degree += network.used(*e);
  return degree;
}

std::vector<int> with_neighbours(const SurfaceMesh& mesh, const PathNetwork& network,
                                 const std::vector<int>& faces) {
  std::vector<char> taken(mesh.faces.size(), 0);
  for (int f : faces) taken[f] = 1;
  std::vector<int> all = faces;
  const auto take = [&](int f) {
    if (f < 0 || taken[f]) return;
    taken[f] = 1;
    all.push_back(f);
  };
  for (int f : faces)
    for (int e : mesh.face_edges[f])
      if (network.used(e)) take(mesh.edges[e].other_face(f));
  for (std::size_t i = faces.size(); i < all.size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (!network.used(mesh.face_edges[all[i]][k])) take(mesh.face_neighbours[all[i]][k]);
  all.clear();
  for (int f = 0; f < mesh.face_count(); ++f)
    if (taken[f]) all.push_back(f);
  return all;
}

PatchLayout extract_layout(const SurfaceMesh& mesh, const PathNetwork& network,
                           const std::vector<int>& versions, const LayoutRules& rules, PatchLayout before) {
  Extractor extractor(mesh, network, versions, rules);
  if (before.versions.empty()) {
    std::vector<int> every(mesh.faces.size());
    std::iota(every.begin(), every.end(), 0);
    before = extractor.run(std::move(every));
  } else {
    before = extractor.run_after(std::move(before));
  }
  before.versions = versions;
  return before;
}

std::vector<int> largest_first(const PatchLayout& layout, std::vector<int> patches) {
  std::stable_sort(patches.begin(), patches.end(), [&](int a, int b) {
    return layout.patches[a].faces.size() > layout.patches[b].faces.size();
  });
  return patches;
}

PatchLayout extract_region(const SurfaceMesh& mesh, const PathNetwork& network,
                           const std::vector<int>& versions, const LayoutRules& rules,
                           const std::vector<int>& faces) {
  return Extractor(mesh, network, versions, rules).run(faces);
}

}  // namespace sheetform
