#include "sheetform/blueprint/reshape.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "sheetform/base/error.h"
#include "sheetform/blueprint/fold_lines.h"
#include "sheetform/strip/certificate.h"
#include "sheetform/strip/patch_shape.h"
#include "sheetform/strip/unfold.h"

namespace sheetform {
namespace {

using Edge = std::array<int, 2>;

Edge sorted(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

// Where each point goes: least squares over the planes around it, held back towards the mean normal.
std::vector<Vector3> moved_points(const StripMesh& m, double distance) {
  std::vector<Eigen::Matrix3d> normal_matrix(m.points.size(), Eigen::Matrix3d::Zero());
  std::vector<Vector3> sum(m.points.size(), Vector3::Zero());
  for (const StripMesh::Patch& patch : m.patches)
    for (const StripMesh::Triangle& t : patch.triangles) {
      const Vector3 n =
          (m.points[t.v[1]] - m.points[t.v[0]]).cross(m.points[t.v[2]] - m.points[t.v[0]]).stableNormalized();
      for (int k = 0; k < 3; ++k) {
        const Vector3 u = m.points[t.v[(k + 1) % 3]] - m.points[t.v[k]],
                      w = m.points[t.v[(k + 2) % 3]] - m.points[t.v[k]];
        const double angle = angle_between(u, w);
        normal_matrix[t.v[k]] += angle * n * n.transpose();
        sum[t.v[k]] += angle * n;
      }
    }
  std::vector<Vector3> out = m.points;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (sum[i].isZero()) continue;
    const double hold = 1e-3;  // of a full turn of planes: directions that no plane decides stay put
    const Vector3 mean = sum[i].normalized();
    Vector3 x = (normal_matrix[i] + hold * Eigen::Matrix3d::Identity()).ldlt().solve(sum[i] + hold * mean);
    if (x.norm() > 3) x *= 3 / x.norm();  // a spike's tip does not run away
    out[i] += distance * x;
  }
  return out;
}

// Unfolds a patch anew into the uvs that it has.
void unfold_again(StripMesh& m, const StripMesh::Patch& patch) {
  const PatchShape shape = shape_of(patch);
  std::vector<Vector3> points;
  for (const auto& [v, vt] : shape.vertices) points.push_back(m.points[v]);
  const std::vector<Vector2> flat = unfold(points, shape.faces);
  for (std::size_t i = 0; i < flat.size(); ++i) m.uvs[shape.vertices[i][1]] = flat[i];
}

// A patch that has passed through itself shows its inside where its outside was.
bool turned_over(const StripMesh& before, const StripMesh& after, const StripMesh::Patch& patch) {
  double agreement = 0, area = 0;
  for (const StripMesh::Triangle& t : patch.triangles) {
    const auto normal = [&](const StripMesh& m) -> Vector3 {
      return (m.points[t.v[1]] - m.points[t.v[0]]).cross(m.points[t.v[2]] - m.points[t.v[0]]);
    };
    agreement += normal(after).dot(normal(before).stableNormalized());
    area += normal(after).norm();
  }
  return agreement < 0.5 * area;
}

// --- splitting
// -----------------------------------------------------------------------------------------------------

// Triangles on the second side of an inner edge of a patch, as flags.
std::vector<char> second_side(const StripMesh::Patch& patch, const Edge& edge_vt) {
  const PatchShape shape = shape_of(patch);
  std::vector<std::vector<int>> next(patch.triangles.size());
  int start = -1;
  for (const EdgeTable::Edge& e : shape.table.edges) {
    if (e.count != 2) continue;
    const int f = shape.table.use(e, 0).face, g = shape.table.use(e, 1).face;
    if (sorted(shape.vertices[e.a][1], shape.vertices[e.b][1]) == sorted(edge_vt[0], edge_vt[1]))
      start = g;
    else
      next[f].push_back(g), next[g].push_back(f);
  }
  if (start < 0) throw Error(ErrorCode::kInternal, "a patch is to be split along an edge that it has not");
  std::vector<char> side(patch.triangles.size(), 0);
  std::vector<int> todo{start};
  side[start] = 1;
  while (!todo.empty()) {
    const int f = todo.back();
    todo.pop_back();
    for (int g : next[f])
      if (!std::exchange(side[g], 1)) todo.push_back(g);
  }
  return side;
}

// Corners stay corners; both ends of the cut become some.
void set_boundary(StripMesh::Patch& patch, const std::set<int>& corner_vt) {
  const PatchShape shape = shape_of(patch);
  patch.boundary = shape.loop_points();
  patch.boundary_vt = shape.loop_uvs();
  patch.corners.clear();
  for (std::size_t i = 0; i < patch.boundary_vt.size(); ++i)
    if (corner_vt.count(patch.boundary_vt[i])) patch.corners.push_back(static_cast<int>(i));
}

// Rulings that are inner edges of this patch.
std::vector<Edge> rulings_inside(const StripMesh::Patch& patch, const std::vector<Edge>& rulings) {
  std::set<Edge> inner;
  const PatchShape shape = shape_of(patch);
  for (const EdgeTable::Edge& e : shape.table.edges)
    if (e.count == 2) inner.insert(sorted(shape.vertices[e.a][0], shape.vertices[e.b][0]));
  std::vector<Edge> out;
  for (const Edge& r : rulings)
    if (inner.count(sorted(r[0], r[1]))) out.push_back(r);
  return out;
}

// Arches that pass one of these points end there now.
void split_arches_at(StripMesh& m, const Edge& points) {
  for (std::size_t a = 0; a < m.arches.size(); ++a) {
    std::vector<int>& v = m.arches[a].vertices;
    for (std::size_t i = 1; i + 1 < v.size(); ++i) {
      if (v[i] != points[0] && v[i] != points[1]) continue;
      StripMesh::Arch rest = m.arches[a];
      rest.vertices.assign(v.begin() + static_cast<std::ptrdiff_t>(i), v.end());
      v.resize(i + 1);
      m.arches.push_back(std::move(rest));  // looked at again in its turn
      break;
    }
  }
}

// Which patches every arch lies between, and the arches around every patch, from the boundaries alone.
void link_arches(StripMesh& m) {
  std::map<Edge, std::vector<int>> sides;
  std::map<Edge, int> arch_of;
  for (std::size_t p = 0; p < m.patches.size(); ++p)
    for (std::size_t i = 0; i < m.patches[p].boundary.size(); ++i)
      sides[sorted(m.patches[p].boundary[i], m.patches[p].boundary[(i + 1) % m.patches[p].boundary.size()])]
          .push_back(static_cast<int>(p));
  std::set<int> ends;
  for (std::size_t a = 0; a < m.arches.size(); ++a) {
    StripMesh::Arch& arch = m.arches[a];
    for (std::size_t i = 0; i + 1 < arch.vertices.size(); ++i)
      arch_of[sorted(arch.vertices[i], arch.vertices[i + 1])] = static_cast<int>(a);
    const std::vector<int>& between = sides.at(sorted(arch.vertices[0], arch.vertices[1]));
    arch.patches = {between[0], between.size() > 1 ? between[1] : -1};
    ends.insert({arch.vertices.front(), arch.vertices.back()});
  }
  for (StripMesh::Patch& patch : m.patches) {
    const std::size_t n = patch.boundary.size();
    std::size_t start = 0;
    while (start < n && !ends.count(patch.boundary[start])) ++start;
    if (start == n) start = 0;
    patch.arches.clear();
    for (std::size_t walked = 0; walked < n;) {
      patch.arches.push_back(
          arch_of.at(sorted(patch.boundary[(start + walked) % n], patch.boundary[(start + walked + 1) % n])));
      walked += m.arches[patch.arches.back()].vertices.size() - 1;
    }
  }
}

// How much too large the points are for the rectangle: above 1 they do not fit.
double excess(const Polygon& points, double width, double height) {
  const Placement turn = flat_turn(points);
  const Vector2 size = bounds_of(placed(points, turn)).size();
  const double lying = std::max(size.x() / width, size.y() / height),
               standing = std::max(size.y() / width, size.x() / height);
  return std::min(lying, standing);
}

Polygon outline_of(const StripMesh& m, const StripMesh::Patch& patch, const std::vector<char>* side,
                   char which) {
  Polygon points;
  for (std::size_t t = 0; t < patch.triangles.size(); ++t)
    if (!side || (*side)[t] == which)
      for (int vt : patch.triangles[t].vt) points.push_back(m.uvs[vt]);
  return points;
}

double area_of(const StripMesh& m, const StripMesh::Patch& patch, const std::vector<char>& side, char which) {
  double twice = 0;
  for (std::size_t t = 0; t < patch.triangles.size(); ++t) {
    const auto& vt = patch.triangles[t].vt;
    const Vector2 u = m.uvs[vt[1]] - m.uvs[vt[0]], w = m.uvs[vt[2]] - m.uvs[vt[0]];
    if (side[t] == which) twice += std::abs(u.x() * w.y() - u.y() * w.x());
  }
  return twice / 2;
}

// The inner edge whose larger half is smallest: by how far it is from fitting, then by area; rulings before
// diagonals. False where no cut brings a patch nearer to fitting and none takes a tenth of it away.
bool best_cut(const StripMesh& m, int patch, double width, double height, Edge& out) {
  const StripMesh::Patch& p = m.patches[patch];
  const double whole = excess(outline_of(m, p, nullptr, 0), width, height);
  const double area = area_of(m, p, std::vector<char>(p.triangles.size(), 0), 0);
  for (const bool rulings : {true, false}) {
    std::pair<double, double> best{1e300, 1e300};
    for (const Crease& c : creases_of(m, patch)) {
      if ((c.ruling >= 0) != rulings) continue;
      const std::vector<char> side = second_side(p, c.vt);
      const double larger = std::max(excess(outline_of(m, p, &side, 0), width, height),
                                     excess(outline_of(m, p, &side, 1), width, height));
      const double most = std::max(area_of(m, p, side, 0), area_of(m, p, side, 1));
      if (larger >= whole * (1 - 1e-9) && most > 0.9 * area) continue;
      const std::pair key{std::round(larger * 1e6), most};
      if (key < best) best = key, out = c.vt;
    }
    if (best.first < 1e300) return true;
  }
  return false;
}

// A triangle that does not fit makes every cut useless.
bool every_triangle_fits(const StripMesh& m, const StripMesh::Patch& patch, double width, double height) {
  return std::all_of(patch.triangles.begin(), patch.triangles.end(), [&](const StripMesh::Triangle& t) {
    return excess({m.uvs[t.vt[0]], m.uvs[t.vt[1]], m.uvs[t.vt[2]]}, width, height) <= 1;
  });
}

}  // namespace

StripMesh moved_surface(const StripMesh& strips, double distance, const std::vector<std::string>& labels,
                        double bbox_diagonal) {
  StripMesh out = strips;
  out.points = moved_points(strips, distance);
  std::string bad;
  for (std::size_t p = 0; p < out.patches.size(); ++p) {
    unfold_again(out, out.patches[p]);
    if (turned_over(strips, out, out.patches[p]) ||
        !check_patch(out, static_cast<int>(p), bbox_diagonal).empty())
      bad += (bad.empty() ? "" : ", ") + labels[p];
  }
  if (!bad.empty())
    throw Error(
        ErrorCode::kInvalidParameter, "at this thickness parts would overlap or vanish: " + bad, "thickness",
        "Use thinner material, a larger model, or let the middle of the material be the model's surface");
  return out;
}

void split_patch(StripMesh& m, int patch, const Edge& edge_vt) {
  const std::vector<char> side = second_side(m.patches[patch], edge_vt);
  StripMesh::Patch first = m.patches[patch], second = first;
  first.triangles.clear(), second.triangles.clear();
  std::set<int> corners;
  for (int k : m.patches[patch].corners) corners.insert(m.patches[patch].boundary_vt[k]);
  corners.insert({edge_vt[0], edge_vt[1]});
  std::map<int, int> copy;  // the second half gets its own uvs at the cut
  Edge cut{-1, -1};
  for (int vt : edge_vt) {
    copy[vt] = static_cast<int>(m.uvs.size());
    corners.insert(copy[vt]);
    m.uvs.push_back(Vector2(m.uvs[vt]));
  }
  for (std::size_t t = 0; t < side.size(); ++t) {
    StripMesh::Triangle triangle = m.patches[patch].triangles[t];
    for (int k = 0; k < 3; ++k) {
      if (triangle.vt[k] == edge_vt[0]) cut[0] = triangle.v[k];
      if (triangle.vt[k] == edge_vt[1]) cut[1] = triangle.v[k];
      if (side[t] && copy.count(triangle.vt[k])) triangle.vt[k] = copy.at(triangle.vt[k]);
    }
    (side[t] ? second : first).triangles.push_back(triangle);
  }
  for (StripMesh::Patch* half : {&first, &second}) {
    set_boundary(*half, corners);
    half->rulings = rulings_inside(*half, m.patches[patch].rulings);
    half->mirror_of = -1;
  }
  for (StripMesh::Patch& p : m.patches)
    if (p.mirror_of == patch) p.mirror_of = -1;
  m.patches[patch] = std::move(first);
  m.patches.push_back(std::move(second));
  split_arches_at(m, cut);
  m.arches.push_back({{cut[0], cut[1]}, {patch, static_cast<int>(m.patches.size()) - 1}, false});
  link_arches(m);
}

void split_to_fit(StripMesh& m, std::vector<std::string>& labels, double width, double height) {
  std::vector<int> root(m.patches.size());
  for (std::size_t p = 0; p < root.size(); ++p) root[p] = static_cast<int>(p);
  for (std::size_t p = 0; p < m.patches.size();) {
    if (excess(outline_of(m, m.patches[p], nullptr, 0), width, height) <= 1) {
      ++p;
      continue;
    }
    Edge cut{};
    if (m.patches.size() > 5000 || !every_triangle_fits(m, m.patches[p], width, height) ||
        !best_cut(m, static_cast<int>(p), width, height, cut))
      throw Error(ErrorCode::kInvalidParameter,
                  "part " + labels[root[p]] + " cannot be split into pieces that fit the sheet", "sheet",
                  "Choose a larger sheet or a smaller model");
    split_patch(m, static_cast<int>(p), cut);
    root.push_back(root[p]);
  }
  std::map<int, int> pieces, named;
  for (int r : root) ++pieces[r];
  const std::vector<std::string> whole = labels;
  labels.clear();
  for (int r : root) {
    std::string suffix;
    if (pieces[r] > 1)
      for (int i = named[r]++; i >= 0; i = i / 26 - 1)
        suffix.insert(suffix.begin(), static_cast<char>('a' + i % 26));
    labels.push_back(whole[r] + suffix);
  }
}

}  // namespace sheetform
