#include "sheetform/strip/topology.h"

#include <algorithm>
#include <numeric>

namespace sheetform {
namespace {

constexpr int kOftenEnough = 1 << 17;  // sides or vertices between two looks at whether to stop

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  int find(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  // The lower root stays, so that roots are the lowest members.
  void unite(int a, int b) {
    a = find(a), b = find(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<int> parent_;
};

int corner_of(const std::vector<Triple>& faces, int face, int vertex) {
  for (int k = 0; k < 3; ++k)
    if (faces[face][k] == vertex) return 3 * face + k;
  return 3 * face;
}

std::vector<int> numbered_components(DisjointSets& pieces, int faces, int& count) {
  std::vector<int> component(faces, -1);
  for (int f = 0; f < faces; ++f) {
    const int root = pieces.find(f);
    component[f] = root == f ? count++ : component[root];
  }
  return component;
}

// A vertex is a manifold one when the face corners around it hang together.
void count_vertices(const std::vector<Triple>& faces, DisjointSets& fans, int vertices, Topology& t) {
  std::vector<char> seen(vertices, 0);
  for (int c = 0; c < 3 * t.faces; ++c) {
    char& v = seen[faces[c / 3][c % 3]];
    if (!v) ++t.vertices;
    if (v && fans.find(c) == c && t.nonmanifold_vertex < 0) t.nonmanifold_vertex = faces[c / 3][c % 3];
    v = 1;
  }
}

int count_border_loops(const std::vector<Triple>& faces, const EdgeTable& table, DisjointSets& fans) {
  DisjointSets loops(3 * faces.size());
  std::vector<int> roots;
  for (const EdgeTable::Edge& e : table.edges) {
    if (e.count != 1) continue;
    const int f = table.use(e, 0).face;
    const int a = fans.find(corner_of(faces, f, e.a)), b = fans.find(corner_of(faces, f, e.b));
    loops.unite(a, b);
    roots.push_back(a);
  }
  for (int& r : roots) r = loops.find(r);
  std::sort(roots.begin(), roots.end());
  return static_cast<int>(std::unique(roots.begin(), roots.end()) - roots.begin());
}

}  // namespace

// Sides (3 f + k) are dealt out by their lower end, then sorted there: few have the same.
EdgeTable::EdgeTable(const std::vector<Triple>& faces, const RunContext& context) {
  const auto n = static_cast<int>(3 * faces.size());
  const auto use_of = [&](int s) { return Use{faces[s / 3][s % 3], faces[s / 3][(s % 3 + 1) % 3], s / 3}; };
  int vertices = 0;
  for (const Triple& t : faces) vertices = std::max({vertices, t[0] + 1, t[1] + 1, t[2] + 1});
  std::vector<int> begin(vertices + 1, 0);
  for (int s = 0; s < n; ++s) {
    if (s % kOftenEnough == 0) context.checkpoint();
    const Use u = use_of(s);
    ++begin[std::min(u.a, u.b) + 1];
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::pair<int, int>> order(n);  // (upper end, side), by lower end
  std::vector<int> end(begin.begin(), begin.end() - 1);
  for (int s = 0; s < n; ++s) {
    if (s % kOftenEnough == 0) context.checkpoint();
    const Use u = use_of(s);
    order[end[std::min(u.a, u.b)]++] = {std::max(u.a, u.b), s};
  }
  uses.reserve(order.size());
  for (int v = 0; v < vertices; ++v) {
    if (v % kOftenEnough == 0) context.checkpoint();
    std::sort(order.begin() + begin[v], order.begin() + begin[v + 1]);
    for (int i = begin[v]; i < begin[v + 1]; ++i) {
      uses.push_back(use_of(order[i].second));
      if (i > begin[v] && order[i].first == order[i - 1].first)
        ++edges.back().count;
      else
        edges.push_back({v, order[i].first, i, 1});
    }
  }
}

int EdgeTable::find(int a, int b) const {
  if (a > b) std::swap(a, b);
  const auto it =
      std::lower_bound(edges.begin(), edges.end(), std::array{a, b}, [](const Edge& e, const auto& key) {
        return std::array{e.a, e.b} < key;
      });
  return it != edges.end() && it->a == a && it->b == b ? static_cast<int>(it - edges.begin()) : -1;
}

Topology topology_of(const std::vector<Triple>& faces, const EdgeTable& table, int vertices) {
  Topology t;
  t.faces = static_cast<int>(faces.size());
  t.edges = static_cast<int>(table.edges.size());
  DisjointSets fans(3 * faces.size()), pieces(faces.size());
  for (int f = 0; f < t.faces; ++f) {
    const Triple& x = faces[f];
    if (t.repeated_face < 0 && (x[0] == x[1] || x[1] == x[2] || x[2] == x[0])) t.repeated_face = f;
  }
  for (std::size_t i = 0; i < table.edges.size(); ++i) {
    const EdgeTable::Edge& e = table.edges[i];
    if (e.a == e.b) continue;
    if (e.count > 2 && t.nonmanifold_edge < 0) t.nonmanifold_edge = static_cast<int>(i);
    if (e.count == 2 && table.use(e, 0).a == table.use(e, 1).a && t.misoriented_edge < 0)
      t.misoriented_edge = static_cast<int>(i);
    for (int k = 1; k < e.count; ++k) {
      const int f = table.use(e, 0).face, g = table.use(e, k).face;
      pieces.unite(f, g);
      fans.unite(corner_of(faces, f, e.a), corner_of(faces, g, e.a));
      fans.unite(corner_of(faces, f, e.b), corner_of(faces, g, e.b));
    }
  }
  t.component = numbered_components(pieces, t.faces, t.components);
  count_vertices(faces, fans, vertices, t);
  t.border_loops = count_border_loops(faces, table, fans);
  return t;
}

}  // namespace sheetform
