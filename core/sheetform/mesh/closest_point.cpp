#include "sheetform/mesh/closest_point.h"

#include <algorithm>
#include <cmath>

#include "sheetform/mesh/faces_at.h"

namespace sheetform {
namespace {

constexpr int kBins = 16;           // of the surface-area heuristic
constexpr int kLeaf = 3;            // triangles in a leaf; four leaves share one node and one box test
constexpr int kOftenEnough = 2048;  // triangles that are placed between two looks at whether to stop
constexpr int kMaxSahDepth = 40;    // below it halves are equal, which bounds the depth and the query's stack
constexpr int kStack = 256;         // > 3 * (kMaxSahDepth + log2(2^31))
constexpr float kSlack =
    1e-6f;  // rounding of boxes and queries to float, in normalised lengths (box about 1)

struct Box {
  Vector3 lo = Vector3::Constant(std::numeric_limits<double>::infinity());
  Vector3 hi = Vector3::Constant(-std::numeric_limits<double>::infinity());
  void add(const Box& b) { lo = lo.cwiseMin(b.lo), hi = hi.cwiseMax(b.hi); }
  void add(const Vector3& p) { lo = lo.cwiseMin(p), hi = hi.cwiseMax(p); }
  double area() const {
    const Vector3 d = (hi - lo).cwiseMax(0);
    return d.x() * d.y() + d.y() * d.z() + d.z() * d.x();
  }
};

struct Item {
  Box box;
  Vector3 middle;
  int face;
};

struct Range {
  int begin, end, depth;
  Box box;
  int size() const { return end - begin; }
};

Box box_of(const std::vector<Item>& items, int begin, int end) {
  Box box;
  for (int i = begin; i < end; ++i) box.add(items[i].box);
  return box;
}

// Where the surface-area heuristic wants to cut: items with bin <= `bin` of `axis` go left.
struct Cut {
  int axis = -1, bin = 0;
  double lo = 0, per_unit = 0;
  bool left(const Item& item) const { return bin_of(item) <= bin; }
  int bin_of(const Item& item) const {
    return std::clamp(static_cast<int>((item.middle[axis] - lo) * per_unit), 0, kBins - 1);
  }
};

Cut best_cut_along(const std::vector<Item>& items, const Range& r, int axis, double lo, double hi,
                   double& cost) {
  Cut cut{axis, 0, lo, kBins / (hi - lo)};
  std::array<Box, kBins> boxes;
  std::array<int, kBins> counts{};
  for (int i = r.begin; i < r.end; ++i) {
    const int b = cut.bin_of(items[i]);
    boxes[b].add(items[i].box);
    ++counts[b];
  }
  std::array<double, kBins> right{};  // cost of everything above bin b
  Box box;
  for (int b = kBins - 1, n = 0; b > 0; --b)
    box.add(boxes[b]), n += counts[b], right[b - 1] = n * (n > 0 ? box.area() : 0);
  box = Box();
  Cut best;
  for (int b = 0, n = 0; b + 1 < kBins; ++b) {
    box.add(boxes[b]), n += counts[b];
    if (n == 0 || n == r.size()) continue;
    const double c = n * box.area() + right[b];
    if (c < cost) cost = c, best = cut, best.bin = b;
  }
  return best;
}

int halve(std::vector<Item>& items, const Range& r, const Box& middles) {
  int axis = 0;
  (middles.hi - middles.lo).maxCoeff(&axis);
  const int middle = (r.begin + r.end) / 2;
  std::nth_element(items.begin() + r.begin, items.begin() + middle, items.begin() + r.end,
                   [axis](const Item& x, const Item& y) {
                     return x.middle[axis] < y.middle[axis] ||
                            (x.middle[axis] == y.middle[axis] && x.face < y.face);
                   });
  return middle;
}

// Partitions items of r; returns the first of the right part.
int split(std::vector<Item>& items, const Range& r) {
  Box middles;
  for (int i = r.begin; i < r.end; ++i) middles.add(items[i].middle);
  Cut best;
  double cost = std::numeric_limits<double>::infinity();
  if (r.depth < kMaxSahDepth)
    for (int axis = 0; axis < 3; ++axis) {
      const double lo = middles.lo[axis], hi = middles.hi[axis];
      if (!(hi > lo) || !std::isfinite(kBins / (hi - lo))) continue;
      const Cut cut = best_cut_along(items, r, axis, lo, hi, cost);
      if (cut.axis >= 0) best = cut;
    }
  if (best.axis < 0) return halve(items, r, middles);
  const auto it = std::stable_partition(items.begin() + r.begin, items.begin() + r.end,
                                        [&](const Item& item) { return best.left(item); });
  return static_cast<int>(it - items.begin());
}

// Parameter of the point of segment a + t*d nearest to a + w.
double segment_parameter(const Vector3& w, const Vector3& d) {
  const double length2 = d.squaredNorm();
  return length2 > 0 ? std::clamp(w.dot(d) / length2, 0.0, 1.0) : 0.0;
}

// For triangles without a usable plane: the best of the three sides, as weights of b and c.
Vector2 nearest_on_sides(const Vector3& w, const Vector3& ab, const Vector3& ac) {
  const double s = segment_parameter(w, ab), t = segment_parameter(w, ac),
               u = segment_parameter(w - ab, ac - ab);
  const std::array<Vector2, 3> weights{Vector2(s, 0), Vector2(0, t), Vector2(1 - u, u)};
  int best = 0;
  double distance2 = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const double d = (w - weights[k][0] * ab - weights[k][1] * ac).squaredNorm();
    if (d < distance2) distance2 = d, best = k;
  }
  return weights[best];
}

// Ericson, Real-Time Collision Detection 5.1.5, with the dot products of the sides at hand. d1, d2: w with
// ab, ac.
Vector2 nearest_weights(double d1, double d2, double bb, double bc, double cc) {
  if (d1 <= 0 && d2 <= 0) return {0, 0};
  const double d3 = d1 - bb, d4 = d2 - bc;
  if (d3 >= 0 && d4 <= d3) return {1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {d1 / bb, 0};
  const double d5 = d1 - bc, d6 = d2 - cc;
  if (d6 >= 0 && d5 <= d6) return {0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {0, d2 / cc};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {1 - t, t};
  }
  const double sum = va + vb + vc;
  return {vb / sum, vc / sum};
}

bool is_thin(const Vector3& ab, const Vector3& ac) {
  const double longest2 = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
  return !(ab.cross(ac).norm() > 1e-10 * longest2);
}

}  // namespace

struct ClosestPointTree::Builder {
  const ClosestPointTree& tree;
  const RunContext& context;
  std::vector<Item> items;
  using Nodes = std::vector<Node>;

  void set_child(Node& node, int k, const Box& box) const {
    for (int axis = 0; axis < 3; ++axis) {
      node.lo[axis][k] = static_cast<float>((box.lo[axis] - tree.centre_[axis]) * tree.scale_) - kSlack;
      node.hi[axis][k] = static_cast<float>((box.hi[axis] - tree.centre_[axis]) * tree.scale_) + kSlack;
    }
  }

  // Up to four parts of r: the part with the largest box is split again.
  std::vector<Range> quarters(const Range& r) {
    std::vector<Range> parts{r};
    while (parts.size() < 4) {
      int pick = -1;
      for (int k = 0; k < static_cast<int>(parts.size()); ++k)
        if (parts[k].size() > kLeaf && (pick < 0 || parts[k].box.area() > parts[pick].box.area())) pick = k;
      if (pick < 0) break;
      const Range p = parts[pick];
      const int middle = split(items, p);
      parts[pick] = {p.begin, middle, p.depth + 1, box_of(items, p.begin, middle)};
      parts.insert(parts.begin() + pick + 1, {middle, p.end, p.depth + 1, box_of(items, middle, p.end)});
    }
    return parts;
  }

  // Appends the nodes of r, its own first. Large parts are built side by side and stand as they would one
  // after another.
  void build(const Range& r, Nodes& nodes) {
    if (r.size() > kOftenEnough) context.checkpoint();
    const std::size_t id = nodes.size();
    nodes.emplace_back();
    const std::vector<Range> parts = quarters(r);
    const auto n = static_cast<int>(parts.size());
    std::array<Nodes, 4> apart;
    if (r.size() > kOftenEnough)
      parallel_for(context, n, [&](int k) {
        if (parts[k].size() > kLeaf) build(parts[k], apart[k]);
      });
    for (int k = 0; k < 4; ++k) {
      if (k >= n) {
        for (int axis = 0; axis < 3; ++axis) nodes[id].lo[axis][k] = nodes[id].hi[axis][k] = 0;
        nodes[id].first[k] = -1, nodes[id].count[k] = -1;
        continue;
      }
      const bool leaf = parts[k].size() <= kLeaf;
      set_child(nodes[id], k, parts[k].box);
      nodes[id].count[k] = leaf ? parts[k].size() : 0;
      nodes[id].first[k] = leaf ? parts[k].begin : static_cast<int>(nodes.size());
      if (!apart[k].empty())
        append(apart[k], nodes);
      else if (!leaf)
        build(parts[k], nodes);
    }
  }

  static void append(Nodes& part, Nodes& nodes) {
    const auto shift = static_cast<int>(nodes.size());
    for (Node& node : part) {
      for (int k = 0; k < 4; ++k)
        if (node.count[k] == 0) node.first[k] += shift;
      nodes.push_back(node);
    }
  }
};

ClosestPointTree::ClosestPointTree(const std::vector<Vector3>& points,
                                   const std::vector<std::array<int, 3>>& faces, const RunContext& context) {
  if (faces.empty()) return;
  Builder builder{*this, context, {}};
  builder.items.reserve(faces.size());
  for (int f = 0; f < static_cast<int>(faces.size()); ++f) {
    if (f % (8 * kOftenEnough) == 0) context.checkpoint();
    Box box;
    for (int v : faces[f]) box.add(points[v]);
    builder.items.push_back({box, (box.lo + box.hi) / 2, f});
  }
  const Range all{0, static_cast<int>(faces.size()), 0,
                  box_of(builder.items, 0, static_cast<int>(faces.size()))};
  centre_ = (all.box.lo + all.box.hi) / 2;
  const double diagonal = (all.box.hi - all.box.lo).norm();
  scale_ = diagonal > 0 && std::isfinite(1 / diagonal) ? 1 / diagonal : 1;
  builder.build(all, nodes_);
  triangles_.reserve(faces.size());
  for (const Item& item : builder.items) {
    const auto& t = faces[item.face];
    const Vector3 ab = points[t[1]] - points[t[0]], ac = points[t[2]] - points[t[0]];
    triangles_.push_back(
        {points[t[0]], ab, ac, ab.dot(ab), ab.dot(ac), ac.dot(ac), item.face, is_thin(ab, ac)});
  }
}

void ClosestPointTree::test_triangle(const Triangle& t, const Vector3& query, ClosestPoint& best) const {
  const Vector3 w = query - t.a;
  const Vector2 weights =
      t.thin ? nearest_on_sides(w, t.ab, t.ac) : nearest_weights(w.dot(t.ab), w.dot(t.ac), t.bb, t.bc, t.cc);
  const Vector3 step = weights[0] * t.ab + weights[1] * t.ac;
  const double d = (w - step).squaredNorm();
  if (!(d <= best.squared_distance)) return;
  if (d == best.squared_distance && best.face >= 0 && best.face < t.face) return;
  best.squared_distance = d;
  best.face = t.face;
  best.point = t.a + step;
  best.barycentric = Vector3(1 - weights[0] - weights[1], weights[0], weights[1]);
}

ClosestPoint ClosestPointTree::closest(const Vector3& query, double bound2, double enough2) const {
  ClosestPoint best;
  if (nodes_.empty() || !query.allFinite()) return best;
  best.squared_distance = bound2;
  const Vector3 normalised = (query - centre_) * scale_;
  const Eigen::Array4f x = Eigen::Array4f::Constant(static_cast<float>(normalised.x()));
  const Eigen::Array4f y = Eigen::Array4f::Constant(static_cast<float>(normalised.y()));
  const Eigen::Array4f z = Eigen::Array4f::Constant(static_cast<float>(normalised.z()));
  // Float distances are compared with a bound a little larger than the true one: nothing near is skipped.
  const double to_float = scale_ * scale_ * (1 + 4e-6);
  struct Entry {
    float lower;
    int first, count;
  };
  std::array<Entry, kStack> stack;
  int top = 0;
  stack[top++] = {0, 0, 0};
  while (top > 0) {
    const Entry entry = stack[--top];
    if (entry.lower > static_cast<float>(best.squared_distance * to_float)) continue;
    if (entry.count > 0) {
      for (int i = 0; i < entry.count; ++i) test_triangle(triangles_[entry.first + i], query, best);
      if (best.face >= 0 && best.squared_distance <= enough2) break;
      continue;
    }
    const Node& node = nodes_[entry.first];
    const Eigen::Array4f dx = (node.lo[0] - x).max(x - node.hi[0]).max(0.0f);
    const Eigen::Array4f dy = (node.lo[1] - y).max(y - node.hi[1]).max(0.0f);
    const Eigen::Array4f dz = (node.lo[2] - z).max(z - node.hi[2]).max(0.0f);
    const Eigen::Array4f lower = dx * dx + dy * dy + dz * dz;
    const float bound = static_cast<float>(best.squared_distance * to_float);
    const int base = top;
    for (int k = 0; k < 4; ++k) {
      if (node.count[k] < 0 || lower[k] > bound) continue;
      int at = top++;  // keep the nearest on top
      while (at > base && stack[at - 1].lower < lower[k]) stack[at] = stack[at - 1], --at;
      stack[at] = {lower[k], node.first[k], node.count[k]};
    }
  }
  if (best.face < 0) best.squared_distance = std::numeric_limits<double>::infinity();
  return best;
}

std::vector<ClosestPointTree::Part> ClosestPointTree::parts() const {
  std::vector<Part> top;
  if (!nodes_.empty()) append_parts({Vector3::Zero(), 0, 0, 0}, top);
  return top;
}

void ClosestPointTree::append_parts(const Part& part, std::vector<Part>& to) const {
  const Node& node = nodes_[part.first];
  for (int k = 0; k < 4; ++k) {
    if (node.count[k] < 0) continue;
    Vector3 lo, hi;
    for (int axis = 0; axis < 3; ++axis) lo[axis] = node.lo[axis][k], hi[axis] = node.hi[axis][k];
    to.push_back(
        {(lo + hi) / (2 * scale_) + centre_, (hi - lo).norm() / (2 * scale_), node.first[k], node.count[k]});
  }
}

ClosestPoint closest_from(const SurfaceMesh& mesh, int face, const Vector3& query) {
  ClosestPoint best;
  const auto test = [&](int f) {
    const auto& t = mesh.faces[f];
    const Vector3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
    const Vector3 weights = nearest_in_triangle(query, a, b, c);
    const Vector3 point = a + weights[1] * (b - a) + weights[2] * (c - a);
    const double d = (query - point).squaredNorm();
    if (d < best.squared_distance) best = {point, weights, f, d};
  };
  test(face);
  for (int from = -1; from != best.face;) {
    from = best.face;
    for (int v : mesh.faces[from]) visit_faces_at(mesh, v, test);
  }
  return best;
}

Vector3 nearest_in_triangle(const Vector3& query, const Vector3& a, const Vector3& b, const Vector3& c) {
  const Vector3 w = query - a, ab = b - a, ac = c - a;
  const Vector2 weights = is_thin(ab, ac)
                              ? nearest_on_sides(w, ab, ac)
                              : nearest_weights(w.dot(ab), w.dot(ac), ab.dot(ab), ab.dot(ac), ac.dot(ac));
  return {1 - weights[0] - weights[1], weights[0], weights[1]};
}

double distance_to_triangle(const Vector3& query, const Vector3& a, const Vector3& b, const Vector3& c) {
  const Vector3 weights = nearest_in_triangle(query, a, b, c);
  return (query - a - weights[1] * (b - a) - weights[2] * (c - a)).norm();
}

}  // namespace sheetform
