#include "support/strip_shapes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "sheetform/strip/patch_shape.h"
#include "support/shapes.h"

namespace sheetform::shapes {
namespace {

using Edge = std::array<int, 2>;
Edge sorted(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

// Third corner of a triangle over the flat edge a -> b, to the left of it.
Vector2 third_corner(const Vector2& a, const Vector2& b, const Vector3& pa, const Vector3& pb,
                     const Vector3& pc) {
  const Vector3 x = (pb - pa).normalized();
  const double along = (pc - pa).dot(x), off = (pc - pa - along * x).norm();
  const Vector2 u = (b - a).normalized();
  return a + along * u + off * Vector2(-u.y(), u.x());
}

}  // namespace

void StripBuilder::unfold(const std::vector<std::array<int, 3>>& chain, StripMesh::Patch& patch) {
  const std::vector<Vector3>& p = mesh_.points;
  std::vector<Vector2>& uv = mesh_.uvs;
  std::map<int, int> last;  // point -> uv, of the triangle before
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const auto& f = chain[i];
    std::array<int, 3> vt{-1, -1, -1};
    int fresh = -1;
    for (int k = 0; k < 3; ++k) {
      const auto it = last.find(f[k]);
      if (it != last.end())
        vt[k] = it->second;
      else
        fresh = k;
    }
    if (i == 0) {
      const int base = static_cast<int>(uv.size());
      uv.push_back(Vector2::Zero());
      uv.push_back({(p[f[1]] - p[f[0]]).norm(), 0});
      uv.push_back(third_corner(uv[base], uv[base + 1], p[f[0]], p[f[1]], p[f[2]]));
      vt = {base, base + 1, base + 2};
    } else {
      const int a = (fresh + 1) % 3, b = (fresh + 2) % 3;
      uv.push_back(third_corner(uv[vt[a]], uv[vt[b]], p[f[a]], p[f[b]], p[f[fresh]]));
      vt[fresh] = static_cast<int>(uv.size()) - 1;
    }
    patch.triangles.push_back({f, vt});
    last.clear();
    for (int k = 0; k < 3; ++k) last[f[k]] = vt[k];
  }
}

int StripBuilder::add(const std::vector<std::array<int, 3>>& chain, const std::vector<int>& corners,
                      const std::vector<std::array<int, 2>>& rulings, int component) {
  StripMesh::Patch patch;
  unfold(chain, patch);
  patch.rulings = rulings;
  patch.component = component;
  mesh_.patches.push_back(std::move(patch));
  corners_of_.push_back(corners);
  return static_cast<int>(mesh_.patches.size()) - 1;
}

int StripBuilder::add_strip(const std::vector<int>& left, const std::vector<int>& right,
                            const std::vector<int>& corners, int component) {
  std::vector<std::array<int, 3>> chain;
  std::vector<std::array<int, 2>> rulings;
  for (std::size_t i = 0; i + 1 < left.size(); ++i) {
    if (i > 0) rulings.push_back({left[i], right[i]});
    chain.push_back({left[i], right[i], right[i + 1]});
    chain.push_back({left[i], right[i + 1], left[i + 1]});
  }
  return add(chain, corners, rulings, component);
}

StripMesh StripBuilder::finish() {
  std::map<Edge, std::vector<int>>
      sides;  // patches at each edge of a patch's border; twice the same on its own seam
  std::vector<std::vector<int>> loops;
  for (StripMesh::Patch& patch : mesh_.patches) {
    loops.push_back(shape_of(patch).loop_points());
    patch.boundary = loops.back();
    fill_boundary_vt(patch);
    for (std::size_t i = 0; i < loops.back().size(); ++i)
      sides[sorted(loops.back()[i], loops.back()[(i + 1) % loops.back().size()])].push_back(
          static_cast<int>(loops.size()) - 1);
  }
  std::map<int, std::vector<int>> around;  // point -> its neighbours along patch borders
  for (const auto& [e, patches] : sides) around[e[0]].push_back(e[1]), around[e[1]].push_back(e[0]);
  std::set<int> nodes;
  for (const auto& [v, neighbours] : around)
    if (neighbours.size() != 2) nodes.insert(v);
  for (std::size_t p = 0; p < loops.size(); ++p) nodes.insert(corners_of_[p].begin(), corners_of_[p].end());
  std::map<Edge, int> arch_of;
  const auto trace = [&](int from, int to) {
    if (arch_of.count(sorted(from, to))) return;
    StripMesh::Arch arch;
    const std::vector<int>& between = sides[sorted(from, to)];
    arch.patches = {between[0], between.size() > 1 ? between[1] : -1};
    arch.vertices = {from};
    int a = from, b = to;
    while (true) {
      arch_of[sorted(a, b)] = static_cast<int>(mesh_.arches.size());
      arch.vertices.push_back(b);
      if (nodes.count(b) || b == from) break;
      const int next = around[b][0] == a ? around[b][1] : around[b][0];
      a = b, b = next;
    }
    mesh_.arches.push_back(std::move(arch));
  };
  for (int v : nodes)
    for (int w : around[v]) trace(v, w);
  for (const auto& [e, patches] : sides) trace(e[0], e[1]);
  for (std::size_t p = 0; p < loops.size(); ++p) {
    const std::vector<int>& loop = loops[p];
    StripMesh::Patch& patch = mesh_.patches[p];
    for (std::size_t i = 0; i < loop.size(); ++i)
      if (std::count(corners_of_[p].begin(), corners_of_[p].end(), loop[i]))
        patch.corners.push_back(static_cast<int>(i));
    std::size_t start = 0;
    while (start < loop.size() && !nodes.count(loop[start])) ++start;
    if (start == loop.size()) start = 0;
    for (std::size_t walked = 0; walked < loop.size();) {
      const int a = loop[(start + walked) % loop.size()], b = loop[(start + walked + 1) % loop.size()];
      patch.arches.push_back(arch_of[sorted(a, b)]);
      walked += mesh_.arches[patch.arches.back()].vertices.size() - 1;
    }
  }
  return std::move(mesh_);
}

StripMesh cube_faces() {
  std::vector<Vector3> p;
  for (int i = 0; i < 8; ++i) p.push_back(Vector3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
  StripBuilder b(std::move(p));
  for (const std::array<int, 4>& q :
       {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
    b.add({{q[0], q[1], q[2]}, {q[0], q[2], q[3]}}, {q[0], q[1], q[2], q[3]}, {});
  return b.finish();
}

StripMesh tube(int n, double radius, double height) {
  std::vector<Vector3> p;
  std::vector<int> top, bottom;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * kPi * i / n;
    p.emplace_back(radius * std::cos(a), radius * std::sin(a), 0);
    p.emplace_back(radius * std::cos(a), radius * std::sin(a), height);
  }
  for (int i = 0; i <= n; ++i) bottom.push_back(2 * (i % n)), top.push_back(2 * (i % n) + 1);
  StripBuilder b(std::move(p));
  b.add_strip(top, bottom, {0, 1});
  return b.finish();
}

StripMesh two_leaves(double degrees, double bow, int n) {
  const double t = degrees * kPi / 180;
  std::vector<Vector3> p;
  std::vector<std::vector<int>> line(3);
  for (int side = -1; side <= 1; ++side)
    for (int i = 0; i <= n; ++i) {
      const double x = double(i) / n, z = bow * x * (1 - x);
      line[side + 1].push_back(static_cast<int>(p.size()));
      p.push_back(side < 0    ? Vector3(2 * x, -1, z)
                  : side == 0 ? Vector3(2 * x, 0, z)
                              : Vector3(2 * x, std::cos(t), z - std::sin(t)));
    }
  StripBuilder b(std::move(p));
  for (int k = 0; k < 2; ++k)
    b.add_strip(line[k + 1], line[k],
                {line[k].front(), line[k].back(), line[k + 1].front(), line[k + 1].back()});
  return b.finish();
}

StripMesh cone(int n, double radius, double height) {
  std::vector<Vector3> p{{0, 0, height}};
  std::vector<std::array<int, 3>> chain;
  std::vector<std::array<int, 2>> rulings;
  for (int i = 0; i < n; ++i) {
    p.emplace_back(radius * std::cos(2 * kPi * i / n), radius * std::sin(2 * kPi * i / n), 0);
    chain.push_back({0, 1 + i, 1 + (i + 1) % n});
    if (i > 0) rulings.push_back({0, 1 + i});
  }
  StripBuilder b(std::move(p));
  b.add(chain, {0, 1}, rulings);
  return b.finish();
}

StripMesh torus_pieces(int strips, int pieces, int n, double R, double r) {
  const int around = pieces * n;
  std::vector<Vector3> p;
  for (int j = 0; j < strips; ++j)
    for (int i = 0; i < around; ++i) {
      const double a = 2 * kPi * i / around, b = 2 * kPi * j / strips;
      p.emplace_back((R + r * std::cos(b)) * std::cos(a), (R + r * std::cos(b)) * std::sin(a),
                     r * std::sin(b));
    }
  StripBuilder builder(std::move(p));
  const auto id = [&](int i, int j) { return (j % strips) * around + i % around; };
  for (int j = 0; j < strips; ++j)
    for (int k = 0; k < pieces; ++k) {
      std::vector<int> low, high;
      for (int i = k * n; i <= (k + 1) * n; ++i) low.push_back(id(i, j)), high.push_back(id(i, j + 1));
      builder.add_strip(high, low, {low.front(), low.back(), high.front(), high.back()});
    }
  return builder.finish();
}

StripMesh torus_bands(int strips, int n, double R, double r) { return torus_pieces(strips, 1, n, R, r); }

TriangleSoup soup_of(const StripMesh& strips) {
  TriangleSoup soup;
  soup.points = strips.points;
  for (const StripMesh::Patch& patch : strips.patches)
    for (const StripMesh::Triangle& t : patch.triangles) soup.faces.push_back(t.v);
  return soup;
}

}  // namespace sheetform::shapes
