#include "sheetform/blueprint/fold_lines.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "sheetform/strip/patch_shape.h"

namespace sheetform {
namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846;

// The corner of a triangle that is not on the edge, as an index into points.
int apex(const StripMesh::Triangle& t, const std::array<int, 2>& vt) {
  for (int k = 0; k < 3; ++k)
    if (t.vt[k] != vt[0] && t.vt[k] != vt[1]) return t.v[k];
  return t.v[0];
}

// Pieces of a patch between its rulings: triangles that hang together over diagonals.
std::vector<int> pieces_of(std::size_t triangles, const std::vector<Crease>& creases) {
  std::vector<int> parent(triangles);
  std::iota(parent.begin(), parent.end(), 0);
  const auto find = [&](int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const Crease& c : creases)
    if (c.ruling < 0)
      parent[std::max(find(c.triangles[0]), find(c.triangles[1]))] =
          std::min(find(c.triangles[0]), find(c.triangles[1]));
  std::vector<int> piece(triangles);
  for (std::size_t i = 0; i < triangles; ++i) piece[i] = find(static_cast<int>(i));
  return piece;
}

// Evenly spread marks over a run of rulings that all bend the same way.
void mark_run(const std::vector<double>& turns, int begin, int end, double step, double hidden,
              std::vector<DrawnRuling>& out) {
  const double total = std::accumulate(turns.begin() + begin, turns.begin() + end, 0.0);
  if (std::abs(total) < hidden) return;
  const int marks = std::clamp(static_cast<int>(std::lround(std::abs(total) / step)), 1, end - begin);
  double sum = 0;
  int made = 0;
  for (int i = begin; i < end && made < marks; ++i) {
    sum += turns[i];
    if (std::abs(sum) < (made + 0.5) * std::abs(total) / marks - 1e-12) continue;
    out.push_back({i, total / marks});
    while (made < marks && std::abs(sum) >= (made + 0.5) * std::abs(total) / marks - 1e-12) ++made;
  }
}

}  // namespace

double bend_over(const Vector3& a, const Vector3& b, const Vector3& first_apex, const Vector3& second_apex) {
  const Vector3 e = b - a, n = e.cross(first_apex - a), m = (second_apex - a).cross(e);
  return std::atan2(n.cross(m).dot(e.normalized()), n.dot(m)) * kDegrees;
}

std::vector<Crease> creases_of(const StripMesh& strips, int patch) {
  const StripMesh::Patch& p = strips.patches[patch];
  const PatchShape shape = shape_of(p);
  std::map<std::array<int, 2>, int> ruling;
  for (std::size_t i = 0; i < p.rulings.size(); ++i) {
    const auto& [a, b] = p.rulings[i];
    ruling[{std::min(a, b), std::max(a, b)}] = static_cast<int>(i);
  }
  std::vector<Crease> out;
  for (const EdgeTable::Edge& e : shape.table.edges) {
    if (e.count != 2) continue;
    const EdgeTable::Use &first = shape.table.use(e, 0), &second = shape.table.use(e, 1);
    Crease c;
    c.v = {shape.vertices[first.a][0], shape.vertices[first.b][0]};
    c.vt = {shape.vertices[first.a][1], shape.vertices[first.b][1]};
    c.triangles = {first.face, second.face};
    const std::vector<Vector3>& x = strips.points;
    c.angle = bend_over(x[c.v[0]], x[c.v[1]], x[apex(p.triangles[first.face], c.vt)],
                        x[apex(p.triangles[second.face], c.vt)]);
    const auto it = ruling.find({std::min(c.v[0], c.v[1]), std::max(c.v[0], c.v[1])});
    if (it != ruling.end()) c.ruling = it->second;
    out.push_back(c);
  }
  std::stable_sort(out.begin(), out.end(), [](const Crease& a, const Crease& b) {
    return static_cast<unsigned>(a.ruling) < static_cast<unsigned>(b.ruling);  // -1 goes last
  });
  return out;
}

std::vector<double> ruling_turns(const StripMesh& strips, int patch, const std::vector<Crease>& creases) {
  const StripMesh::Patch& p = strips.patches[patch];
  const std::vector<int> piece = pieces_of(p.triangles.size(), creases);
  std::vector<double> diagonals(p.triangles.size(), 0), turns(p.rulings.size(), 0);
  std::vector<int> rulings_at(p.triangles.size(), 0);
  for (const Crease& c : creases) {
    if (c.ruling < 0)
      diagonals[piece[c.triangles[0]]] += c.angle;
    else
      for (int t : c.triangles) ++rulings_at[piece[t]];
  }
  for (const Crease& c : creases) {
    if (c.ruling < 0) continue;
    turns[c.ruling] = c.angle;
    for (int t : c.triangles) turns[c.ruling] += diagonals[piece[t]] / rulings_at[piece[t]];
  }
  return turns;
}

std::vector<DrawnRuling> thinned_rulings(const std::vector<double>& turns, double step, double hidden) {
  std::vector<DrawnRuling> out;
  const int n = static_cast<int>(turns.size());
  for (int begin = 0; begin < n;) {
    int end = begin + 1;
    while (end < n && (turns[end] > 0) == (turns[begin] > 0)) ++end;
    if (step > 0) {
      mark_run(turns, begin, end, step, hidden, out);
    } else {
      const double total = std::accumulate(turns.begin() + begin, turns.begin() + end, 0.0);
      for (int i = begin; i < end && std::abs(total) >= hidden; ++i) out.push_back({i, turns[i]});
    }
    begin = end;
  }
  return out;
}

}  // namespace sheetform
