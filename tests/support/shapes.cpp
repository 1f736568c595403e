#include "support/shapes.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>
#include <vector>

namespace sheetform::shapes {
namespace {

// The surface of the cube [-1,1]^3 with n x n quads a side, oriented outward.
TriangleSoup cube_surface(int n) {
  TriangleSoup soup;
  std::map<std::array<int, 3>, int> ids;
  auto id = [&](const std::array<int, 3>& key) {
    const auto [it, fresh] = ids.emplace(key, static_cast<int>(soup.points.size()));
    if (fresh) soup.points.emplace_back(2.0 * key[0] / n - 1, 2.0 * key[1] / n - 1, 2.0 * key[2] / n - 1);
    return it->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side <= n; side += n)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          auto at = [&](int u, int v) {
            std::array<int, 3> key{};
            key[axis] = side, key[(axis + 1) % 3] = u, key[(axis + 2) % 3] = v;
            return id(key);
          };
          int a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
          if (side == 0) std::swap(b, d);
          soup.faces.push_back({a, b, c});
          soup.faces.push_back({a, c, d});
        }
  return soup;
}

}  // namespace

TriangleSoup comb(int cells, int width) {
  const TriangleSoup whole = plane(cells);
  TriangleSoup soup;
  std::vector<int> id(whole.points.size(), -1);
  for (std::array<int, 3> f : whole.faces) {
    const Vector3 middle = (whole.points[f[0]] + whole.points[f[1]] + whole.points[f[2]]) / 3;
    const auto column = static_cast<int>(middle.x() * cells), row = static_cast<int>(middle.y() * cells);
    if (row < width && column / width % 2 == 1) continue;
    for (int& v : f) {
      if (id[v] < 0) id[v] = static_cast<int>(soup.points.size()), soup.points.push_back(whole.points[v]);
      v = id[v];
    }
    soup.faces.push_back(f);
  }
  return soup;
}

TriangleSoup sphere(int n, double radius) {
  TriangleSoup soup = cube_surface(n);
  for (Vector3& p : soup.points) {
    for (int k = 0; k < 3; ++k) p[k] = std::tan(p[k] * kPi / 4);  // evens out the spacing
    p = p.normalized() * radius;
  }
  return soup;
}

TriangleSoup box(int n, const Vector3& size) {
  TriangleSoup soup = cube_surface(n);
  for (Vector3& p : soup.points) p = (p.array() * size.array() / 2).matrix();
  return soup;
}

TriangleSoup closed_cylinder(int around, int along, double r, double height) {
  const int rings = std::max(2, around / 6);
  TriangleSoup soup;
  // Bottom centre, bottom rings outwards, wall rings upwards, top rings inwards, top centre.
  std::vector<std::pair<double, double>> profile;  // radius, z
  for (int i = 1; i <= rings; ++i) profile.emplace_back(r * i / rings, 0);
  for (int i = 1; i <= along; ++i) profile.emplace_back(r, height * i / along);
  for (int i = rings - 1; i >= 1; --i) profile.emplace_back(r * i / rings, height);
  soup.points.emplace_back(0, 0, 0);
  for (const auto& [radius, z] : profile)
    for (int k = 0; k < around; ++k)
      soup.points.emplace_back(radius * std::cos(2 * kPi * k / around),
                               radius * std::sin(2 * kPi * k / around), z);
  soup.points.emplace_back(0, 0, height);
  const int last = static_cast<int>(soup.points.size()) - 1, m = static_cast<int>(profile.size());
  auto at = [&](int ring, int k) { return 1 + ring * around + k % around; };
  for (int k = 0; k < around; ++k) {
    soup.faces.push_back({0, at(0, k + 1), at(0, k)});
    soup.faces.push_back({last, at(m - 1, k), at(m - 1, k + 1)});
    for (int ring = 0; ring + 1 < m; ++ring) {
      const int a = at(ring, k), b = at(ring, k + 1), c = at(ring + 1, k + 1), d = at(ring + 1, k);
      soup.faces.push_back({a, b, c});
      soup.faces.push_back({a, c, d});
    }
  }
  return soup;
}

TriangleSoup isosurface(const std::function<double(const Vector3&)>& f, const Vector3& half,
                        const std::array<int, 3>& n) {
  TriangleSoup soup;
  std::vector<Vector3> place;
  std::vector<double> value;
  for (int x = 0; x < n[0]; ++x)
    for (int y = 0; y < n[1]; ++y)
      for (int z = 0; z < n[2]; ++z) {
        const Eigen::Array3d at(x, y, z), last(n[0] - 1, n[1] - 1, n[2] - 1);
        place.push_back(half.array() * (2 * at / last - 1));
        value.push_back(f(place.back()));
      }
  std::map<std::pair<int, int>, int> crossing;
  const auto cross = [&](int a, int b) {
    const auto [it, fresh] = crossing.emplace(std::minmax(a, b), static_cast<int>(soup.points.size()));
    if (fresh) {
      const auto [lo, hi] = it->first;
      const double t = std::clamp(value[lo] / (value[lo] - value[hi]), 0.02, 0.98);
      soup.points.push_back(place[lo] + t * (place[hi] - place[lo]));
    }
    return it->second;
  };
  const auto add = [&](int a, int b, int c, const Vector3& outwards) {
    const Vector3 normal = (soup.points[b] - soup.points[a]).cross(soup.points[c] - soup.points[a]);
    if (normal.dot(outwards) < 0) std::swap(b, c);
    soup.faces.push_back({a, b, c});
  };
  const auto in_tetrahedron = [&](const std::array<int, 4>& corners) {
    std::vector<int> in, out;
    for (int c : corners) (value[c] < 0 ? in : out).push_back(c);
    if (in.empty() || out.empty()) return;
    Vector3 outwards = Vector3::Zero();
    for (int a : in)
      for (int b : out) outwards += place[b] - place[a];
    if (in.size() == 2) {
      const int a = cross(in[0], out[0]), b = cross(in[0], out[1]), c = cross(in[1], out[1]);
      add(a, b, c, outwards), add(a, c, cross(in[1], out[0]), outwards);
    } else {
      const auto& [tip, others] = in.size() == 1 ? std::pair(in[0], out) : std::pair(out[0], in);
      add(cross(tip, others[0]), cross(tip, others[1]), cross(tip, others[2]), outwards);
    }
  };
  const auto id = [&](int x, int y, int z) { return (x * n[1] + y) * n[2] + z; };
  for (int x = 0; x + 1 < n[0]; ++x)
    for (int y = 0; y + 1 < n[1]; ++y)
      for (int z = 0; z + 1 < n[2]; ++z) {
        const int a = id(x, y, z), g = id(x + 1, y + 1, z + 1);
        const std::array<int, 6> around{id(x + 1, y, z),     id(x + 1, y + 1, z), id(x, y + 1, z),
                                        id(x, y + 1, z + 1), id(x, y, z + 1),     id(x + 1, y, z + 1)};
        for (int k = 0; k < 6; ++k) in_tetrahedron({a, around[k], around[(k + 1) % 6], g});
      }
  return soup;
}

}  // namespace sheetform::shapes
