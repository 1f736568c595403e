#include "sheetform/blueprint/fold_lines.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "sheetform/strip/patch_shape.h"

namespace sheetform {
namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846;
// Neighbouring rulings of a triangulated strip tend to bend to and fro; a sheet bends by what they come to
// together.
constexpr int kSmoothingPasses = 4;
constexpr double kHysteresis =
    0.1;  // of a step: keeps bends about a level from being drawn as a fold and its reverse

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

double flat_area(const StripMesh::Triangle& t, const std::vector<Vector2>& flat) {
  const Vector2 u = flat[t.vt[1]] - flat[t.vt[0]], v = flat[t.vt[2]] - flat[t.vt[0]];
  return std::abs(u.x() * v.y() - u.y() * v.x()) / 2;
}

// Mean widths of the pieces outside of the first and of the last ruling.
std::array<double, 2> end_widths(const StripMesh::Patch& patch, const std::vector<Crease>& creases,
                                 const std::vector<Vector2>& flat) {
  const std::vector<int> piece = pieces_of(patch.triangles.size(), creases);
  std::vector<double> area(piece.size(), 0);
  std::vector<int> rulings_at(piece.size(), 0);
  for (std::size_t t = 0; t < piece.size(); ++t) area[piece[t]] += flat_area(patch.triangles[t], flat);
  int rulings = 0;
  for (const Crease& c : creases)
    for (int t : c.triangles)
      if (c.ruling >= 0) ++rulings_at[piece[t]], ++rulings;
  std::array<double, 2> widths{0, 0};
  const Crease *first = &creases.front(), *last = first + rulings / 2 - 1;
  for (int side : {0, 1}) {
    const Crease& c = side == 0 ? *first : *last;
    const int outer = rulings_at[piece[c.triangles[side]]] == 1 ? side : 1 - side;
    if (rulings_at[piece[c.triangles[outer]]] == 1)
      widths[side] =
          area[piece[c.triangles[outer]]] / std::max((flat[c.vt[1]] - flat[c.vt[0]]).norm(), 1e-300);
  }
  return widths;
}

// How far along the patch the middle of each ruling lies.
std::vector<double> middles_along(const std::vector<std::array<Vector2, 2>>& lines) {
  std::vector<double> at(lines.size(), 0);
  for (std::size_t i = 1; i < lines.size(); ++i)
    at[i] = at[i - 1] + ((lines[i][0] + lines[i][1]) - (lines[i - 1][0] + lines[i - 1][1])).norm() / 2;
  return at;
}

// One pass of the binomial filter 1/4, 1/2, 1/4; what would leave at an end stays there, so the sum is kept.
std::vector<double> smoothed(const std::vector<double>& x) {
  std::vector<double> out(x.size(), 0);
  const std::size_t n = x.size();
  for (std::size_t i = 0; i < n; ++i) {
    out[i] += x[i] / 2;
    out[i > 0 ? i - 1 : i] += x[i] / 4;
    out[i + 1 < n ? i + 1 : i] += x[i] / 4;
  }
  return out;
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

std::vector<double> evened_turns(const std::vector<double>& turns) {
  std::vector<double> even = turns;
  for (int pass = 0; pass < kSmoothingPasses; ++pass) even = smoothed(even);
  return even;
}

std::vector<std::array<Vector2, 2>> flat_rulings(const std::vector<Crease>& creases,
                                                 const std::vector<Vector2>& flat) {
  std::vector<std::array<Vector2, 2>> out;
  for (const Crease& c : creases) {
    if (c.ruling < 0) continue;
    std::array<Vector2, 2> s{flat[c.vt[0]], flat[c.vt[1]]};
    if (!out.empty() && (s[0] - out.back()[0]).squaredNorm() + (s[1] - out.back()[1]).squaredNorm() >
                            (s[1] - out.back()[0]).squaredNorm() + (s[0] - out.back()[1]).squaredNorm())
      std::swap(s[0], s[1]);
    out.push_back(s);
  }
  return out;
}

std::vector<double> bend_radii(const StripMesh& strips, int patch, const std::vector<Crease>& creases,
                               const std::vector<Vector2>& flat, double reach) {
  const auto lines = flat_rulings(creases, flat);
  const std::vector<double> turns = ruling_turns(strips, patch, creases);
  std::vector<double> at = middles_along(lines), radii(lines.size(), std::numeric_limits<double>::infinity());
  if (lines.empty()) return radii;
  // Each ruling's share of the way, as far as halfway to its neighbours, and the turn up to there.
  const std::size_t n = lines.size();
  const auto [front, back] = end_widths(strips.patches[patch], creases, flat);
  std::vector<double> border{at[0] - front / 2}, turned{0};
  for (std::size_t i = 0; i < n; ++i) {
    border.push_back(i + 1 < n ? (at[i] + at[i + 1]) / 2 : at[i] + back / 2);
    turned.push_back(turned.back() + turns[i] / kDegrees);
  }
  const auto turned_up_to = [&](double x) {
    const std::size_t k = std::upper_bound(border.begin() + 1, border.end() - 1, x) - border.begin();
    const double share = border[k] - border[k - 1];
    return turned[k - 1] + (turned[k] - turned[k - 1]) * (share > 0 ? (x - border[k - 1]) / share : 1);
  };
  const double span = std::min(reach, border.back() - border.front());
  for (std::size_t i = 0; i < n; ++i) {
    const double wide = std::max(span, border[i + 1] - border[i]);
    const double from =
        std::clamp(at[i] - wide / 2, border.front(), std::max(border.front(), border.back() - wide));
    const double turn = std::abs(turned_up_to(from + wide) - turned_up_to(from));
    if (turn > 1e-9) radii[i] = wide / turn;
  }
  return radii;
}

std::vector<DrawnRuling> thinned_rulings(const std::vector<double>& turns, double step, double hidden) {
  std::vector<DrawnRuling> out;
  if (step <= 0) {
    for (std::size_t i = 0; i < turns.size(); ++i)
      if (std::abs(turns[i]) >= hidden) out.push_back({static_cast<int>(i), turns[i]});
    return out;
  }
  const std::vector<double> even = evened_turns(turns);
  const double threshold = std::max((0.5 + kHysteresis) * step, hidden);
  double open = 0;  // bending that no drawn ruling stands for yet
  for (std::size_t i = 0; i < even.size(); ++i) {
    open += even[i];
    if (std::abs(open) < threshold) continue;
    const double angle =
        std::copysign(step * std::max(1.0, std::floor(std::abs(open) / step + 0.5 - kHysteresis)), open);
    out.push_back({static_cast<int>(i), angle});
    open -= angle;
  }
  return out;
}

}  // namespace sheetform
