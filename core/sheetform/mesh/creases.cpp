#include "sheetform/mesh/creases.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "sheetform/mesh/sharpness.h"

namespace sheetform {
namespace {

// Angles in degrees, lengths as fractions of the diagonal. Chosen on some 45 meshes, half of them organic.
constexpr double kWeakShare = 2.0 / 3;  // of the asked angle: enough to bridge a gap
constexpr double kBarrierShare = 0.75;  // of the asked angle: the surroundings of an edge end there
constexpr double kSharpMore = 25;       // over the asked angle: then a less clear turning is forgiven
constexpr double kMostWeak = 0.6;       // of the length of a chain
constexpr double kLeastLoop = 0.04, kLeastNetwork = 0.06;
constexpr double kLeastRestless = 0.35;  // of a network whose sides turn too, ...
constexpr double kCoarse = 0.03;         // ... unless its edges are that long: few edges are no tangle
constexpr double kCalm = 0.15;           // unrest beside a chain; that of chains that turn a lot: ...
constexpr double kCalmTurning = 0.06;
constexpr double kTangle = 0.3;  // of the edges beside a chain: where fewer are unmarked it is not calm
constexpr double kLooseAtBorder = 0.15, kLooseAtCrease = 0.35, kLooseBoth = 0.5;
constexpr double kMostZigzag = 8, kMostZigzagLoose = 6, kMostTurn = 30,
                 kMostTurnOfLoop = 46;  // per vertex of a chain
constexpr double kLeastAnchor = 0.1;  // of the creases that a smooth chain hangs on with its one held end ...
constexpr double kAnchored = 0.2;     // ... of the length that it needs otherwise
constexpr double kJag = 0.25;         // of the middle edge of a chain: shorter steps are no turns of it
constexpr int kMostPasses = 100;
constexpr int kOftenEnough = 4096;  // edges between two looks at whether to stop

enum Mark : char { kNone = 0, kWeak = 1, kStrong = 2 };

double degrees_between(const Vector3& a, const Vector3& b) { return angle_between(a, b) * 180 / M_PI; }

struct Chain {
  std::vector<int> edges, vertices;  // vertices: one more than edges; first = last when closed
  bool closed = false;
};

struct ChainShape {
  double length = 0, weak = 0, dihedral = 0, turn = 0, zigzag = 0;  // angles: means
  double unrest =
      0;  // mean dihedral angle of the unmarked edges beside it, over its own (90 degrees at most)
  int loose_ends = 0;
  bool closed = false;
  bool at_border = false;  // one end at least
  // Between sides that turn much less than it does itself.
  bool calm() const {
    return unrest < (turn < (closed ? kMostTurnOfLoop : kMostTurn) ? kCalm : kCalmTurning);
  }
};

class CreaseNetwork {
 public:
  CreaseNetwork(const SurfaceMesh& mesh, double angle, const RunContext& context);
  // Removes chains and networks that are no creases until nothing changes. What goes joins the chains that it
  // parted: each test sees whole ones only.
  void clean() {
    bool changed = true;
    for (int pass = 0; changed && pass < kMostPasses; ++pass) {
      context_.checkpoint();
      changed = drop_weak() || drop_chains() || drop_networks();
    }
  }
  std::vector<char> result() const {
    std::vector<char> crease(marks_.size());
    std::transform(marks_.begin(), marks_.end(), crease.begin(),
                   [](Mark m) { return static_cast<char>(m != kNone); });
    return crease;
  }

 private:
  int degree(int v) const {
    return static_cast<int>(std::count_if(mesh_.ring_begin_of(v), mesh_.ring_end_of(v),
                                          [&](int e) { return marks_[e] != kNone; }));
  }
  bool is_node(int v) const { return mesh_.border_vertex[v] || degree(v) != 2; }
  bool is_loose(int v) const { return !mesh_.border_vertex[v] && degree(v) == 1; }
  Chain walk(int v, int e, std::vector<char>& seen) const;
  std::vector<Chain> chains() const;
  ChainShape shape(const Chain& chain) const;
  // Straight from crease to crease: its sides may curve back.
  bool is_bridge(const Chain& chain, const ChainShape& s) const {
    return s.loose_ends == 0 && !chain.closed && chain.edges.size() <= 2 && s.dihedral >= angle_ &&
           s.turn < kMostTurn;
  }
  bool too_weak(const Chain& chain, const ChainShape& s) const {
    return s.weak > kMostWeak * s.length && !is_bridge(chain, s);
  }
  // Looks like a crease by itself.
  bool is_good(const Chain& chain, const ChainShape& s) const {
    const bool smooth = s.turn < kMostTurn || (chain.closed && s.calm()) || chain.edges.size() <= 2;
    return s.length >= kLeastLoop * diagonal_ && s.zigzag < kMostZigzag && smooth;
  }
  bool keep(const Chain& chain, const ChainShape& s, double anchor) const;
  void measure_unrest();
  bool drop_weak();
  bool drop_chains();
  std::vector<double> anchor_lengths(const std::vector<Chain>& chains,
                                     const std::vector<ChainShape>& shapes) const;
  bool drop_networks();
  bool drop_network(const std::vector<int>& edges);
  void erase(const std::vector<int>& edges) {
    for (int e : edges) marks_[e] = kNone;
  }

  const SurfaceMesh& mesh_;
  const RunContext& context_;
  double diagonal_, angle_;
  std::vector<Mark> marks_;
  std::vector<double> dihedral_;
  std::vector<double> unrest_;     // of each marked edge: mean dihedral angle of the unmarked ones beside it
  std::vector<char> good_, calm_;  // of each marked edge: whether its chain is
};

CreaseNetwork::CreaseNetwork(const SurfaceMesh& mesh, double angle, const RunContext& context)
    : mesh_(mesh),
      context_(context),
      diagonal_(bounding_box_diagonal(mesh.points)),
      angle_(angle),
      marks_(mesh.edges.size(), kNone),
      dihedral_(mesh.edges.size(), 0),
      unrest_(mesh.edges.size(), 0),
      good_(mesh.edges.size(), 0),
      calm_(mesh.edges.size(), 0) {
  const Sharpness sharpness(mesh);
  for (int e = 0; e < mesh.edge_count(); ++e) {
    if (e % kOftenEnough == 0) context.checkpoint();
    const double a = dihedral_[e] = sharpness.dihedral(e);
    if (a < kWeakShare * angle) continue;
    const double share = sharpness.share(e, kBarrierShare * angle);
    const bool clear = a >= angle && share > 0.85 && share < 1.25;
    const bool sharp = a >= angle + kSharpMore && share > 0.6 && share < 1.3;
    if (clear || sharp)
      marks_[e] = kStrong;
    else if (share > 0.7 && share < 1.6)
      marks_[e] = kWeak;
  }
  measure_unrest();
}

// From the faces at the edge and their neighbours.
void CreaseNetwork::measure_unrest() {
  struct Sum {
    double turning = 0, unmarked = 0, all = 0;
  };
  std::vector<Sum> of_face(mesh_.faces.size());
  for (int e = 0; e < mesh_.edge_count(); ++e) {
    const auto& edge = mesh_.edges[e];
    if (edge.border()) continue;
    const double length = mesh_.edge_length(e), unmarked = marks_[e] == kNone ? length : 0;
    for (int f : {edge.f0, edge.f1})
      of_face[f].turning += unmarked * dihedral_[e], of_face[f].unmarked += unmarked,
          of_face[f].all += length;
  }
  for (int e = 0; e < mesh_.edge_count(); ++e) {
    if (marks_[e] == kNone) continue;
    const auto& edge = mesh_.edges[e];
    Sum sum;
    const auto add = [&](int f) {
      sum.turning += of_face[f].turning, sum.unmarked += of_face[f].unmarked, sum.all += of_face[f].all;
    };
    for (int f : {edge.f0, edge.f1}) {
      add(f);
      for (int g : mesh_.face_neighbours[f])
        if (g >= 0 && g != edge.other_face(f)) add(g);
    }
    unrest_[e] = sum.unmarked > kTangle * sum.all ? sum.turning / sum.unmarked : 180;
  }
}

Chain CreaseNetwork::walk(int v, int e, std::vector<char>& seen) const {
  Chain chain;
  chain.vertices.push_back(v);
  while (e >= 0) {
    seen[e] = 1;
    chain.edges.push_back(e);
    const int x = mesh_.edges[e].other(chain.vertices.back());
    chain.vertices.push_back(x);
    e = -1;
    if (x == v || is_node(x)) break;
    for (const int* q = mesh_.ring_begin_of(x); q != mesh_.ring_end_of(x); ++q)
      if (marks_[*q] != kNone && !seen[*q]) e = *q;
  }
  return chain;
}

std::vector<Chain> CreaseNetwork::chains() const {
  std::vector<Chain> found;
  std::vector<char> seen(marks_.size(), 0);
  for (int v = 0; v < mesh_.vertex_count(); ++v) {
    if (!is_node(v)) continue;
    for (const int* q = mesh_.ring_begin_of(v); q != mesh_.ring_end_of(v); ++q)
      if (marks_[*q] != kNone && !seen[*q]) found.push_back(walk(v, *q, seen));
  }
  for (int e = 0; e < mesh_.edge_count(); ++e)
    if (marks_[e] != kNone && !seen[e]) {
      found.push_back(walk(mesh_.edges[e].v0, e, seen));
      found.back().closed = true;
    }
  return found;
}

// The vertices of a chain but for those much nearer to the one before than is usual in it: what turns there
// is finer than the chain. Keeps both ends.
std::vector<int> without_jags(const SurfaceMesh& mesh, const Chain& chain) {
  std::vector<double> lengths;
  for (int e : chain.edges) lengths.push_back(mesh.edge_length(e));
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  const double least = kJag * *middle;
  std::vector<int> kept{chain.vertices.front()};
  for (std::size_t i = 1; i + 1 < chain.vertices.size(); ++i)
    if ((mesh.points[chain.vertices[i]] - mesh.points[kept.back()]).norm() >= least)
      kept.push_back(chain.vertices[i]);
  if (kept.size() > 1 && (mesh.points[chain.vertices.back()] - mesh.points[kept.back()]).norm() < least)
    kept.pop_back();
  kept.push_back(chain.vertices.back());
  return kept;
}

// Mean turning per vertex, and what of it is not there at twice the spacing: zigzag, not bend. A corner turns
// as much at twice the spacing, but at its neighbours too: only the sums can be compared.
void measure_turning(const SurfaceMesh& mesh, const Chain& chain, ChainShape& s) {
  const std::vector<int> vertices = without_jags(mesh, chain);
  const int n = static_cast<int>(vertices.size()) - 1;
  auto point = [&](int i) { return mesh.points[vertices[chain.closed ? (i + n) % n : i]]; };
  const int margin = chain.closed ? 0 : 2;
  int turns = 0, wiggles = 0;
  for (int i = chain.closed ? 0 : 1; i < n; ++i) {
    const double turn = degrees_between(point(i) - point(i - 1), point(i + 1) - point(i));
    s.turn += turn, ++turns;
    if (i < margin || i > n - margin) continue;
    s.zigzag += turn - degrees_between(point(i) - point(i - 2), point(i + 2) - point(i)) / 2, ++wiggles;
  }
  s.turn /= std::max(1, turns);
  s.zigzag = std::max(0.0, s.zigzag / std::max(1, wiggles));
}

ChainShape CreaseNetwork::shape(const Chain& chain) const {
  ChainShape s;
  for (int e : chain.edges) {
    const double length = mesh_.edge_length(e);
    s.length += length;
    s.dihedral += length * dihedral_[e];
    s.unrest += length * unrest_[e];
    if (marks_[e] == kWeak) s.weak += length;
  }
  s.unrest /= std::max(std::min(s.dihedral, 90 * s.length), std::numeric_limits<double>::min());
  s.closed = chain.closed;
  s.dihedral /= std::max(s.length, std::numeric_limits<double>::min());
  measure_turning(mesh_, chain, s);
  if (!chain.closed)
    for (int v : {chain.vertices.front(), chain.vertices.back()}) {
      s.loose_ends += is_loose(v);
      s.at_border = s.at_border || mesh_.border_vertex[v];
    }
  return s;
}

bool CreaseNetwork::keep(const Chain& chain, const ChainShape& s, double anchor) const {
  if (too_weak(chain, s)) return false;
  if (s.zigzag > kMostZigzag && chain.edges.size() > 4) return false;
  if (chain.closed)
    return s.length >= kLeastLoop * diagonal_ && (s.turn < kMostTurn || s.calm()) &&
           (chain.edges.size() >= 8 || s.dihedral >= angle_ + kSharpMore);
  if (s.loose_ends == 0) return true;
  const double least = s.loose_ends == 2 ? kLooseBoth : s.at_border ? kLooseAtBorder : kLooseAtCrease;
  const bool smooth = s.zigzag < 1.5 && s.turn < 15 && s.weak < 0.3 * s.length;
  if (smooth && anchor >= kLeastAnchor * diagonal_ && s.length >= kAnchored * least * diagonal_) return true;
  return s.length >= least * diagonal_ && s.weak < 0.4 * s.length && s.zigzag < kMostZigzagLoose;
}

// For each chain with one loose end: how long the creases without loose ends are that its other end hangs on;
// what looks like roughness does not count.
std::vector<double> CreaseNetwork::anchor_lengths(const std::vector<Chain>& chains,
                                                  const std::vector<ChainShape>& shapes) const {
  std::vector<int> parent(mesh_.points.size());
  std::iota(parent.begin(), parent.end(), 0);
  auto root = [&](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (std::size_t k = 0; k < chains.size(); ++k)
    if (shapes[k].loose_ends == 0)
      for (int v : chains[k].vertices) parent[root(v)] = root(chains[k].vertices.front());
  std::vector<double> length(parent.size(), 0), anchor(chains.size(), 0);
  for (std::size_t k = 0; k < chains.size(); ++k)
    if (shapes[k].loose_ends == 0 && (is_good(chains[k], shapes[k]) || shapes[k].unrest < kCalm))
      length[root(chains[k].vertices.front())] += shapes[k].length;
  for (std::size_t k = 0; k < chains.size(); ++k)
    if (shapes[k].loose_ends == 1) {
      const Chain& c = chains[k];
      anchor[k] = length[root(is_loose(c.vertices.front()) ? c.vertices.back() : c.vertices.front())];
    }
  return anchor;
}

bool CreaseNetwork::drop_weak() {
  bool any = false;
  for (const Chain& chain : chains()) {
    if (!too_weak(chain, shape(chain))) continue;
    erase(chain.edges);
    any = true;
  }
  return any;
}

bool CreaseNetwork::drop_chains() {
  bool any = false;
  const std::vector<Chain> all = chains();
  std::vector<ChainShape> shapes;
  for (const Chain& chain : all) shapes.push_back(shape(chain));
  const std::vector<double> anchors = anchor_lengths(all, shapes);
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Chain& chain = all[k];
    const ChainShape& s = shapes[k];
    const bool good = is_good(chain, s), calm = s.calm();
    for (int e : chain.edges) good_[e] = good, calm_[e] = calm;
    if (keep(chain, s, anchors[k])) continue;
    erase(chain.edges);
    any = true;
  }
  return any;
}

// Connected creases support each other.
bool CreaseNetwork::drop_networks() {
  bool any = false;
  std::vector<char> seen(mesh_.points.size(), 0);
  for (int seed = 0; seed < mesh_.vertex_count(); ++seed) {
    if (seen[seed] || degree(seed) == 0) continue;
    seen[seed] = 1;
    std::vector<int> stack{seed}, edges;
    while (!stack.empty()) {
      const int v = stack.back();
      stack.pop_back();
      for (const int* q = mesh_.ring_begin_of(v); q != mesh_.ring_end_of(v); ++q) {
        if (marks_[*q] == kNone) continue;
        const int x = mesh_.edges[*q].other(v);
        if (v < x) edges.push_back(*q);
        if (!seen[x]) seen[x] = 1, stack.push_back(x);
      }
    }
    any = drop_network(edges) || any;
  }
  return any;
}

// A tangle of short pieces is roughness, but for those that are calm.
bool CreaseNetwork::drop_network(const std::vector<int>& edges) {
  double length = 0, good = 0, calm = 0;
  std::vector<int> restless;
  for (int e : edges) {
    const double l = mesh_.edge_length(e);
    length += l, good += good_[e] ? l : 0, calm += calm_[e] ? l : 0;
    if (!calm_[e]) restless.push_back(e);
  }
  const bool coarse = length >= kCoarse * diagonal_ * static_cast<double>(edges.size());
  const bool large = length >= (coarse || calm >= length / 2 ? kLeastNetwork : kLeastRestless) * diagonal_;
  if (large && (good >= length / 2 || restless.empty())) return false;
  erase(large ? restless : edges);
  return true;
}

}  // namespace

std::vector<char> detect_creases(const SurfaceMesh& mesh, double angle_degrees, const RunContext& context) {
  CreaseNetwork network(mesh, angle_degrees, context);
  network.clean();
  return network.result();
}

}  // namespace sheetform
