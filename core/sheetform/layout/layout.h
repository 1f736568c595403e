// The network of paths on the mesh, and the layout it induces: nodes, arches, patches (paper 3.3,
// "topological conditions").
#pragma once
#include <cstdint>
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// Where a path comes from; decides what may be removed.
enum class PathKind : char {
  kBorder,    ///< the surface's border: always there
  kCrease,    ///< sharp edges: arches from the start, removed last
  kTraced,    ///< field-aligned loop or border-to-border path
  kCut,       ///< a split of one patch: ends on other paths (T-junctions)
  kSymmetry,  ///< on the symmetry plane
  kDrawn      ///< a seam that the user has drawn: always there
};

/// Lines of the input or of the user: neither moved nor removed, and other paths may end on them.
inline bool is_held(PathKind kind) { return kind != PathKind::kTraced && kind != PathKind::kCut; }

/// Which path runs along each mesh edge. Path 0 is the surface's border.
struct PathNetwork {
  static constexpr int kFree = -1;
  std::vector<int> edge_path;   ///< per mesh edge: path id or kFree
  std::vector<PathKind> kinds;  ///< per path id
  std::vector<char>
      pinned_node;  ///< per vertex: always a node (corners of the surface's border and of creases)

  int add_path(PathKind kind) {
    kinds.push_back(kind);
    return static_cast<int>(kinds.size()) - 1;
  }
  bool used(int edge) const { return edge_path[edge] != kFree; }
};

/// The network of a bare mesh: border edges are path 0; border vertices with an interior angle outside
/// [126, 243] degrees are pinned (experiments.md, pitfall 7).
PathNetwork bare_network(const SurfaceMesh& mesh);

/// Marks creases (by edge), or drawn seams, as paths of this kind: chains between their ends, junctions and
/// turns of more than 50 degrees. Edges that are used stay what they are.
void add_creases(const SurfaceMesh& mesh, const std::vector<char>& crease_edge, PathNetwork& network,
                 PathKind kind = PathKind::kCrease);

/// Makes the border edges on the plane of symmetry (by edge) a path of their own.
void add_symmetry(const std::vector<char>& plane_edge, PathNetwork& network);

/// Number of network edges at a vertex.
int network_degree(const SurfaceMesh& mesh, const PathNetwork& network, int v);

struct Arch {
  static constexpr int kOutside = -1;  ///< no surface there
  static constexpr int kUnknown = -2;  ///< not part of the extracted region
  std::vector<int> vertices;           ///< mesh vertices from node to node; a closed arch repeats its first
  std::vector<int> edges;
  int path = -1;
  int left = -1, right = -1;  ///< patches on both sides of the walk; kOutside or kUnknown when there is none
  double length = 0;
  std::uint64_t key = 0;  ///< of its geometry: same key = same vertices at the same versions
  bool closed() const { return vertices.front() == vertices.back(); }
};

struct ArchUse {
  int arch;
  bool forward;  ///< the patch lies on the left of the walk
};

enum class TopologyDefect : char { kNone, kNotADisk, kTouchesItself, kSelfSeam, kDangling };

struct Patch {
  std::vector<int> faces;  ///< ascending
  std::vector<ArchUse>
      boundary;  ///< the loop of arches, counter-clockwise (of the first loop when it is no disk)
  int loops = 0;
  TopologyDefect defect = TopologyDefect::kNone;
  double area = 0;
  std::uint64_t key =
      0;  ///< equal keys = same patch, same boundary, all of its vertices at the same versions
  // What the next layout takes over where nothing of it has changed.
  std::vector<int> outline;  ///< its edges on the network as 3 * face + corner, ascending
  std::uint64_t moves = 0;   ///< a hash of where its vertices have moved to
  int inner_vertices = -1;   ///< those not on the outline; -1: not counted
};

struct PatchLayout {
  std::vector<int> face_patch;
  std::vector<Patch> patches;
  std::vector<Arch> arches;
  std::vector<int> edge_arch;  ///< per mesh edge, -1 if none
  /// What a vertex is to the network: no node, a bend where only two of its edges meet, or where others end.
  enum Node : char { kNone, kBend, kMeeting };
  std::vector<char> node;     ///< per vertex
  std::vector<int> versions;  ///< per vertex: those that it was extracted for
};

struct LayoutRules {
  bool self_seams = true;  ///< a patch may be glued to itself along an arch
  bool darts = true;       ///< such an arch may end inside of the patch (creases and drawn seams may not)
};

/// The part of the layout that covers these faces, which must be whole patches; arches and keys are those of
/// the whole layout, patch ids are not. O(faces given) apart from clearing a few arrays.
PatchLayout extract_region(const SurfaceMesh& mesh, const PathNetwork& network,
                           const std::vector<int>& versions, const LayoutRules& rules,
                           const std::vector<int>& faces);

/// These faces, which must be whole patches, and those of all patches beside them; ascending. O(their number)
/// apart from clearing an array.
std::vector<int> with_neighbours(const SurfaceMesh& mesh, const PathNetwork& network,
                                 const std::vector<int>& faces);

/// Floods the faces, chains the edges into arches, walks the patches' boundaries. versions: per vertex,
/// changes when the vertex has moved. before: the layout of an earlier network on the same mesh, or none;
/// patches whose edges and vertices are as they were are taken from it, not flooded anew. O(faces).
PatchLayout extract_layout(const SurfaceMesh& mesh, const PathNetwork& network,
                           const std::vector<int>& versions, const LayoutRules& rules,
                           PatchLayout before = {});

/// These patches, those of the most faces first: what takes longest is to be begun first.
std::vector<int> largest_first(const PatchLayout& layout, std::vector<int> patches);

}  // namespace sheetform
