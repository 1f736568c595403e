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
constexpr double kLeastLoop = 0.04, kLeastNetwork = 0.06;
constexpr double kLooseAtBorder = 0.15, kLooseAtCrease = 0.35, kLooseBoth = 0.5;
constexpr double kMostZigzag = 8, kMostZigzagLoose = 6, kMostTurn = 30;  // per vertex of a chain
constexpr double kLeastAnchor = 0.1;  // of the creases that a smooth chain hangs on with its one held end ...
constexpr double kAnchored = 0.2;     // ... of the length that it needs otherwise
constexpr double kJag = 0.25;         // of the middle edge of a chain: shorter steps are no turns of it
constexpr int kMostPasses = 50;
constexpr int kOftenEnough = 4096;  // edges between two looks at whether to stop

enum Mark : char { kNone = 0, kWeak = 1, kStrong = 2 };

double degrees_between(const Vector3& a, const Vector3& b) { return angle_between(a, b) * 180 / M_PI; }

struct Chain {
  std::vector<int> edges, vertices;  // vertices: one more than edges; first = last when closed
  bool closed = false;
};

struct ChainShape {
  double length = 0, weak = 0, dihedral = 0, turn = 0, zigzag = 0;  // angles: means
  int loose_ends = 0;
  bool at_border = false;  // one end at least
};

class CreaseNetwork {
 public:
  CreaseNetwork(const SurfaceMesh& mesh, double angle, const RunContext& context);
  // Removes chains and networks that are no creases until nothing changes.
  void clean() {
    bool changed = true;
    for (int pass = 0; changed && pass < kMostPasses; ++pass) {
      context_.checkpoint();
      changed = drop_chains();
      changed = drop_networks() || changed;
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
  bool keep(const Chain& chain, const ChainShape& s, double anchor) const;
  bool drop_chains();
  std::vector<double> anchor_lengths(const std::vector<Chain>& chains,
                                     const std::vector<ChainShape>& shapes) const;
  bool drop_networks();
  void erase(const std::vector<int>& edges) {
    for (int e : edges) marks_[e] = kNone;
  }

  const SurfaceMesh& mesh_;
  const RunContext& context_;
  double diagonal_, angle_;
  std::vector<Mark> marks_;
  std::vector<double> dihedral_,
      good_;  // good_: the edge's length when its chain looks like a crease by itself
};

CreaseNetwork::CreaseNetwork(const SurfaceMesh& mesh, double angle, const RunContext& context)
    : mesh_(mesh),
      context_(context),
      diagonal_(bounding_box_diagonal(mesh.points)),
      angle_(angle),
      marks_(mesh.edges.size(), kNone),
      dihedral_(mesh.edges.size(), 0),
      good_(mesh.edges.size(), 0) {
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
    if (marks_[e] == kWeak) s.weak += length;
  }
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
  if (s.weak > 0.6 * s.length && !is_bridge(chain, s)) return false;
  if (s.zigzag > kMostZigzag && chain.edges.size() > 4) return false;
  if (chain.closed)
    return s.length >= kLeastLoop * diagonal_ &&
           (chain.edges.size() >= 8 || s.dihedral >= angle_ + kSharpMore);
  if (s.loose_ends == 0) return true;
  const double least = s.loose_ends == 2 ? kLooseBoth : s.at_border ? kLooseAtBorder : kLooseAtCrease;
  const bool smooth = s.zigzag < 1.5 && s.turn < 15 && s.weak < 0.3 * s.length;
  if (smooth && anchor >= kLeastAnchor * diagonal_ && s.length >= kAnchored * least * diagonal_) return true;
  return s.length >= least * diagonal_ && s.weak < 0.4 * s.length && s.zigzag < kMostZigzagLoose;
}

// For each chain with one loose end: how long the creases without loose ends are that its other end hangs on.
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
    if (shapes[k].loose_ends == 0) length[root(chains[k].vertices.front())] += shapes[k].length;
  for (std::size_t k = 0; k < chains.size(); ++k)
    if (shapes[k].loose_ends == 1) {
      const Chain& c = chains[k];
      anchor[k] = length[root(is_loose(c.vertices.front()) ? c.vertices.back() : c.vertices.front())];
    }
  return anchor;
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
    const bool smooth =
        s.zigzag < kMostZigzag && (s.turn < kMostTurn || chain.closed || chain.edges.size() <= 2);
    const bool good = s.length >= kLeastLoop * diagonal_ && smooth;
    for (int e : chain.edges) good_[e] = good ? mesh_.edge_length(e) : 0;
    if (keep(chain, s, anchors[k])) continue;
    erase(chain.edges);
    any = true;
  }
  return any;
}

// Connected creases support each other: a tangle of short pieces is roughness.
bool CreaseNetwork::drop_networks() {
  bool any = false;
  std::vector<char> seen(mesh_.points.size(), 0);
  for (int seed = 0; seed < mesh_.vertex_count(); ++seed) {
    if (seen[seed] || degree(seed) == 0) continue;
    seen[seed] = 1;
    std::vector<int> stack{seed}, edges;
    double length = 0, good = 0;
    while (!stack.empty()) {
      const int v = stack.back();
      stack.pop_back();
      for (const int* q = mesh_.ring_begin_of(v); q != mesh_.ring_end_of(v); ++q) {
        if (marks_[*q] == kNone) continue;
        const int x = mesh_.edges[*q].other(v);
        if (v < x) edges.push_back(*q), length += mesh_.edge_length(*q), good += good_[*q];
        if (!seen[x]) seen[x] = 1, stack.push_back(x);
      }
    }
    if (length >= kLeastNetwork * diagonal_ && good >= length / 2) continue;
    erase(edges);
    any = true;
  }
  return any;
}

}  // namespace

std::vector<char> detect_creases(const SurfaceMesh& mesh, double angle_degrees, const RunContext& context) {
  CreaseNetwork network(mesh, angle_degrees, context);
  network.clean();
  return network.result();
}

}  // namespace sheetform
