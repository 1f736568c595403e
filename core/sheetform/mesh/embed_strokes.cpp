#include "sheetform/mesh/embed_strokes.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <unordered_map>
#include <unordered_set>

#include "sheetform/mesh/subdivide.h"
#include "sheetform/mesh/surface_curve.h"

namespace sheetform {
namespace {

// Lengths in edges of the mesh.
constexpr double kSample = 0.25;        // between points of a stroke
constexpr double kSmallOpen = 2;        // shorter strokes are left out
constexpr double kSmallClosed = 8;      // so are shorter loops
constexpr double kShortLoop = 4;        // a stroke that comes back so soon only trembles
constexpr double kSnap = 1.5;           // an end so near to a line is to end there
constexpr double kSnapToEnd = 1;        // the same where the line itself ends or meets another
constexpr double kOvershoot = 2;        // an end that has just crossed a line is to end on it
constexpr double kAlong = 0.75;         // as near as this it runs along a line ...
constexpr double kAlongLength = 3;      // ... when it does so for this long
constexpr double kShortPart = 1;        // what is left of a stroke between two such stretches is no seam
constexpr double kOffVertex = 0.04;     // of the edge: crossings keep so far from its ends
constexpr int kMostFaces = 2000;        // that are looked at for the way between two points
constexpr std::size_t kMostSteps = 12;  // from face to face to what an end is to meet

// Where on the edge a-b (0..1) the segment p-q comes nearest.
double nearest_on_edge(const Vector3& a, const Vector3& b, const Vector3& p, const Vector3& q) {
  const Vector3 u = b - a, v = q - p, w = a - p;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), uw = u.dot(w), vw = v.dot(w);
  const double det = uu * vv - uv * uv;
  double s = det > 1e-12 * uu * vv ? std::clamp((uu * vw - uv * uw) / det, 0.0, 1.0) : 0.5;
  return uu > 0 ? std::clamp((s * uv - uw) / uu, kOffVertex, 1 - kOffVertex) : 0.5;
}

struct Gate {
  int edge;
  Vector3 point;
  int sample;  // at which the curve goes through
};

// A curve from face to face; gates[i] lies between faces[i] and faces[i + 1], of a closed one the last gate
// between the last and the first face. `end`: the vertex at which an open one ends, -1: at its last gate.
struct Chain {
  std::vector<int> faces;
  std::vector<Gate> gates;
  bool closed = false;
  int start = -1, end = -1;
  int cut = -1;  // the curve crosses itself: to be cut at this sample first
};

void reverse(Chain& chain) {
  std::reverse(chain.faces.begin(), chain.faces.end());
  std::reverse(chain.gates.begin(), chain.gates.end());
  std::swap(chain.start, chain.end);
}

using Curve = std::vector<CurvePoint>;

std::vector<double> lengths_along(const Curve& curve) {
  std::vector<double> at(curve.size(), 0);
  for (std::size_t i = 1; i < curve.size(); ++i)
    at[i] = at[i - 1] + (curve[i].point - curve[i - 1].point).norm();
  return at;
}

class Embedder {
 public:
  Embedder(const PreparedMesh& prepared, double edge, const RunContext& context)
      : mesh_(prepared.mesh), crease_(prepared.crease_edge), edge_(edge), context_(context) {
    crease_.resize(mesh_.edges.size(), 0);
    drawn_.assign(mesh_.edges.size(), 0);
    refresh();
  }

  // False when the stroke is too small to be drawn in this mesh.
  bool add(const SeamStroke& stroke) {
    context_.checkpoint();
    Curve curve = curve_on_surface(tree_, stroke.points, stroke.closed, kSample * edge_);
    const double length = lengths_along(curve).back();
    const double gap = (curve.back().point - curve.front().point).norm();
    const bool closed = stroke.closed || (gap < kSnap * edge_ && length > kSmallClosed * edge_);
    if (closed && !stroke.closed) curve = curve_on_surface(tree_, stroke.points, true, kSample * edge_);
    if (length < (closed ? kSmallClosed : kSmallOpen) * edge_) return false;
    const std::vector<Curve> parts = beside_lines(curve, closed);
    if (parts.size() == 1 && parts[0].size() == curve.size()) return insert(curve, closed);
    bool any = parts.empty();  // all of it is there already
    for (const Curve& part : parts) any |= insert(part, false);
    return any;
  }

  const SurfaceMesh& mesh() const { return mesh_; }
  const std::vector<char>& crease() const { return crease_; }
  const std::vector<char>& drawn() const { return drawn_; }

 private:
  bool is_line(int e) const { return mesh_.edges[e].border() || crease_[e] || drawn_[e]; }
  bool has_corner(int f, int v) const {
    const auto& t = mesh_.faces[f];
    return t[0] == v || t[1] == v || t[2] == v;
  }

  void refresh() {
    tree_ = ClosestPointTree(mesh_.points, mesh_.faces, context_);
    line_degree_.assign(mesh_.points.size(), 0);
    std::vector<std::array<int, 3>> segments;
    for (int e = 0; e < mesh_.edge_count(); ++e) {
      if (!is_line(e)) continue;
      const auto& edge = mesh_.edges[e];
      ++line_degree_[edge.v0], ++line_degree_[edge.v1];
      segments.push_back({edge.v0, edge.v1, edge.v1});
    }
    lines_ = ClosestPointTree(mesh_.points, segments);
  }

  // Per point: the curve runs along a line there, for a while.
  std::vector<char> along_lines(const Curve& curve) const {
    const double near = kAlong * edge_;
    std::vector<char> along(curve.size(), 0);
    for (std::size_t i = 0; i < curve.size() && !lines_.empty(); ++i)
      along[i] = lines_.closest(curve[i].point, near * near).face >= 0;
    const std::vector<double> at = lengths_along(curve);
    for (std::size_t i = 0, j = 0; i < curve.size(); i = j) {
      while (j < curve.size() && along[j] == along[i]) ++j;
      if (along[i] && at[j - 1] - at[i] < kAlongLength * edge_)
        std::fill(along.begin() + static_cast<std::ptrdiff_t>(i),
                  along.begin() + static_cast<std::ptrdiff_t>(j), static_cast<char>(0));
    }
    return along;
  }

  // The parts of a curve that do not run along a line.
  std::vector<Curve> beside_lines(Curve curve, bool closed) const {
    std::vector<char> along = along_lines(curve);
    const auto first = std::find(along.begin(), along.end(), 1);
    if (closed && first != along.end()) {  // no part goes over the start
      std::rotate(curve.begin(), curve.begin() + (first - along.begin()), curve.end() - 1);
      curve.back() = curve.front();
      along = along_lines(curve);
    }
    std::vector<Curve> parts;
    for (std::size_t i = 0; i < curve.size(); ++i) {
      if (along[i]) continue;
      if (i == 0 || along[i - 1]) parts.emplace_back();
      parts.back().push_back(curve[i]);
    }
    std::erase_if(parts, [&](const Curve& part) { return lengths_along(part).back() < kShortPart * edge_; });
    return parts;
  }

  // A curve that crosses itself is inserted piece by piece, each beginning where the one before ended.
  bool insert(Curve curve, bool closed) {
    int from = -1;
    bool any = false;
    for (int piece = 0; piece < static_cast<int>(4 + curve.size()); ++piece) {
      for (CurvePoint& p : curve) p.face = tree_.closest(p.point).face;  // the mesh has changed
      Chain chain = follow(curve, closed);
      Curve rest;
      if (chain.cut > 0) {
        rest.assign(curve.begin() + chain.cut, curve.end());
        curve.resize(static_cast<std::size_t>(chain.cut) + 1);
        chain = follow(curve, false);
        closed = false;
      }
      attach(chain, curve, from, !rest.empty());
      from = cut_in(chain, any);
      if (rest.size() < 2) break;
      curve = std::move(rest);
    }
    return any;
  }

  // From face to face along the curve.
  Chain follow(const Curve& curve, bool closed) const {
    const std::vector<double> at = lengths_along(curve);
    const double ends = kShortLoop * edge_;
    Chain chain;
    std::vector<int> entered{0};
    std::unordered_map<int, int> place{{curve[0].face, 0}};
    chain.faces = {curve[0].face};
    for (int i = 1; i < static_cast<int>(curve.size()); ++i) {
      const auto way = way_between(chain.faces.back(), curve[i].face, curve[i - 1].point, curve[i].point);
      if (way.empty() && chain.faces.back() != curve[i].face) break;  // the surface jumps
      for (const auto& [face, gate_edge] : way) {
        const Gate gate{gate_edge, gate_point(gate_edge, curve[i - 1].point, curve[i].point), i};
        const auto seen = place.find(face);
        if (seen == place.end()) {
          place[face] = static_cast<int>(chain.faces.size());
          chain.faces.push_back(face), chain.gates.push_back(gate), entered.push_back(i);
          continue;
        }
        const int k = seen->second;
        if (closed && at[entered[k]] < ends && at[i] > at.back() - ends && at.back() > 2 * ends) {
          chain.faces.erase(chain.faces.begin(), chain.faces.begin() + k);
          chain.gates.erase(chain.gates.begin(), chain.gates.begin() + k);
          chain.gates.push_back(gate);
          chain.closed = true;
          return chain;
        }
        if (at[i] - at[entered[k]] > ends) {
          chain.cut = static_cast<int>(std::lower_bound(at.begin(), at.end(), (at[i] + at[entered[k]]) / 2) -
                                       at.begin());
          return chain;
        }
        for (int f = k + 1; f < static_cast<int>(chain.faces.size()); ++f) place.erase(chain.faces[f]);
        chain.faces.resize(k + 1), entered.resize(k + 1), chain.gates.resize(k);
      }
    }
    return chain;
  }

  Vector3 gate_point(int e, const Vector3& p, const Vector3& q) const {
    const Vector3 &a = mesh_.points[mesh_.edges[e].v0], &b = mesh_.points[mesh_.edges[e].v1];
    return a + nearest_on_edge(a, b, p, q) * (b - a);
  }

  struct Step {
    int face, edge;
  };
  // The faces after `from` up to one that `arrived` accepts, hugging the segment p-q; empty when there is no
  // way (or none is needed). blocked: faces that are not entered; lines: whether lines may be crossed.
  template <class Arrived>
  std::vector<Step> way(int from, const Vector3& p, const Vector3& q, const Arrived& arrived,
                        const std::unordered_set<int>& blocked, bool lines) const {
    struct Label {
      double cost;
      int father, edge;
    };
    std::unordered_map<int, Label> known{{from, {0, -1, -1}}};
    std::priority_queue<std::pair<double, int>, std::vector<std::pair<double, int>>, std::greater<>> queue;
    queue.emplace(0, from);
    for (int looked = 0; !queue.empty() && looked < kMostFaces; ++looked) {
      const auto [cost, f] = queue.top();
      queue.pop();
      if (cost > known.at(f).cost) continue;
      if (arrived(f)) {
        std::vector<Step> steps;
        for (int g = f; known.at(g).father >= 0; g = known.at(g).father)
          steps.push_back({g, known.at(g).edge});
        std::reverse(steps.begin(), steps.end());
        return steps;
      }
      for (int e : mesh_.face_edges[f]) {
        const int g = mesh_.edges[e].other_face(f);
        if (g < 0 || blocked.count(g) || (!lines && is_line(e))) continue;
        const double next = cost + distance_to_triangle(gate_point(e, p, q), p, q, q) + 0.05 * edge_;
        const auto it = known.find(g);
        if (it != known.end() && it->second.cost <= next) continue;
        known[g] = {next, f, e};
        queue.emplace(next, g);
      }
    }
    return {};
  }
  std::vector<Step> way_between(int from, int to, const Vector3& p, const Vector3& q) const {
    return way(
        from, p, q, [&](int f) { return f == to; }, {}, true);
  }

  // Both ends of an open chain: at `from` (a vertex, -1: free) and, unless the curve goes on, at what lies
  // near.
  void attach(Chain& chain, const Curve& curve, int from, bool goes_on) const {
    if (chain.closed) return;
    reverse(chain);
    if (from >= 0) {
      end_at(chain, from, mesh_.points[from]);
    } else {
      end_nearby(chain, curve, curve.front().point, true);
    }
    reverse(chain);
    if (!goes_on) end_nearby(chain, curve, curve.back().point, false);
  }

  void end_nearby(Chain& chain, const Curve& curve, const Vector3& tip, bool at_front) const {
    const std::vector<double> at = lengths_along(curve);
    const int v = nearest_line_vertex(tip);
    for (std::size_t k = chain.gates.size() / 2; k < chain.gates.size(); ++k) {
      const double left = at_front ? at[chain.gates[k].sample] : at.back() - at[chain.gates[k].sample];
      if (left > kOvershoot * edge_ || !is_line(chain.gates[k].edge)) continue;
      // What overshoots a line a little ends on it, or at its end when that is what it meets.
      const bool meets_end = v >= 0 && line_degree_[v] == 1;
      chain.gates.resize(meets_end ? k : k + 1), chain.faces.resize(k + 1);
      if (!meets_end) return;
    }
    if (v >= 0) end_at(chain, v, tip);
  }

  int nearest_line_vertex(const Vector3& p) const {
    int best = -1;
    double least = 1;
    for (int v = 0; v < mesh_.vertex_count(); ++v) {
      if (line_degree_[v] == 0) continue;
      const double d = (mesh_.points[v] - p).norm() / edge_;
      const double value = d < kSnapToEnd && line_degree_[v] != 2 ? 0.1 * d / kSnapToEnd : d / kSnap;
      if (value < least) least = value, best = v;
    }
    return best;
  }

  // The last gate is to be opposite to v in a face at v.
  void end_at(Chain& chain, int v, const Vector3& tip) const {
    if (!has_corner(chain.faces.back(), v)) {
      const std::unordered_set<int> used(chain.faces.begin(), chain.faces.end());
      const auto steps = way(
          chain.faces.back(), tip, mesh_.points[v], [&](int f) { return has_corner(f, v); }, used, false);
      if (steps.empty() || steps.size() > kMostSteps) return;
      const int sample = chain.gates.empty() ? 0 : chain.gates.back().sample;
      for (const Step& s : steps) {
        chain.faces.push_back(s.face);
        chain.gates.push_back({s.edge, gate_point(s.edge, tip, mesh_.points[v]), sample});
      }
    }
    while (chain.faces.size() > 1 && has_corner(chain.faces[chain.faces.size() - 2], v))
      chain.faces.pop_back(), chain.gates.pop_back();
    if (chain.start == v && chain.gates.empty()) return;
    chain.end = v;
  }

  // Puts vertices on the gates and marks the edges between them; returns the last vertex, -1 for none.
  int cut_in(const Chain& chain, bool& any) {
    std::vector<EdgePoint> points;
    for (const Gate& gate : chain.gates) points.push_back({gate.edge, gate.point});
    const int old = mesh_.vertex_count();
    std::vector<int> stops;
    if (chain.start >= 0) stops.push_back(chain.start);
    for (std::size_t i = 0; i < points.size(); ++i) stops.push_back(old + static_cast<int>(i));
    if (chain.end >= 0) stops.push_back(chain.end);
    if (stops.size() < 2) return chain.end >= 0 ? chain.end : -1;
    if (chain.closed) stops.push_back(stops.front());
    const SurfaceMesh before = mesh_;
    Subdivision finer = insert_vertices(mesh_, crease_, points);
    mesh_ = std::move(finer.mesh), crease_ = std::move(finer.crease_edge);
    carry_drawn(before, points);
    for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
      const int e = mesh_.find_edge(stops[i], stops[i + 1]);
      if (e >= 0 && !mesh_.edges[e].border()) drawn_[e] = 1, any = true;
    }
    refresh();
    return stops.back();
  }

  void carry_drawn(const SurfaceMesh& before, const std::vector<EdgePoint>& points) {
    std::unordered_map<int, int> middle;
    for (std::size_t i = 0; i < points.size(); ++i)
      middle[points[i].edge] = before.vertex_count() + static_cast<int>(i);
    std::vector<char> drawn(mesh_.edges.size(), 0);
    for (int e = 0; e < before.edge_count(); ++e) {
      if (!drawn_[e]) continue;
      const auto& edge = before.edges[e];
      const auto it = middle.find(e);
      if (it == middle.end())
        drawn[mesh_.find_edge(edge.v0, edge.v1)] = 1;
      else
        drawn[mesh_.find_edge(edge.v0, it->second)] = drawn[mesh_.find_edge(edge.v1, it->second)] = 1;
    }
    drawn_ = std::move(drawn);
  }

  SurfaceMesh mesh_;
  std::vector<char> crease_, drawn_;
  const double edge_;
  const RunContext& context_;
  ClosestPointTree tree_, lines_;
  std::vector<int> line_degree_;
};

ClosestPointTree tree_of(const SurfaceMesh& mesh, const std::vector<char>& edges) {
  std::vector<std::array<int, 3>> segments;
  for (int e = 0; e < mesh.edge_count(); ++e)
    if (edges[e]) segments.push_back({mesh.edges[e].v0, mesh.edges[e].v1, mesh.edges[e].v1});
  return {mesh.points, segments};
}

}  // namespace

EmbeddedStrokes embed_strokes(const PreparedMesh& prepared, const std::vector<SeamStroke>& strokes,
                              const RunContext& context) {
  EmbeddedStrokes result;
  const double length = mean_edge_length(prepared.mesh);
  Embedder embedder(prepared, length, context);
  for (std::size_t i = 0; i < strokes.size(); ++i)
    if (!embedder.add(strokes[i])) result.left_out.push_back(static_cast<int>(i));
  const SurfaceMesh& cut = embedder.mesh();
  std::vector<char> lines = embedder.crease();
  for (std::size_t e = 0; e < lines.size(); ++e) lines[e] |= embedder.drawn()[e];
  result.prepared = prepare(cut, lines, length, context);
  // Which of the kept lines are the strokes: those on their edges. Creases stay creases.
  const ClosestPointTree drawn = tree_of(cut, embedder.drawn()), creases = tree_of(cut, embedder.crease());
  const SurfaceMesh& mesh = result.prepared.mesh;
  result.drawn_edge.assign(mesh.edges.size(), 0);
  for (int e = 0; e < mesh.edge_count() && !drawn.empty(); ++e) {
    if (!result.prepared.crease_edge[e]) continue;
    const Vector3 middle = (mesh.points[mesh.edges[e].v0] + mesh.points[mesh.edges[e].v1]) / 2;
    const double to_stroke = drawn.closest(middle).squared_distance,
                 to_crease = creases.empty() ? 1e300 : creases.closest(middle).squared_distance;
    result.drawn_edge[e] = to_stroke < to_crease;
    result.prepared.crease_edge[e] = !result.drawn_edge[e];
  }
  return result;
}

}  // namespace sheetform
