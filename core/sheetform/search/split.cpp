#include "sheetform/search/split.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>
#include <set>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace sheetform {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kFromEnds = 0.3, kFromMiddles = 0.1;  // see WantedCut::margin
constexpr std::size_t kManyCorners = 10;               // an outline that has more winds
using Queue =
    std::priority_queue<std::pair<double, int>, std::vector<std::pair<double, int>>, std::greater<>>;

// Lengths of edges as a cut counts them.
struct CutLength {
  static constexpr double kInside = 20;
  const SurfaceMesh& mesh;
  const std::vector<char>* keep_out;
  double operator()(int e) const {
    return mesh.edge_length(e) * (keep_out != nullptr && (*keep_out)[e] ? kInside : 1);
  }
};

// ---- patches that are no disks
// -------------------------------------------------------------------------------------

// Shortest-path tree over the patch's vertices from its boundary (or its lowest vertex when it has none).
struct Tree {
  std::vector<int> parent_edge, root;
  std::vector<double> distance;
};

Tree grow_tree(const SurfaceMesh& mesh, const PatchLayout& layout, const Patch& patch,
               const CutLength& length) {
  Tree tree;
  const std::size_t n = mesh.points.size();
  tree.parent_edge.assign(n, -1), tree.root.assign(n, -1), tree.distance.assign(n, kInfinity);
  Queue queue;
  auto seed = [&](int v) {
    if (tree.distance[v] == 0) return;
    tree.distance[v] = 0, tree.root[v] = v, queue.emplace(0, v);
  };
  for (int f : patch.faces)
    for (int k = 0; k < 3; ++k)
      if (layout.edge_arch[mesh.face_edges[f][k]] >= 0)
        seed(mesh.faces[f][k]), seed(mesh.faces[f][(k + 1) % 3]);
  if (queue.empty()) seed(mesh.faces[patch.faces.front()][0]);
  const int id = layout.face_patch[patch.faces.front()];
  while (!queue.empty()) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (d > tree.distance[v]) continue;
    for (const int* e = mesh.ring_begin_of(v); e != mesh.ring_end_of(v); ++e) {
      if (layout.edge_arch[*e] >= 0 || layout.face_patch[mesh.edges[*e].f0] != id) continue;
      const int w = mesh.edges[*e].other(v);
      const double next = d + length(*e);
      if (next >= tree.distance[w]) continue;
      tree.distance[w] = next, tree.parent_edge[w] = *e, tree.root[w] = tree.root[v];
      queue.emplace(next, w);
    }
  }
  return tree;
}

std::vector<int> tree_path(const SurfaceMesh& mesh, const Tree& tree, int v) {
  std::vector<int> path;
  while (tree.parent_edge[v] >= 0) {
    path.push_back(tree.parent_edge[v]);
    v = mesh.edges[tree.parent_edge[v]].other(v);
  }
  return path;
}

// The way from one root over edge e to another; a shared tail is dropped, which leaves a closed loop.
std::vector<int> generator(const SurfaceMesh& mesh, const Tree& tree, int e) {
  std::vector<int> a = tree_path(mesh, tree, mesh.edges[e].v0), b = tree_path(mesh, tree, mesh.edges[e].v1);
  while (!a.empty() && !b.empty() && a.back() == b.back()) a.pop_back(), b.pop_back();
  a.push_back(e);
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

std::vector<int> cut_to_disk(const SurfaceMesh& mesh, const PatchLayout& layout, const Patch& patch,
                             const CutLength& length) {
  const Tree tree = grow_tree(mesh, layout, patch, length);
  struct Candidate {
    double length;
    int edge;
  };
  std::vector<Candidate> free_edges;
  for (int f : patch.faces)
    for (int k = 0; k < 3; ++k) {
      const int e = mesh.face_edges[f][k];
      const auto& edge = mesh.edges[e];
      if (layout.edge_arch[e] >= 0 || f != edge.f0) continue;
      if (tree.parent_edge[edge.v0] == e || tree.parent_edge[edge.v1] == e) continue;
      free_edges.push_back({tree.distance[edge.v0] + tree.distance[edge.v1] + length(e), e});
    }
  // The dual spanning tree takes the longest ways first: what is left over are the short ones (Erickson,
  // Whittlesey).
  std::sort(free_edges.begin(), free_edges.end(), [](const Candidate& x, const Candidate& y) {
    return std::tie(y.length, x.edge) < std::tie(x.length, y.edge);
  });
  std::vector<int> parent(mesh.faces.size());
  std::iota(parent.begin(), parent.end(), 0);
  auto find = [&](int f) {
    while (parent[f] != f) f = parent[f] = parent[parent[f]];
    return f;
  };
  std::vector<Candidate> left;
  for (const Candidate& c : free_edges) {
    const int a = find(mesh.edges[c.edge].f0), b = find(mesh.edges[c.edge].f1);
    if (a == b) left.push_back(c);
    parent[a] = b;
  }
  if (!left.empty()) return generator(mesh, tree, left.back().edge);
  return {};
}

// Any loop on a closed sphere: around the vertices that are nearer to the start than half of the area.
std::vector<int> halve_closed(const SurfaceMesh& mesh, const PatchLayout& layout, const Patch& patch,
                              const CutLength& length) {
  const Tree tree = grow_tree(mesh, layout, patch, length);
  std::vector<int> order = patch.faces;
  auto far = [&](int f) {
    const auto& t = mesh.faces[f];
    return tree.distance[t[0]] + tree.distance[t[1]] + tree.distance[t[2]];
  };
  std::sort(order.begin(), order.end(),
            [&](int x, int y) { return std::pair(far(x), x) < std::pair(far(y), y); });
  // Grow the near side face by face and keep it a disk: a face joins over one edge with a new vertex, or over
  // two edges.
  std::vector<char> in(mesh.faces.size(), 0), touched(mesh.points.size(), 0);
  double area = 0;
  for (bool grown = true; grown && area < patch.area / 2;) {
    grown = false;
    for (int f : order) {
      if (in[f]) continue;
      int edges = 0, vertices = 0;
      for (int k = 0; k < 3; ++k) {
        edges += in[mesh.edges[mesh.face_edges[f][k]].other_face(f)];
        vertices += touched[mesh.faces[f][k]];
      }
      if (area > 0 && !((edges == 1 && vertices == 2) || edges == 2)) continue;
      in[f] = 1, grown = true;
      for (int v : mesh.faces[f]) touched[v] = 1;
      area += mesh.face_normal_raw(f).norm() / 2;
      if (area >= patch.area / 2) break;
    }
  }
  std::vector<int> loop;
  for (int e = 0; e < mesh.edge_count(); ++e)
    if (!mesh.edges[e].border() && in[mesh.edges[e].f0] != in[mesh.edges[e].f1]) loop.push_back(e);
  return loop;
}

// ---- disks: a cut in the chart
// -------------------------------------------------------------------------------------

// A wanted curve in the chart and the stretches of the outline where the cut should start and end.
struct WantedCut {
  std::vector<Vector2> line;
  int avoid_a = -1, avoid_b = -1;  // places of the loop that have to end up on different sides, -1: none
  double margin = 0;               // how far from those the cut ends, as a share of the way between them
};

class ChartCutter {
 public:
  ChartCutter(const SurfaceMesh& mesh, const PatchLayout& layout, const Patch& patch, const PatchChart& chart,
              const CutLength& length)
      : layout_(layout), chart_(chart), length_(length) {
    const int n = static_cast<int>(chart.vertices.size());
    place_.assign(n, -1);
    for (const auto& line : chart.boundary)
      for (std::size_t i = 0; i + 1 < line.size(); ++i)
        place_[line[i]] = static_cast<int>(loop_.size()), loop_.push_back(line[i]);
    neighbours_.resize(n);
    for (std::size_t t = 0; t < chart.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        const int e = mesh.face_edges[patch.faces[t]][k];
        if (layout.edge_arch[e] >= 0) continue;
        const int a = chart.triangles[t][k], b = chart.triangles[t][(k + 1) % 3];
        if (mesh.edges[e].f0 == patch.faces[t])
          neighbours_[a].push_back({b, e}), neighbours_[b].push_back({a, e});
      }
    scale_ = std::sqrt(std::max(patch.area, 1e-300));
  }

  const std::vector<int>& loop() const { return loop_; }
  const Vector2& uv(int place) const { return chart_.uv[loop_[place]]; }
  int places() const { return static_cast<int>(loop_.size()); }
  // Halfway on the outline from place a on to b, a < b, and halfway on from b to a.
  std::pair<int, int> middles(int a, int b) const {
    const int n = places();
    return {a + (b - a) / 2, (b + (n - b + a) / 2) % n};
  }
  // From one of these to the other: places a and b are on different sides.
  std::vector<Vector2> line_between(int a, int b) const {
    const auto [from, to] = middles(a, b);
    return {uv(from), uv(to)};
  }
  int nearest_place(const Vector2& u) const {
    int nearest = 0;
    for (int p = 1; p < places(); ++p)
      if ((uv(p) - u).squaredNorm() < (uv(nearest) - u).squaredNorm()) nearest = p;
    return nearest;
  }

  std::vector<int> cut(const WantedCut& wanted) const {
    const int n = static_cast<int>(chart_.vertices.size());
    std::vector<double> distance(n, kInfinity);
    std::vector<int> from(n, -1), via(n, -1), origin(n, -1);
    Queue queue;
    for (int p = 0; p < places(); ++p) {
      if (wanted.avoid_a >= 0 && !between(wanted.avoid_a, p, wanted.avoid_b, wanted.margin)) continue;
      const double d = end_cost(loop_[p], wanted.line.front());
      distance[loop_[p]] = d, origin[loop_[p]] = p, queue.emplace(d, loop_[p]);
    }
    double best = kInfinity;
    int best_from = -1, best_edge = -1;
    while (!queue.empty()) {
      const auto [d, v] = queue.top();
      queue.pop();
      if (d > distance[v] || d > best) continue;
      for (const auto& [w, e] : neighbours_[v]) {
        const double next = d + length_(e) * (1 + 40 * deviation(v, w, wanted.line));
        if (place_[w] >= 0) {  // arrived on the outline
          if (!target_ok(origin[v], place_[w], wanted)) continue;
          const double total = next + end_cost(w, wanted.line.back());
          if (total < best) best = total, best_from = v, best_edge = e;
          continue;
        }
        if (next < distance[w])
          distance[w] = next, from[w] = v, via[w] = e, origin[w] = origin[v], queue.emplace(next, w);
      }
    }
    std::vector<int> edges;
    if (best_from < 0) return edges;
    edges.push_back(best_edge);
    for (int v = best_from; from[v] >= 0; v = from[v]) edges.push_back(via[v]);
    return edges;
  }

 private:
  bool between(int a, int p, int b, double margin) const {
    const int n = places(), span = (b - a + n) % n, at = (p - a + n) % n;
    return at > margin * span && at < (1 - margin) * span;
  }
  bool target_ok(int start, int end, const WantedCut& wanted) const {
    if (start == end || chart_.vertices[loop_[start]] == chart_.vertices[loop_[end]]) return false;
    return wanted.avoid_a < 0 || between(wanted.avoid_b, end, wanted.avoid_a, wanted.margin);
  }
  double end_cost(int v, const Vector2& wanted) const {
    const bool node = layout_.node[chart_.vertices[v]];
    return 4 * (chart_.uv[v] - wanted).norm() + (node ? 0.02 * scale_ : 0);
  }
  double deviation(int v, int w, const std::vector<Vector2>& line) const {
    const Vector2 p = (chart_.uv[v] + chart_.uv[w]) / 2;
    double best = kInfinity;
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
      const Vector2 d = line[i + 1] - line[i];
      const double t = std::clamp((p - line[i]).dot(d) / std::max(d.squaredNorm(), 1e-300), 0.0, 1.0);
      best = std::min(best, (p - line[i] - t * d).squaredNorm());
    }
    return best / (scale_ * scale_);
  }

  const PatchLayout& layout_;
  const PatchChart& chart_;
  const CutLength length_;
  std::vector<int> loop_, place_;
  std::vector<std::vector<std::pair<int, int>>> neighbours_;
  double scale_ = 1;
};

// Through the middle of the chart, across its longer axis (second moments of the vertices).
std::vector<Vector2> across_longer_axis(const PatchChart& chart) {
  Vector2 mean = Vector2::Zero();
  for (const Vector2& u : chart.uv) mean += u;
  mean /= static_cast<double>(chart.uv.size());
  double xx = 0, xy = 0, yy = 0;
  for (const Vector2& u : chart.uv) {
    const Vector2 d = u - mean;
    xx += d.x() * d.x(), xy += d.x() * d.y(), yy += d.y() * d.y();
  }
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  const Vector2 longer(std::cos(angle), std::sin(angle)), shorter(-longer.y(), longer.x());
  double reach = 0;
  for (const Vector2& u : chart.uv) reach = std::max(reach, std::abs((u - mean).dot(shorter)));
  return {mean - reach * shorter, mean + reach * shorter};
}

double distance_to_chord(const PatchEvaluation& e, const RulingSet::Chord& c, const Vector2& u) {
  const Vector2 a = e.polygon.uv[c.a], d = e.polygon.uv[c.b] - a;
  return (u - a - std::clamp((u - a).dot(d) / std::max(d.squaredNorm(), 1e-300), 0.0, 1.0) * d).squaredNorm();
}

// Across the rulings, so that they are cut where the error is largest (not nearer to their ends than a
// quarter); near either end of the sweep, where rulings do not help, along the ruling that cuts the end off.
std::vector<Vector2> across_rulings(const PatchEvaluation& e) {
  const auto& chords = e.rulings.chords;
  const int n = static_cast<int>(chords.size());
  if (n < 4) return across_longer_axis(*e.chart);
  int near = 0;
  for (int i = 1; i < n; ++i)
    if (distance_to_chord(e, chords[i], e.worst) < distance_to_chord(e, chords[near], e.worst)) near = i;
  if (near < n / 10 || near >= n - n / 10) {
    const auto& c = chords[near < n / 10 ? std::max(1, n / 6) : std::min(n - 2, n - 1 - n / 6)];
    return {e.polygon.uv[c.a], e.polygon.uv[c.b]};
  }
  const Vector2 a = e.polygon.uv[chords[near].a], d = e.polygon.uv[chords[near].b] - a;
  const double t = std::clamp((e.worst - a).dot(d) / std::max(d.squaredNorm(), 1e-300), 0.25, 0.75);
  // The ends of the chords in the order of one side of the strip: the side that chord `near` calls a.
  std::vector<Vector2> line;
  Vector2 side = a;
  for (int step : {-1, 1}) {
    side = a;
    std::vector<Vector2> part;
    for (int i = near; i >= 0 && i < n; i += step) {
      const Vector2 &p = e.polygon.uv[chords[i].a], &q = e.polygon.uv[chords[i].b];
      const bool same = (p - side).squaredNorm() <= (q - side).squaredNorm();
      side = same ? p : q;
      part.push_back((1 - t) * side + t * (same ? q : p));
    }
    if (step < 0) {
      line.assign(part.rbegin(), part.rend());
    } else {
      line.insert(line.end(), part.begin() + 1, part.end());
    }
  }
  // On to the outline at both ends.
  const Vector2 head = line.front() - line[1], tail = line.back() - line[line.size() - 2];
  line.insert(line.begin(), line.front() + head);
  line.push_back(line.back() + tail);
  return line;
}

constexpr double kNothingWon = 100;  // what a cut that leaves as many corners costs

// Straight between two outline points that share the corners evenly and lie close together. Both halves get a
// corner at each end of the cut: where one would have as many as before, it ends at corners instead.
std::vector<Vector2> between_corners(const PatchEvaluation& e) {
  const int n = e.polygon.size(), c = static_cast<int>(e.corners.size());
  double best = kInfinity;
  std::vector<Vector2> line;
  for (int a = 0; a < n; ++a)
    for (int b = a + 2; b < n; ++b) {
      int inside = 0, at_ends = 0;
      for (int k : e.corners) inside += k > a && k < b, at_ends += k == a || k == b;
      const double uneven = std::abs(inside - (c - inside)) / static_cast<double>(c);
      double cost = (e.polygon.uv[a] - e.polygon.uv[b]).norm() * (1 + 3 * uneven * uneven);
      if (std::max(inside, c - inside - at_ends) + 2 >= c) cost *= kNothingWon;
      if (std::min(b - a, n - b + a) > n / 5 && cost < best)
        best = cost, line = {e.polygon.uv[a], e.polygon.uv[b]};
    }
  return line;
}

// The two parts of the outline between the ends of the line have to come to different sides: it may leave a
// winding chart, and a corner cut off at one of its ends would be a shorter cut.
void keep_apart(const ChartCutter& cutter, WantedCut& wanted) {
  int a = cutter.nearest_place(wanted.line.front()), b = cutter.nearest_place(wanted.line.back());
  if (b < a) std::swap(a, b), std::swap(wanted.line.front(), wanted.line.back());
  std::tie(wanted.avoid_b, wanted.avoid_a) = cutter.middles(a, b);
  wanted.margin = kFromMiddles;
}

// Two places of the loop that stand for the same mesh vertex (or the two sides of a seam), -1 if none.
std::pair<int, int> double_place(const ChartCutter& cutter, const PatchChart& chart) {
  std::vector<std::pair<int, int>> seen;
  for (int p = 0; p < cutter.places(); ++p) seen.emplace_back(chart.vertices[cutter.loop()[p]], p);
  std::sort(seen.begin(), seen.end());
  for (std::size_t i = seen.size() / 2, k = 0; k < seen.size(); ++k, i = (i + 1) % seen.size())
    if (i + 1 < seen.size() && seen[i].first == seen[i + 1].first)
      return {seen[i].second, seen[i + 1].second};
  return {-1, -1};
}

// For a chart that says little: between the two places that are farthest apart in space, well away from both.
WantedCut through_the_middle(const SurfaceMesh& mesh, const ChartCutter& cutter, const PatchChart& chart) {
  const int n = cutter.places();
  WantedCut wanted;
  double farthest = -1;
  for (int a = 0; a < n; ++a)
    for (int b = a + 1; b < n; ++b) {
      const auto at = [&](int p) { return mesh.points[chart.vertices[cutter.loop()[p]]]; };
      const double d = (at(a) - at(b)).squaredNorm();
      if (d > farthest) farthest = d, wanted.avoid_a = a, wanted.avoid_b = b;
    }
  wanted.line = cutter.line_between(wanted.avoid_a, wanted.avoid_b);
  wanted.margin = kFromEnds;
  return wanted;
}

// The share of a disk's area that a cut leaves on its smaller side; 0 where there is none.
double smaller_share(const SurfaceMesh& mesh, const PatchLayout& layout, const Patch& patch,
                     const std::vector<int>& cut) {
  if (cut.empty()) return 0;
  std::vector<int> side{mesh.edges[cut[0]].f0};
  std::set<int> seen(side.begin(), side.end());
  double area = 0;
  for (std::size_t i = 0; i < side.size(); ++i) {
    area += mesh.face_normal_raw(side[i]).norm() / 2;
    for (int e : mesh.face_edges[side[i]]) {
      if (layout.edge_arch[e] >= 0 || std::find(cut.begin(), cut.end(), e) != cut.end()) continue;
      const int beyond = mesh.edges[e].other_face(side[i]);
      if (seen.insert(beyond).second) side.push_back(beyond);
    }
  }
  return std::min(area, patch.area - area) / patch.area;
}

// The cut that is wanted, or another where it leaves less than this share of the patch on one side: it may be
// cheapest to cut off a corner at one end of a line that leaves the chart, face by face again and again.
std::vector<int> even_cut(const SurfaceMesh& mesh, const PatchLayout& layout, const Patch& patch,
                          const ChartCutter& cutter, const PatchChart& chart, const WantedCut& wanted,
                          double least_share) {
  std::vector<int> best = cutter.cut(wanted);
  if (least_share <= 0) return best;
  double share = smaller_share(mesh, layout, patch, best);
  const auto try_line = [&](const std::vector<Vector2>& line, bool apart) {
    if (share >= least_share) return;
    WantedCut other;
    other.line = line;
    if (apart) keep_apart(cutter, other);
    std::vector<int> cut = cutter.cut(other);
    const double now = smaller_share(mesh, layout, patch, cut);
    if (now > share) share = now, best = std::move(cut);
  };
  const std::vector<Vector2> middle = across_longer_axis(chart);
  try_line(wanted.line, true);
  try_line(middle, false);
  try_line(middle, true);
  return best;
}

// From the loose end of a slit (a crease that ends inside of the patch) to the nearest other network vertex.
std::vector<int> extend_loose_end(const SurfaceMesh& mesh, const PatchLayout& layout, int patch,
                                  const CutLength& length) {
  const auto degree = [&](int v) {
    int d = 0;
    for (const int* e = mesh.ring_begin_of(v); e != mesh.ring_end_of(v); ++e) d += layout.edge_arch[*e] >= 0;
    return d;
  };
  int loose = -1, own = -1;
  for (const ArchUse& use : layout.patches[patch].boundary) {
    const Arch& a = layout.arches[use.arch];
    for (int v : {a.vertices.front(), a.vertices.back()})
      if (a.left == a.right && degree(v) == 1) loose = v, own = use.arch;
  }
  if (loose < 0) return {};
  std::unordered_map<int, std::pair<double, int>> known{{loose, {0, -1}}};
  const std::set<int> own_vertices(layout.arches[own].vertices.begin(), layout.arches[own].vertices.end());
  Queue queue;
  queue.emplace(0, loose);
  while (!queue.empty()) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (d > known[v].first) continue;
    if (v != loose && degree(v) > 0) {
      std::vector<int> edges;
      for (int w = v; known[w].second >= 0;)
        edges.push_back(known[w].second), w = mesh.edges[known[w].second].other(w);
      return edges;
    }
    for (const int* e = mesh.ring_begin_of(v); e != mesh.ring_end_of(v); ++e) {
      const int w = mesh.edges[*e].other(v);
      if (layout.edge_arch[*e] >= 0 || own_vertices.count(w)) continue;
      const double next = d + length(*e);
      const auto it = known.find(w);
      if (it != known.end() && it->second.first <= next) continue;
      known[w] = {next, *e};
      queue.emplace(next, w);
    }
  }
  return {};
}

// ---- straight lines
// -------------------------------------------------------------------------------------

constexpr int kMostEnds = 300;  // places of an outline that lines end at
constexpr double kApart = 0.4;  // lines differ by so much of the longest at one end
constexpr int kLookedAt = 10;   // stretches of a line whose ends have to lie inside of the chart

bool is_inside(const ChartCutter& cutter, const Vector2& u) {
  bool inside = false;
  for (int i = 0, n = cutter.places(); i < n; ++i) {
    const Vector2 &a = cutter.uv(i), &b = cutter.uv((i + 1) % n);
    if ((a.y() > u.y()) != (b.y() > u.y()))
      inside ^= u.x() < a.x() + (b.x() - a.x()) * (u.y() - a.y()) / (b.y() - a.y());
  }
  return inside;
}

// Between two places of the outline.
struct Line {
  double length;
  Vector2 from, to;
  int a, b;

  bool runs_inside(const ChartCutter& cutter) const {
    for (int k = 1; k < kLookedAt; ++k)
      if (!is_inside(cutter, from + (to - from) * k / kLookedAt)) return false;
    return true;
  }
  bool is_near(const Line& other, double distance) const {
    const auto near = [&](const Vector2& f, const Vector2& t) {
      return std::max((from - f).norm(), (to - t).norm()) < distance;
    };
    return near(other.from, other.to) || near(other.to, other.from);
  }
};

// Shorter than `most`, with this area on either side; the shortest first.
std::vector<Line> short_lines(const ChartCutter& cutter, double most, double least_area) {
  const int n = cutter.places(), step = (n + kMostEnds - 1) / kMostEnds;
  std::vector<double> twice(n + 1, 0);  // the area that the outline up to each place goes around
  for (int i = 0; i < n; ++i) twice[i + 1] = twice[i] + cross(cutter.uv(i), cutter.uv((i + 1) % n));
  std::vector<Line> lines;
  for (int a = 0; a < n; a += step)
    for (int b = a + step; b < n; b += step) {
      const Vector2 &from = cutter.uv(a), &to = cutter.uv(b);
      const double length = (from - to).norm(), area = (twice[b] - twice[a] + cross(to, from)) / 2;
      if (length < most && std::min(area, twice[n] / 2 - area) > least_area)
        lines.push_back({length, from, to, a, b});
    }
  std::sort(lines.begin(), lines.end(), [](const Line& x, const Line& y) {
    return std::tie(x.length, x.a, x.b) < std::tie(y.length, y.a, y.b);
  });
  return lines;
}

}  // namespace

std::vector<int> split_patch(const SurfaceMesh& mesh, const PatchLayout& layout, int patch,
                             const PatchEvaluation& evaluation, const std::vector<char>* keep_out,
                             double least_share) {
  const Patch& p = layout.patches[patch];
  const CutLength length{mesh, keep_out};
  if (p.defect == TopologyDefect::kNotADisk) {
    std::vector<int> edges = cut_to_disk(mesh, layout, p, length);
    if (edges.empty() && p.loops == 0) edges = halve_closed(mesh, layout, p, length);
    if (!edges.empty()) return edges;
  }
  if (p.defect == TopologyDefect::kDangling) {
    const std::vector<int> edges = extend_loose_end(mesh, layout, patch, length);
    if (!edges.empty()) return edges;
  }
  PatchChart own;
  const PatchChart* chart = evaluation.chart.get();
  if (chart == nullptr) own = parametrize(mesh, layout, p, {}), chart = &own;
  const ChartCutter cutter(mesh, layout, p, *chart, length);
  WantedCut wanted;
  if (p.defect != TopologyDefect::kNone) {
    std::tie(wanted.avoid_a, wanted.avoid_b) = double_place(cutter, *chart);
    if (wanted.avoid_a >= 0) {
      wanted.line = cutter.line_between(wanted.avoid_a, wanted.avoid_b);
      const std::vector<int> edges = cutter.cut(wanted);
      if (!edges.empty()) return edges;
      wanted.avoid_a = wanted.avoid_b = -1;
    }
  }
  if (evaluation.verdict == PatchVerdict::kFolded) {
    const std::vector<int> edges = cutter.cut(through_the_middle(mesh, cutter, *chart));
    if (!edges.empty()) return edges;
  }
  if (evaluation.verdict == PatchVerdict::kError) wanted.line = across_rulings(evaluation);
  if (evaluation.verdict == PatchVerdict::kTooManySides) {
    wanted.line = between_corners(evaluation);
    if (!wanted.line.empty() && evaluation.corners.size() > kManyCorners) keep_apart(cutter, wanted);
  }
  if (wanted.line.empty()) wanted.line = across_longer_axis(*chart);
  std::vector<int> edges = even_cut(mesh, layout, p, cutter, *chart, wanted, least_share);
  if (!edges.empty() || wanted.avoid_a < 0) return edges;
  wanted.avoid_a = wanted.avoid_b = -1;
  return cutter.cut(wanted);
}

std::vector<StraightCut> straight_cuts(const SurfaceMesh& mesh, const PatchLayout& layout, int patch,
                                       const PatchChart& chart, double most, double least_area, int count,
                                       const std::vector<char>* keep_out) {
  const ChartCutter cutter(mesh, layout, layout.patches[patch], chart, CutLength{mesh, keep_out});
  std::vector<StraightCut> cuts;
  std::vector<Line> taken;
  for (const Line& line : short_lines(cutter, most, least_area)) {
    if (static_cast<int>(cuts.size()) >= count) break;
    if (std::any_of(taken.begin(), taken.end(),
                    [&](const Line& t) { return t.is_near(line, kApart * most); }))
      continue;
    if (!line.runs_inside(cutter)) continue;
    taken.push_back(line);
    WantedCut wanted;
    wanted.line = {line.from, line.to};
    std::vector<int> edges = cutter.cut(wanted);
    if (!edges.empty()) cuts.push_back({std::move(edges), line.length});
  }
  return cuts;
}

}  // namespace sheetform
