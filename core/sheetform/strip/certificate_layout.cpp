// S1, S2, S4, S5 and what S7 and S9 ask across patches.
#include <algorithm>
#include <cmath>
#include <functional>

#include "sheetform/mesh/mesh_repair.h"
#include "sheetform/strip/certificate_checks.h"
#include "sheetform/strip/close_points.h"

namespace sheetform::certificate {
namespace {

std::string edge_name(int a, int b) { return "v" + std::to_string(a) + "-v" + std::to_string(b); }
std::string patch_name(int p) { return p < 0 ? "the border" : "patch " + std::to_string(p); }

bool in_range(int i, std::size_t n) { return i >= 0 && static_cast<std::size_t>(i) < n; }

// Not beyond 1e60 either: products of such coordinates overflow.
template <class V>
bool usable(const V& v) {
  return v.allFinite() && v.cwiseAbs().maxCoeff() <= 1e60;
}

Defect bad_index(const std::string& text, int patch) { return {"S1", text, patch, Vector3::Zero()}; }

void check_arch_indices(const StripMesh& r, std::vector<Defect>& out) {
  for (std::size_t a = 0; a < r.arches.size(); ++a) {
    const StripMesh::Arch& arch = r.arches[a];
    bool good = arch.vertices.size() >= 2 && in_range(arch.patches[0], r.patches.size()) &&
                (arch.patches[1] == -1 || in_range(arch.patches[1], r.patches.size()));
    for (int v : arch.vertices) good = good && in_range(v, r.points.size());
    if (!good)
      out.push_back(
          bad_index("arch " + std::to_string(a) + " names a vertex or a patch that does not exist", -1));
  }
}

// Where the boundary's arches begin, as far as they follow each other around the loop.
struct Walk {
  std::vector<int> begins;
  bool closed = false;
};

bool follows(const std::vector<int>& arch, const std::vector<int>& loop, std::size_t at) {
  const std::size_t m = arch.size() - 1, n = loop.size();
  bool forward = true, backward = true;
  for (std::size_t i = 0; i <= m; ++i) {
    forward = forward && arch[i] == loop[(at + i) % n];
    backward = backward && arch[m - i] == loop[(at + i) % n];
  }
  return forward || backward;
}

Walk walk_arches(const StripMesh& r, const std::vector<int>& arches, const std::vector<int>& loop) {
  Walk best;
  const std::size_t n = loop.size();
  for (std::size_t start = 0; start < n && !best.closed && !arches.empty(); ++start) {
    Walk walk;
    std::size_t walked = 0;
    for (int a : arches) {
      const std::vector<int>& arch = r.arches[a].vertices;
      if (!follows(arch, loop, (start + walked) % n)) break;
      walk.begins.push_back(static_cast<int>((start + walked) % n));
      walked += arch.size() - 1;
    }
    walk.closed = walk.begins.size() == arches.size() && walked == n;
    if (walk.closed || walk.begins.size() > best.begins.size()) best = std::move(walk);
  }
  return best;
}

void check_boundary(const Whole& w, int patch, std::vector<Defect>& out) {
  const StripMesh::Patch& listed = w.result.patches[patch];
  const PatchShape& shape = w.shapes[patch];
  const auto fault = [&](const std::string& text) {
    out.push_back({"S4", text, patch, place_of(w.result, patch)});
  };
  const std::vector<int> loop = shape.loop_points(), uvs = shape.loop_uvs();
  const int start = place_in_loop(listed.boundary, loop);
  if (start < 0) fault("`boundary` is not the border of the patch, counter-clockwise");
  for (std::size_t i = 0; start >= 0 && i < listed.boundary_vt.size(); ++i)
    if (listed.boundary_vt[i] != uvs[(start + i) % uvs.size()])
      return fault("`boundary_vt` does not go with `boundary`");
  if (!std::is_sorted(listed.corners.begin(), listed.corners.end()) ||
      std::adjacent_find(listed.corners.begin(), listed.corners.end()) != listed.corners.end())
    fault("`corners` are not ascending");
  const Walk walk = walk_arches(w.result, listed.arches, loop);
  if (listed.arches.empty()) return fault("the patch lists no arches");
  if (walk.begins.size() < listed.arches.size())
    return fault("arch " + std::to_string(listed.arches[walk.begins.size()]) +
                 " does not continue the boundary");
  if (!walk.closed) return fault("the arches do not close the boundary");
  if (start < 0) return;
  for (int k : listed.corners) {
    const int place = static_cast<int>((static_cast<std::size_t>(start) + k) % loop.size());
    if (std::find(walk.begins.begin(), walk.begins.end(), place) == walk.begins.end())
      fault("corner " + std::to_string(k) + " (v" + std::to_string(listed.boundary[k]) +
            ") is no end of its arches");
  }
}

void compare_topology(const Topology& t, const SurfaceMesh& input, std::vector<Defect>& out) {
  const auto counts = [](int components, int border_loops, int euler) {
    return std::to_string(components) + " components, " + std::to_string(border_loops) +
           " border loops, chi " + std::to_string(euler);
  };
  const std::string now = counts(t.components, t.border_loops, t.euler()),
                    wanted = counts(face_components(input).second, count_border_loops(input),
                                    input.vertex_count() - input.edge_count() + input.face_count());
  if (now != wanted)
    out.push_back({"S2", "the result has " + now + "; the input has " + wanted, -1, Vector3::Zero()});
}

// Area-weighted sum of the cosines between the normals of each component and those of the surface nearest to
// it.
std::vector<double> agreements(const Whole& w, const ClosestPointTree& tree,
                               const std::function<Vector3(int)>& normal_of,
                               const std::vector<char>& wanted) {
  const std::vector<Vector3>& p = w.result.points;
  std::vector<double> agreement(w.topology.components, 0);
  for (std::size_t f = 0; f < w.faces.size(); ++f) {
    const int c = w.topology.component[f];
    if (!wanted[c]) continue;
    const Triple& x = w.faces[f];
    const Vector3 normal = (p[x[1]] - p[x[0]]).cross(p[x[2]] - p[x[0]]);
    const ClosestPoint hit = tree.closest((p[x[0]] + p[x[1]] + p[x[2]]) / 3);
    if (hit.face >= 0) agreement[c] += normal.dot(normal_of(hit.face).stableNormalized());
  }
  return agreement;
}

// Each component must show its outside where the input does. A small one that lies on a larger one (a flap
// that repair cut off) is nearest to either of them: what it was made from decides. Of a sheet without
// thickness nothing tells.
void compare_orientation(const Whole& w, const SurfaceMesh& input, const ClosestPointTree& tree,
                         std::vector<Defect>& out) {
  const int count = w.topology.components;
  const std::vector<double> agreement = agreements(
      w, tree, [&](int f) { return input.face_normal_raw(f); }, std::vector<char>(count, 1));
  std::vector<int> first(count, -1), origin;  // origin: of each face of the input, its component
  for (std::size_t f = w.faces.size(); f-- > 0;) first[w.topology.component[f]] = static_cast<int>(f);
  for (int c = 0; c < count; ++c) {
    if (agreement[c] >= 0) continue;
    if (origin.empty()) origin = face_components(input).first;
    const int patch = w.patch_of[first[c]];
    std::vector<int> own;
    for (int f = 0; f < input.face_count(); ++f)
      if (origin[f] == w.result.patches[patch].component) own.push_back(f);
    TriangleSoup alone{input.points, {}};
    for (int f : own) alone.faces.push_back(input.faces[f]);
    const ClosestPointTree tree_alone(alone.points, alone.faces);
    std::vector<char> wanted(count, 0);
    wanted[c] = 1;
    const auto normal_of = [&](int f) { return input.face_normal_raw(own[f]); };
    const bool against =
        own.empty() || (agreements(w, tree_alone, normal_of, wanted)[c] < 0 && has_thickness(alone));
    if (against)
      out.push_back(
          {"S2", "a component is oriented against the input", patch, w.result.points[w.faces[first[c]][0]]});
  }
}

}  // namespace

std::vector<Defect> check_patch_indices(const StripMesh& r, int p) {
  std::vector<Defect> out;
  const StripMesh::Patch& patch = r.patches[p];
  bool good = true, finite = true;
  for (const StripMesh::Triangle& t : patch.triangles)
    for (int k = 0; k < 3; ++k) {
      const bool there = in_range(t.v[k], r.points.size()) && in_range(t.vt[k], r.uvs.size());
      good = good && there;
      finite = finite && (!there || (usable(r.points[t.v[k]]) && usable(r.uvs[t.vt[k]])));
    }
  for (int v : patch.boundary) good = good && in_range(v, r.points.size());
  for (const auto& [a, b] : patch.rulings)
    good = good && in_range(a, r.points.size()) && in_range(b, r.points.size());
  if (!good)
    out.push_back(bad_index("a triangle, the boundary or a ruling names a vertex that does not exist", p));
  if (!finite) out.push_back(bad_index("a coordinate is not finite", p));
  return out;
}

std::vector<Defect> check_indices(const StripMesh& r) {
  std::vector<Defect> out;
  const int patches = static_cast<int>(r.patches.size());
  if (patches == 0) out.push_back(bad_index("there are no patches", -1));
  for (int p = 0; p < patches; ++p) {
    append(out, check_patch_indices(r, p));
    const StripMesh::Patch& patch = r.patches[p];
    bool good =
        patch.mirror_of == -1 || (in_range(patch.mirror_of, r.patches.size()) && patch.mirror_of != p);
    for (int a : patch.arches) good = good && in_range(a, r.arches.size());
    for (int k : patch.corners) good = good && in_range(k, patch.boundary.size());
    for (int t : patch.boundary_vt) good = good && in_range(t, r.uvs.size());
    good = good && (patch.boundary_vt.empty() || patch.boundary_vt.size() == patch.boundary.size());
    if (!good) out.push_back(bad_index("arches, corners, boundary_vt or mirror_of are out of range", p));
  }
  check_arch_indices(r, out);
  return out;
}

Whole::Whole(const StripMesh& strips) : result(strips) {
  for (const StripMesh::Patch& p : strips.patches) shapes.push_back(shape_of(p));
  Strips surface(strips);
  faces = std::move(surface.faces), patch_of = std::move(surface.patch_of);
  table = EdgeTable(faces);
  topology = topology_of(faces, table, static_cast<int>(strips.points.size()));
  patch_edge.assign(table.edges.size(), 0);
  valence.assign(strips.points.size(), 0);
  for (const PatchShape& shape : shapes) {
    if (!shape.disk) continue;
    for (const EdgeTable::Edge& e : shape.table.edges)
      if (e.count == 1) patch_edge[table.find(shape.vertices[e.a][0], shape.vertices[e.b][0])] = 1;
  }
  for (std::size_t i = 0; i < table.edges.size(); ++i) {
    const EdgeTable::Edge& e = table.edges[i];
    if (e.count == 1) patch_edge[i] = 1;
    for (int k = 1; k < e.count; ++k)
      if (patch_of[table.use(e, k).face] != patch_of[table.use(e, 0).face]) patch_edge[i] = 1;
    if (patch_edge[i]) ++valence[e.a], ++valence[e.b];
  }
}

std::vector<Defect> check_surface(const Whole& w, const SurfaceMesh* input, const ClosestPointTree& tree) {
  std::vector<Defect> out;
  const Topology& t = w.topology;
  const auto at_edge = [&](int i, const char* text) {
    const EdgeTable::Edge& e = w.table.edges[i];
    out.push_back(
        {"S2", edge_name(e.a, e.b) + text, w.patch_of[w.table.use(e, 0).face], w.result.points[e.a]});
  };
  if (t.nonmanifold_edge >= 0) at_edge(t.nonmanifold_edge, " has more than two faces");
  if (t.nonmanifold_vertex >= 0)
    out.push_back({"S2", "at v" + std::to_string(t.nonmanifold_vertex) + " the surface touches itself", -1,
                   w.result.points[t.nonmanifold_vertex]});
  if (t.misoriented_edge >= 0) at_edge(t.misoriented_edge, " lies between faces of opposite orientation");
  if (!input) return out;
  compare_topology(t, *input, out);
  if (t.manifold() && t.oriented()) compare_orientation(w, *input, tree, out);
  return out;
}

std::vector<Defect> check_boundaries(const Whole& w, int max_sides) {
  std::vector<Defect> out;
  for (std::size_t p = 0; p < w.shapes.size(); ++p) {
    const int sides = std::max<int>(1, static_cast<int>(w.result.patches[p].corners.size()));
    if (sides > max_sides)
      out.push_back({"S4", "the patch has " + std::to_string(sides) + " sides", static_cast<int>(p),
                     place_of(w.result, static_cast<int>(p))});
    if (w.shapes[p].disk) check_boundary(w, static_cast<int>(p), out);
  }
  for (std::size_t a = 0; a < w.result.arches.size(); ++a) {
    const std::vector<int>& v = w.result.arches[a].vertices;
    for (std::size_t i = 1; i + 1 < v.size(); ++i)
      if (w.valence[v[i]] > 2)
        out.push_back({"S4", "arch " + std::to_string(a) + " passes the node v" + std::to_string(v[i]), -1,
                       w.result.points[v[i]]});
  }
  return out;
}

std::vector<Defect> check_arches(const Whole& w) {
  std::vector<Defect> out;
  const StripMesh& r = w.result;
  std::vector<int> arch_of(w.table.edges.size(), -1);
  for (std::size_t a = 0; a < r.arches.size(); ++a) {
    const std::vector<int>& v = r.arches[a].vertices;
    for (std::size_t i = 0; i + 1 < v.size(); ++i) {
      const int e = w.table.find(v[i], v[i + 1]);
      const auto fault = [&](const std::string& text) {
        out.push_back({"S5", "arch " + std::to_string(a) + ": " + edge_name(v[i], v[i + 1]) + text,
                       r.arches[a].patches[0], r.points[v[i]]});
      };
      const auto& [p, q] = r.arches[a].patches;
      if (e >= 0 && !w.patch_edge[e] && p == q && !w.shapes[p].disk)
        continue;  // where it is cut open is S3's
      if (e < 0)
        fault(" is no edge of the mesh");
      else if (!w.patch_edge[e])
        fault(" lies inside a patch");
      else if (arch_of[e] >= 0)
        fault(" lies on arch " + std::to_string(arch_of[e]) + " too");
      else
        arch_of[e] = static_cast<int>(a);
    }
  }
  for (std::size_t i = 0; i < w.table.edges.size(); ++i) {
    const EdgeTable::Edge& e = w.table.edges[i];
    if (!w.patch_edge[i] || e.count > 2) continue;
    std::array<int, 2> have{w.patch_of[w.table.use(e, 0).face],
                            e.count == 2 ? w.patch_of[w.table.use(e, 1).face] : -1};
    const std::string between =
        edge_name(e.a, e.b) + " between " + patch_name(have[0]) + " and " + patch_name(have[1]);
    if (arch_of[i] < 0) {
      out.push_back({"S5", between + " lies on no arch", have[0], r.points[e.a]});
      continue;
    }
    std::array<int, 2> named = r.arches[arch_of[i]].patches;
    if (e.count == 2 && named[0] != have[0]) std::swap(named[0], named[1]);
    if (named != have)
      out.push_back({"S5", between + " lies on arch " + std::to_string(arch_of[i]) + ", which names others",
                     have[0], r.points[e.a]});
  }
  return out;
}

std::vector<Defect> check_uv_owners(const Whole& w) {
  std::vector<Defect> out;
  std::vector<int> owner(w.result.uvs.size(), -1);
  for (std::size_t p = 0; p < w.shapes.size(); ++p)
    for (const auto& [v, t] : w.shapes[p].vertices) {
      if (owner[t] >= 0 && owner[t] != static_cast<int>(p))
        out.push_back({"S7",
                       "vt " + std::to_string(t) + " is used by patches " + std::to_string(owner[t]) +
                           " and " + std::to_string(p),
                       static_cast<int>(p), w.result.points[v]});
      owner[t] = static_cast<int>(p);
    }
  return out;
}

std::vector<Defect> check_doubled_points(const StripMesh& r, const std::vector<int>& points,
                                         double diagonal) {
  std::vector<Defect> out;
  for (const auto& [a, b] : close_points(r.points, points, kDegenerate * diagonal))
    out.push_back({"S9", "v" + std::to_string(a) + " and v" + std::to_string(b) + " are in one place", -1,
                   r.points[a]});
  return out;
}

}  // namespace sheetform::certificate
