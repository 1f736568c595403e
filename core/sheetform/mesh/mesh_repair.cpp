#include "sheetform/mesh/mesh_repair.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>

#include "sheetform/base/error.h"
#include "sheetform/mesh/gluing.h"
#include "sheetform/mesh/place_text.h"
#include "sheetform/mesh/prepare.h"
#include "sheetform/mesh/subdivide.h"
#include "sheetform/mesh/weld.h"

namespace sheetform {
namespace {

using gluing::Gluing;

constexpr double kNear = 1e-9;        // of the diagonal: points that are meant to be one
constexpr double kGap = 1e-5;         // of the diagonal: between copies of a vertex that was split
constexpr double kLeastArea = 1e-10;  // of the squared diagonal
constexpr double kNoArea = 1e-14;     // the same; less is rounding

// The first places of one kind of finding.
class Places {
 public:
  void add(const Vector3& place) {
    if (list_.size() < kMarkedPlaces) list_.push_back(place);
  }
  std::vector<Vector3> list() && { return std::move(list_); }

 private:
  std::vector<Vector3> list_;
};

// The soup while it is repaired, with what is known about where its parts come from.
struct Work {
  TriangleSoup soup;
  std::vector<int> face_origin, point_origin;
  std::vector<AuditFinding> findings;

  // one|many, then what follows either.
  void note(const std::string& kind, std::size_t count, const std::string& one, const std::string& many,
            const std::string& rest, Places places) {
    if (count == 0) return;
    const std::string text = std::to_string(count) + " " + (count == 1 ? one : many) + " " + rest;
    findings.push_back({kind, static_cast<int>(count), text, std::move(places).list()});
  }
};

Vector3 side_middle(const TriangleSoup& soup, int side) {
  const auto& t = soup.faces[side / 3];
  return (soup.points[t[side % 3]] + soup.points[t[(side % 3 + 1) % 3]]) / 2;
}

Work start(const TriangleSoup& soup) {
  Work work;
  work.soup = soup;
  work.face_origin.resize(soup.faces.size());
  work.point_origin.resize(soup.points.size());
  std::iota(work.face_origin.begin(), work.face_origin.end(), 0);
  std::iota(work.point_origin.begin(), work.point_origin.end(), 0);
  return work;
}

void drop_unused(Work& work) {
  std::vector<int> id(work.soup.points.size(), -1);
  for (const auto& f : work.soup.faces)
    for (int v : f) id[v] = 0;
  int count = 0;
  Places places;
  for (std::size_t i = 0; i < id.size(); ++i) {
    if (id[i] < 0) {
      places.add(work.soup.points[i]);
      continue;
    }
    id[i] = count;
    work.point_origin[count++] = work.point_origin[i];
  }
  if (static_cast<std::size_t>(count) == id.size()) return;
  work.note("unused-vertex", work.soup.points.size() - static_cast<std::size_t>(count),
            "vertex without a face was", "vertices without a face were", "left out", std::move(places));
  for (std::size_t i = 0; i < id.size(); ++i)
    if (id[i] >= 0) work.soup.points[id[i]] = work.soup.points[i];
  work.soup.points.resize(count);
  work.point_origin.resize(count);
  for (auto& f : work.soup.faces)
    for (int& v : f) v = id[v];
}

void merge(Work& work, const std::vector<int>& classes, const std::string& where) {
  int count = 0;
  Places places;
  for (std::size_t i = 0; i < classes.size(); ++i) {
    if (classes[i] == count)
      work.point_origin[count++] = work.point_origin[i];
    else
      places.add(work.soup.points[i]);
  }
  work.note("duplicate-vertex", classes.size() - static_cast<std::size_t>(count), "vertex " + where + " was",
            "vertices " + where + " were", "merged with it", std::move(places));
  work.point_origin.resize(count);
  merge_classes(classes, work.soup.points, work.soup.faces);
}

// Keeps the faces for which keep(f) holds.
template <class Keep>
void filter_faces(Work& work, const char* kind, const std::string& which, const Keep& keep) {
  std::size_t kept = 0;
  Places places;
  const std::size_t before = work.soup.faces.size();
  for (std::size_t f = 0; f < before; ++f) {
    if (!keep(f)) {
      places.add(work.soup.points[work.soup.faces[f][0]]);
      continue;
    }
    work.soup.faces[kept] = work.soup.faces[f];
    work.face_origin[kept++] = work.face_origin[f];
  }
  work.soup.faces.resize(kept);
  work.face_origin.resize(kept);
  work.note(kind, before - kept, "face " + which + " was", "faces " + which + " were", "left out",
            std::move(places));
}

void drop_collapsed(Work& work) {
  filter_faces(work, "degenerate-face", "with less than three different vertices", [&](std::size_t f) {
    const auto& t = work.soup.faces[f];
    return t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
  });
}

void drop_duplicates(Work& work) {
  const auto& faces = work.soup.faces;
  std::vector<std::array<int, 4>> keys(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    std::array<int, 3> t = faces[f];
    std::sort(t.begin(), t.end());
    keys[f] = {t[0], t[1], t[2], static_cast<int>(f)};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<char> again(faces.size(), 0);
  for (std::size_t i = 1; i < keys.size(); ++i)
    if (std::equal(keys[i].begin(), keys[i].begin() + 3, keys[i - 1].begin())) again[keys[i][3]] = 1;
  filter_faces(work, "duplicate-face", "on the same vertices as another one",
               [&](std::size_t f) { return !again[f]; });
}

// Components of faces that have no area all together go, such as a needle that was cut open from the faces at
// its sides: no sheet could be made of them. Whether there were any; what has no area at all stays.
bool drop_without_area(Work& work, const Gluing& g) {
  const double diagonal = bounding_box_diagonal(work.soup.points), least = kNoArea * diagonal * diagonal;
  const int n = static_cast<int>(work.soup.faces.size());
  std::vector<char> seen(n, 0), empty(n, 0);
  int left = n;
  for (int seed = 0; seed < n; ++seed) {
    if (seen[seed] || gluing::area(work.soup, seed) > least) continue;
    std::vector<int> component{seed};
    double sum = 0;
    seen[seed] = 1;
    for (std::size_t i = 0; i < component.size(); ++i) {
      sum += gluing::area(work.soup, component[i]);
      for (int side = 3 * component[i]; side < 3 * component[i] + 3; ++side)
        if (const int f = g.partner[side] / 3; g.partner[side] >= 0 && !seen[f])
          seen[f] = 1, component.push_back(f);
    }
    if (sum > least) continue;
    for (int f : component) empty[f] = 1, --left;
  }
  if (left == n || left == 0) return false;
  filter_faces(work, "no-area", "of components without any area", [&](std::size_t f) { return !empty[f]; });
  drop_unused(work);
  return true;
}

// Every side has at most one partner of opposite direction, every vertex one fan.
bool is_clean(const TriangleSoup& soup, const Gluing& g) {
  if (!g.crowded.empty()) return false;
  for (int s = 0; s < static_cast<int>(g.partner.size()); ++s)
    if (g.partner[s] >= 0 && soup.faces[s / 3][s % 3] == soup.faces[g.partner[s] / 3][g.partner[s] % 3])
      return false;
  std::vector<int> origin;
  gluing::fan_vertices(soup, g, origin);
  return origin.size() == soup.points.size();
}

void note_topology(Work& work, const Gluing& g) {
  const TriangleSoup& soup = work.soup;
  auto middles = [&](const std::vector<int>& sides) {
    Places places;
    for (int s : sides) places.add(side_middle(soup, s));
    return places;
  };
  work.note("non-manifold-edge", g.crowded.size(), "edge with more than two faces was",
            "edges with more than two faces were", "cut open", middles(g.crowded));
  Places turned;
  for (std::size_t f = 0; f < g.turned.size(); ++f)
    if (g.turned[f]) turned.add(soup.points[soup.faces[f][0]]);
  work.note("opposite-orientation", static_cast<std::size_t>(std::count(g.turned.begin(), g.turned.end(), 1)),
            "face was", "faces were", "turned over to match the majority of their component",
            std::move(turned));
  work.note("non-orientable", static_cast<std::size_t>(g.one_sided_components),
            "component with a single side (as a Moebius strip) was",
            "components with a single side (as a Moebius strip) were",
            "cut open along " + std::to_string(g.cut.size()) +
                " edges, because a sheet has two sides: the result has other borders there than the mesh",
            middles(g.cut));
}

// Vertices that fall apart though no edge at them was cut.
void note_bow_ties(Work& work, const Gluing& g, const std::vector<int>& origin) {
  std::vector<char> at_cut(work.soup.points.size(), 0);
  for (const auto* sides : {&g.crowded, &g.cut})
    for (int s : *sides)
      for (int k = 0; k < 2; ++k) at_cut[work.soup.faces[s / 3][(s % 3 + k) % 3]] = 1;
  std::size_t count = 0;
  Places places;
  for (std::size_t i = 1; i < origin.size(); ++i)
    if (origin[i] == origin[i - 1] && !at_cut[origin[i]] && (i == 1 || origin[i - 2] != origin[i])) {
      ++count;
      places.add(work.soup.points[origin[i]]);
    }
  work.note("bow-tie-vertex", count, "vertex where parts touch in a point was",
            "vertices where parts touch in a point were", "split", std::move(places));
}

// Copies of one vertex are moved apart, each into its own fan: two vertices at one place would make results
// whose borders touch. `faces` use the new vertices, still turned as they were.
void pull_apart(const std::vector<std::array<int, 3>>& faces, const std::vector<int>& origin,
                std::vector<Vector3>& points) {
  const double step = kGap * bounding_box_diagonal(points);
  std::vector<Vector3> sum(points.size(), Vector3::Zero()), normal(points.size(), Vector3::Zero());
  std::vector<double> length(points.size(), 0),
      shortest(points.size(), std::numeric_limits<double>::infinity());
  for (const auto& f : faces)
    for (int k = 0; k < 3; ++k)
      for (int j = 1; j < 3; ++j) {
        const int v = f[k];
        const Vector3 d = points[f[(k + j) % 3]] - points[v];
        sum[v] += d, length[v] += d.norm(), shortest[v] = std::min(shortest[v], d.norm());
        if (j == 1) normal[v] += d.cross(points[f[(k + 2) % 3]] - points[v]);
      }
  int copies = 0;  // of the same vertex before v; each moves a little farther, should all go the same way
  for (std::size_t v = 0; v < points.size(); ++v) {
    const bool copy = v > 0 && origin[v - 1] == origin[v],
               has_copy = v + 1 < points.size() && origin[v + 1] == origin[v];
    if (!copy && !has_copy) continue;
    copies = copy ? copies + 1 : 0;
    const bool level =
        sum[v].norm() < 0.05 * length[v];  // amid a flat fan: no way inside, but one copy may stay
    if (level && !copy) continue;
    const Vector3 way = level ? Vector3(-normal[v]) : sum[v];
    if (way.norm() > 0)
      points[v] += way.normalized() * std::min(step * (1 + 0.5 * copies), 0.2 * shortest[v]);
  }
}

// New points in the middle of sides: needed where two edges that are no longer one still join the same
// vertices.
struct Middles {
  std::vector<int> of_side;
  void add(const Gluing& g, int side, const Vector3& point, std::vector<Vector3>& points,
           std::vector<int>& origin) {
    of_side[side] = static_cast<int>(points.size());
    if (g.partner[side] >= 0) of_side[g.partner[side]] = of_side[side];
    points.push_back(point);
    origin.push_back(-1);
  }
};

Middles split_double_edges(const Gluing& g, const std::vector<int>& vertex, std::vector<Vector3>& points,
                           std::vector<int>& origin) {
  Middles middles{std::vector<int>(g.partner.size(), -1)};
  std::vector<std::tuple<int, int, int>> edges;  // once for each edge as glued
  for (int s = 0; s < static_cast<int>(g.partner.size()); ++s) {
    if (g.partner[s] >= 0 && g.partner[s] < s) continue;
    const auto [lo, hi] = std::minmax({vertex[s], vertex[s - s % 3 + (s % 3 + 1) % 3]});
    edges.emplace_back(lo, hi, s);
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 1; i < edges.size(); ++i) {
    const auto& [lo, hi, side] = edges[i];
    if (lo == std::get<0>(edges[i - 1]) && hi == std::get<1>(edges[i - 1]))
      middles.add(g, side, (points[lo] + points[hi]) / 2, points, origin);
  }
  return middles;
}

RepairResult assembled(Work& work, const Gluing& g, const RunContext& context) {
  RepairResult result;
  std::vector<int> origin;
  const std::vector<int> vertex = gluing::fan_vertices(work.soup, g, origin);
  note_bow_ties(work, g, origin);
  std::vector<Vector3> points;
  for (int v : origin) points.push_back(work.soup.points[v]);
  std::vector<std::array<int, 3>> fans(work.soup.faces.size());
  for (std::size_t s = 0; s < vertex.size(); ++s) fans[s / 3][s % 3] = vertex[s];
  pull_apart(fans, origin, points);
  context.checkpoint();
  const Middles middles = split_double_edges(g, vertex, points, origin);
  std::vector<std::array<int, 3>> faces;
  for (int f = 0; f < static_cast<int>(work.soup.faces.size()); ++f) {
    const int s = 3 * f;
    for (auto piece : face_pieces({vertex[s], vertex[s + 1], vertex[s + 2]},
                                  {middles.of_side[s], middles.of_side[s + 1], middles.of_side[s + 2]})) {
      if (g.turned[f]) std::swap(piece[1], piece[2]);
      faces.push_back(piece);
      result.face_origin.push_back(work.face_origin[f]);
    }
  }
  context.checkpoint();
  result.vertex_origin.reserve(origin.size());
  for (int v : origin) result.vertex_origin.push_back(v < 0 ? -1 : work.point_origin[v]);
  result.mesh = build_surface_mesh(std::move(points), std::move(faces));
  return result;
}

// Sum of the signed volumes of the tetrahedra from a point of the component; per component.
std::vector<double> component_volumes(const SurfaceMesh& mesh, const std::vector<int>& component, int count) {
  std::vector<double> volume(count, 0);
  std::vector<int> base(count, -1);
  for (int f = 0; f < mesh.face_count(); ++f) {
    int& b = base[component[f]];
    if (b < 0) b = mesh.faces[f][0];
    const Vector3& o = mesh.points[b];
    const auto& t = mesh.faces[f];
    volume[component[f]] +=
        (mesh.points[t[0]] - o).dot((mesh.points[t[1]] - o).cross(mesh.points[t[2]] - o)) / 6;
  }
  return volume;
}

void note_inside_out(Work& work, const SurfaceMesh& mesh, const std::vector<int>& component, int count) {
  std::vector<char> open(count, 0);
  for (const auto& e : mesh.edges)
    if (e.border()) open[component[e.f0]] = 1;
  const std::vector<double> volume = component_volumes(mesh, component, count);
  std::vector<char> seen(count, 0);
  std::size_t inward = 0;
  Places places;  // one a component
  for (int f = 0; f < mesh.face_count(); ++f) {
    const int c = component[f];
    if (open[c] || !(volume[c] < 0) || std::exchange(seen[c], 1)) continue;
    ++inward;
    places.add(mesh.points[mesh.faces[f][0]]);
  }
  work.note("inside-out", inward, "closed component points", "closed components point",
            "inward; that orientation was kept", std::move(places));
}

void note_flat(Work& work, const SurfaceMesh& mesh, double diagonal) {
  std::size_t flat = 0;
  Places places;
  for (int f = 0; f < mesh.face_count(); ++f)
    if (!(mesh.face_normal_raw(f).norm() > kNoArea * diagonal * diagonal)) {
      ++flat;
      places.add(mesh.points[mesh.faces[f][0]]);
    }
  work.note("zero-area-face", flat, "face has", "faces have", "no area; kept, as remeshing removes it",
            std::move(places));
}

void fill_audit(const TriangleSoup& soup, Work& work, RepairResult& result) {
  const SurfaceMesh& mesh = result.mesh;
  const auto [component, count] = face_components(mesh);
  note_inside_out(work, mesh, component, count);
  note_flat(work, mesh, bounding_box_diagonal(mesh.points));
  result.audit.vertices = static_cast<int>(soup.points.size());
  result.audit.faces = static_cast<int>(soup.faces.size());
  result.audit.components = count;
  result.audit.border_loops = count_border_loops(mesh);
  result.audit.euler = mesh.vertex_count() - mesh.edge_count() + mesh.face_count();
  result.audit.uniform = uniform_enough(mesh);
  result.audit.findings = std::move(work.findings);
}

[[noreturn]] void nothing_left(const std::string& what, const std::string& where = {}) {
  throw Error(ErrorCode::kUnsupportedMesh, what, where,
              "give a surface of triangles or polygons with an area");
}

// What a mesh without an area is: a line, and where it runs.
std::string line_of(const std::vector<Vector3>& points) {
  const auto [low, high] =
      std::minmax_element(points.begin(), points.end(), [](const Vector3& a, const Vector3& b) {
        return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
      });
  return "on a line from " + text_of(*low) + " to " + text_of(*high);
}

// Readers give sound soups; a caller's own may not be.
void check_sound(const TriangleSoup& soup) {
  const int points = static_cast<int>(soup.points.size());
  for (std::size_t f = 0; f < soup.faces.size(); ++f)
    for (int v : soup.faces[f]) {
      if (v < 0 || v >= points)
        throw Error(ErrorCode::kUnsupportedMesh,
                    "a face uses vertex " + std::to_string(v) + ", which does not exist",
                    "face " + std::to_string(f));
      if (!soup.points[v].allFinite())
        throw Error(ErrorCode::kUnsupportedMesh, "a vertex has no finite position",
                    "vertex " + std::to_string(v));
    }
}

}  // namespace

RepairResult repair(const TriangleSoup& soup, const RunContext& context) {
  if (soup.faces.empty()) nothing_left("the mesh has no faces");
  check_sound(soup);
  Work work = start(soup);
  drop_unused(work);
  context.checkpoint();
  const std::vector<int> classes = exact_classes(work.soup.points);
  context.checkpoint();
  merge(work, classes, "at the place of another one");
  drop_collapsed(work);
  context.checkpoint();
  Gluing g = gluing::glue(work.soup);
  context.checkpoint();
  drop_unused(work);
  const bool clean = is_clean(work.soup, g);
  context.checkpoint();
  if (!clean) {
    const double near = kNear * bounding_box_diagonal(work.soup.points);
    merge(work, near_classes(work.soup.points, near), "nearer than 1e-9 of the diagonal to another one");
    drop_collapsed(work);
    drop_duplicates(work);
    drop_unused(work);
    context.checkpoint();
    g = gluing::glue(work.soup);
    context.checkpoint();
    gluing::orient(work.soup, g);
  }
  if (drop_without_area(work, g)) {
    g = gluing::glue(work.soup);
    gluing::orient(work.soup, g);
  }
  if (!clean) note_topology(work, g);
  if (work.soup.faces.empty()) nothing_left("no face of the mesh has three different corners");
  context.checkpoint();
  RepairResult result = assembled(work, g, context);
  context.checkpoint();
  const double diagonal = bounding_box_diagonal(result.mesh.points);
  if (!(surface_area(result.mesh) > kLeastArea * diagonal * diagonal))
    nothing_left("all faces of the mesh together have no area", line_of(result.mesh.points));
  fill_audit(soup, work, result);
  context.checkpoint();
  return result;
}

std::vector<std::vector<int>> border_loops(const SurfaceMesh& mesh) {
  std::vector<std::vector<int>> loops;
  std::vector<char> seen(mesh.points.size(), 0);
  for (int start_at = 0; start_at < mesh.vertex_count(); ++start_at) {
    if (!mesh.border_vertex[start_at] || seen[start_at]) continue;
    std::vector<int>& loop = loops.emplace_back();
    for (int v = start_at; !seen[v];) {
      seen[v] = 1;
      loop.push_back(v);
      v = mesh.edges[*mesh.ring_begin_of(v)].other(v);  // the first edge of the ring leads along the border
    }
  }
  return loops;
}

int count_border_loops(const SurfaceMesh& mesh) { return static_cast<int>(border_loops(mesh).size()); }

}  // namespace sheetform
