#include "sheetform/mesh/gluing.h"

#include <algorithm>
#include <numeric>
#include <queue>
#include <tuple>

namespace sheetform::gluing {

double area(const TriangleSoup& soup, int face) {
  const auto& t = soup.faces[face];
  return (soup.points[t[1]] - soup.points[t[0]]).cross(soup.points[t[2]] - soup.points[t[0]]).norm() / 2;
}

namespace {

constexpr int kMostPaired = 16;  // more faces on one edge are all cut apart; also keeps the work linear

int tail(const TriangleSoup& soup, int side) { return soup.faces[side / 3][side % 3]; }
int head(const TriangleSoup& soup, int side) { return soup.faces[side / 3][(side % 3 + 1) % 3]; }
int apex(const TriangleSoup& soup, int side) { return soup.faces[side / 3][(side % 3 + 2) % 3]; }
bool same_direction(const TriangleSoup& soup, int a, int b) { return tail(soup, a) == tail(soup, b); }

void join(Gluing& gluing, int a, int b) { gluing.partner[a] = b, gluing.partner[b] = a; }

std::vector<int> sides_by_edge(const TriangleSoup& soup) {
  struct Key {
    int lo, hi, side;
    bool operator<(const Key& o) const {
      return lo != o.lo ? lo < o.lo : hi != o.hi ? hi < o.hi : side < o.side;
    }
  };
  std::vector<Key> keys(soup.faces.size() * 3);
  for (int s = 0; s < static_cast<int>(keys.size()); ++s) {
    const auto [lo, hi] = std::minmax({tail(soup, s), head(soup, s)});
    keys[s] = {lo, hi, s};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<int> sides;
  for (const Key& k : keys) sides.push_back(k.side);
  return sides;
}

// Direction from the edge into the face, perpendicular to the edge.
Vector3 inward(const TriangleSoup& soup, int side) {
  const Vector3& a = soup.points[tail(soup, side)];
  const Vector3 along = (soup.points[head(soup, side)] - a).normalized();
  const Vector3 w = soup.points[apex(soup, side)] - a;
  return (w - along * along.dot(w)).normalized();
}

void pair_up(const TriangleSoup& soup, const int* begin, const int* end, Gluing& gluing) {
  struct Pair {
    double cost;
    int a, b;
  };
  std::vector<Pair> pairs;
  for (const int* a = begin; a != end; ++a)
    for (const int* b = a + 1; b != end; ++b) {
      const double fold = inward(soup, *a).dot(inward(soup, *b));  // -1: flat, 1: folded together
      const bool matching = !same_direction(soup, *a, *b);
      if (matching || fold < 0) pairs.push_back({fold + (matching ? 0 : 2), *a, *b});
    }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& x, const Pair& y) {
    return std::tie(x.cost, x.a, x.b) < std::tie(y.cost, y.a, y.b);
  });
  for (const Pair& p : pairs)
    if (gluing.partner[p.a] < 0 && gluing.partner[p.b] < 0) join(gluing, p.a, p.b);
}

Vector3 middle(const TriangleSoup& soup, int face) {
  const auto& t = soup.faces[face];
  return (soup.points[t[0]] + soup.points[t[1]] + soup.points[t[2]]) / 3;
}

struct Step {
  double distance;
  int face, from_side;  // side of `face` over which it is reached
  bool operator>(const Step& o) const {
    return std::tie(distance, face, from_side) > std::tie(o.distance, o.face, o.from_side);
  }
};

// Orients the component of `seed` like it, nearest faces first, so that a cut lies where fronts meet: short.
std::vector<int> orient_component(const TriangleSoup& soup, Gluing& gluing, int seed,
                                  std::vector<char>& done) {
  std::vector<int> members;
  std::priority_queue<Step, std::vector<Step>, std::greater<>> queue;
  queue.push({0, seed, -1});
  while (!queue.empty()) {
    const Step step = queue.top();
    queue.pop();
    if (done[step.face]) continue;
    done[step.face] = 1;
    members.push_back(step.face);
    if (step.from_side >= 0) {
      const int other = gluing.partner[step.from_side];
      gluing.turned[step.face] =
          static_cast<char>(gluing.turned[other / 3] ^ same_direction(soup, step.from_side, other));
    }
    for (int s = 3 * step.face; s < 3 * step.face + 3; ++s) {
      const int next = gluing.partner[s];
      if (next < 0 || done[next / 3]) continue;
      queue.push({step.distance + (middle(soup, step.face) - middle(soup, next / 3)).norm(), next / 3, next});
    }
  }
  return members;
}

void keep_majority(const TriangleSoup& soup, const std::vector<int>& members, Gluing& gluing) {
  double turned = 0, all = 0;
  for (int f : members) {
    const double a = area(soup, f);
    all += a;
    if (gluing.turned[f]) turned += a;
  }
  if (turned > all / 2)
    for (int f : members) gluing.turned[f] ^= 1;
}

bool cut_contradictions(const TriangleSoup& soup, const std::vector<int>& members, Gluing& gluing) {
  bool any = false;
  for (int f : members)
    for (int s = 3 * f; s < 3 * f + 3; ++s) {
      const int other = gluing.partner[s];
      if (other < 0) continue;
      const bool flip = gluing.turned[f] != gluing.turned[other / 3];
      if (flip == same_direction(soup, s, other)) continue;
      gluing.partner[s] = gluing.partner[other] = -1;
      gluing.cut.push_back(s);
      any = true;
    }
  return any;
}

int find_root(std::vector<int>& parent, int i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

void unite(std::vector<int>& parent, int a, int b) {
  a = find_root(parent, a), b = find_root(parent, b);
  parent[std::max(a, b)] = std::min(a, b);
}

int next_corner(int side) { return side - side % 3 + (side % 3 + 1) % 3; }

}  // namespace

Gluing glue(const TriangleSoup& soup) {
  Gluing gluing;
  gluing.partner.assign(soup.faces.size() * 3, -1);
  gluing.turned.assign(soup.faces.size(), 0);
  const std::vector<int> sides = sides_by_edge(soup);
  auto same_edge = [&](int a, int b) {
    return std::minmax({tail(soup, a), head(soup, a)}) == std::minmax({tail(soup, b), head(soup, b)});
  };
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t j = i + 1;
    while (j < sides.size() && same_edge(sides[i], sides[j])) ++j;
    if (j - i == 2) join(gluing, sides[i], sides[i + 1]);
    if (j - i > 2) gluing.crowded.push_back(sides[i]);
    if (j - i > 2 && j - i <= kMostPaired) pair_up(soup, sides.data() + i, sides.data() + j, gluing);
    i = j;
  }
  return gluing;
}

void orient(const TriangleSoup& soup, Gluing& gluing) {
  std::vector<char> done(soup.faces.size(), 0);
  for (int seed = 0; seed < static_cast<int>(soup.faces.size()); ++seed) {
    if (done[seed]) continue;
    const std::vector<int> members = orient_component(soup, gluing, seed, done);
    keep_majority(soup, members, gluing);
    if (cut_contradictions(soup, members, gluing)) ++gluing.one_sided_components;
  }
}

std::vector<int> fan_vertices(const TriangleSoup& soup, const Gluing& gluing, std::vector<int>& origin) {
  const int corners = static_cast<int>(soup.faces.size()) * 3;
  std::vector<int> parent(corners), vertex(corners, -1);
  std::iota(parent.begin(), parent.end(), 0);
  for (int s = 0; s < corners; ++s) {
    const int other = gluing.partner[s];
    if (other < s) continue;
    const bool same = same_direction(soup, s, other);
    unite(parent, s, same ? other : next_corner(other));
    unite(parent, next_corner(s), same ? next_corner(other) : other);
  }
  std::vector<std::pair<int, int>> fans;  // old vertex, root: the lowest corner of the fan
  for (int c = 0; c < corners; ++c)
    if (find_root(parent, c) == c) fans.emplace_back(tail(soup, c), c);
  std::sort(fans.begin(), fans.end());
  origin.clear();
  for (const auto& [old, root] : fans) vertex[root] = static_cast<int>(origin.size()), origin.push_back(old);
  for (int c = 0; c < corners; ++c) vertex[c] = vertex[find_root(parent, c)];
  return vertex;
}

}  // namespace sheetform::gluing
