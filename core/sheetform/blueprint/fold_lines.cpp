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

// Half of the patch's area over the length of its only ruling: what lies on either side bends with it.
double half_width(const StripMesh::Patch& patch, const std::array<Vector2, 2>& ruling,
                  const std::vector<Vector2>& flat) {
  double twice = 0;
  for (const StripMesh::Triangle& t : patch.triangles) {
    const Vector2 u = flat[t.vt[1]] - flat[t.vt[0]], v = flat[t.vt[2]] - flat[t.vt[0]];
    twice += std::abs(u.x() * v.y() - u.y() * v.x());
  }
  return twice / 4 / std::max((ruling[1] - ruling[0]).norm(), 1e-300);
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
                               const std::vector<Vector2>& flat) {
  const auto lines = flat_rulings(creases, flat);
  const std::vector<double> turns = evened_turns(ruling_turns(strips, patch, creases));
  const auto middle = [&](std::size_t i) { return Vector2((lines[i][0] + lines[i][1]) / 2); };
  std::vector<double> width(lines.size()), radii(lines.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::size_t before = i > 0 ? i - 1 : i, after = std::min(i + 1, lines.size() - 1);
    width[i] = after > before ? (middle(after) - middle(before)).norm() / static_cast<double>(after - before)
                              : half_width(strips.patches[patch], lines[i], flat);
  }
  width = evened_turns(width);
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (std::abs(turns[i]) > 1e-9) radii[i] = width[i] / (std::abs(turns[i]) / kDegrees);
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
