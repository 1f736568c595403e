// Small shapes with known answers, made by code: the oracles of the unit and pipeline tests.
#pragma once
#include <array>
#include <cmath>
#include <functional>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform::shapes {

/// A grid of (nu x nv) quads, split into triangles with alternating diagonals, mapped by f(u, v), u and v in
/// [0, 1]; wrap_u / wrap_v glue opposite sides. Oriented so that (d/du) x (d/dv) points outside.
struct Grid {
  int nu = 20, nv = 20;
  bool wrap_u = false, wrap_v = false;
};
inline TriangleSoup grid(const Grid& g, const std::function<Vector3(double, double)>& f) {
  const int cu = g.wrap_u ? g.nu : g.nu + 1, cv = g.wrap_v ? g.nv : g.nv + 1;
  TriangleSoup soup;
  for (int j = 0; j < cv; ++j)
    for (int i = 0; i < cu; ++i) soup.points.push_back(f(double(i) / g.nu, double(j) / g.nv));
  auto id = [&](int i, int j) { return (j % cv) * cu + i % cu; };
  for (int j = 0; j < g.nv; ++j)
    for (int i = 0; i < g.nu; ++i) {
      const int a = id(i, j), b = id(i + 1, j), c = id(i + 1, j + 1), d = id(i, j + 1);
      if ((i + j) % 2 == 0) {
        soup.faces.push_back({a, b, c}), soup.faces.push_back({a, c, d});
      } else {
        soup.faces.push_back({a, b, d}), soup.faces.push_back({b, c, d});
      }
    }
  return soup;
}

constexpr double kPi = 3.14159265358979323846;

inline TriangleSoup plane(int n, double size = 1) {
  return grid({n, n}, [=](double u, double v) { return Vector3(size * u, size * v, 0); });
}
inline TriangleSoup torus(int nu, int nv, double R = 1, double r = 0.4) {
  return grid({nu, nv, true, true}, [=](double u, double v) {
    const double a = 2 * kPi * u, b = 2 * kPi * v;
    return Vector3((R + r * std::cos(b)) * std::cos(a), (R + r * std::cos(b)) * std::sin(a), r * std::sin(b));
  });
}
/// Open tube of radius r along z.
inline TriangleSoup cylinder(int nu, int nv, double r = 1, double height = 2) {
  return grid({nu, nv, true, false}, [=](double u, double v) {
    return Vector3(r * std::cos(2 * kPi * u), r * std::sin(2 * kPi * u), height * v);
  });
}
/// A quarter of a cylinder: a developable rectangle.
inline TriangleSoup cylinder_patch(int nu, int nv, double r = 1, double height = 1, double angle = kPi / 2) {
  return grid({nu, nv}, [=](double u, double v) {
    return Vector3(r * std::cos(angle * u), r * std::sin(angle * u), height * v);
  });
}
/// z = k * x * y over [-1, 1]^2: doubly ruled.
inline TriangleSoup saddle(int n, double k = 0.5) {
  return grid({n, n}, [=](double u, double v) {
    const double x = 2 * u - 1, y = 2 * v - 1;
    return Vector3(x, y, k * x * y);
  });
}
inline TriangleSoup helicoid(int nu, int nv, double width = 1, double pitch = 1, double turns = 0.5) {
  return grid({nu, nv}, [=](double u, double v) {
    const double x = width * (2 * u - 1), a = 2 * kPi * turns * v;
    return Vector3(x * std::cos(a), x * std::sin(a), pitch * v);
  });
}
/// The unit square without every second bar of `width` of its `cells` along one side: square teeth.
TriangleSoup comb(int cells, int width);
/// Sphere as a cube projected to it: n x n quads on each of six sides, points shared.
TriangleSoup sphere(int n, double radius = 1);
/// Axis-parallel box with n x n quads a side.
TriangleSoup box(int n, const Vector3& size);
/// Closed cylinder: wall and two caps with creases of 90 degrees.
TriangleSoup closed_cylinder(int around, int along, double r = 1, double height = 2);
/// Where f is zero in the box -half .. half, by marching tetrahedra over a grid of n points a side: creases
/// of f come out as chamfers with steps, as volumes turned into meshes have them. Faces look to larger f.
TriangleSoup isosurface(const std::function<double(const Vector3&)>& f, const Vector3& half,
                        const std::array<int, 3>& n);

}  // namespace sheetform::shapes
