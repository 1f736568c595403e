// S3 and S6 to S9 of one patch.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "sheetform/strip/certificate_checks.h"
#include "sheetform/strip/outline.h"

namespace sheetform::certificate {
namespace {

constexpr double kPi = 3.14159265358979323846;

std::string edge_name(int a, int b) { return "v" + std::to_string(a) + "-v" + std::to_string(b); }

double patch_size(const StripMesh& r, const StripMesh::Patch& patch) {
  Eigen::AlignedBox3d box;
  for (const StripMesh::Triangle& t : patch.triangles)
    for (int i : t.v) box.extend(r.points[i]);
  return box.isEmpty() ? 0.0 : box.diagonal().norm();
}

double flat_area(const StripMesh& r, const StripMesh::Triangle& t) {
  return cross(r.uvs[t.vt[1]] - r.uvs[t.vt[0]], r.uvs[t.vt[2]] - r.uvs[t.vt[0]]) / 2;
}

// Points on a seam of the patch with itself: on edges whose two faces are not glued in the plane.
std::vector<int> seam_points(const PatchShape& shape) {
  std::vector<std::array<int, 2>> rim;
  for (const EdgeTable::Edge& e : shape.table.edges) {
    if (e.count != 1) continue;
    const int a = shape.vertices[e.a][0], b = shape.vertices[e.b][0];
    rim.push_back({std::min(a, b), std::max(a, b)});
  }
  std::sort(rim.begin(), rim.end());
  std::vector<int> points;
  for (std::size_t i = 1; i < rim.size(); ++i)
    if (rim[i] == rim[i - 1]) points.insert(points.end(), rim[i].begin(), rim[i].end());
  std::sort(points.begin(), points.end());
  return points;
}

// One uv for each point, several only on a seam of the patch with itself.
void check_correspondence(const StripMesh& r, int patch, const PatchShape& shape, std::vector<Defect>& out) {
  const std::vector<int> seam = seam_points(shape);
  std::vector<std::array<int, 2>> by_uv;
  for (std::size_t i = 0; i < shape.vertices.size(); ++i) {
    const auto& [v, t] = shape.vertices[i];
    by_uv.push_back({t, v});
    if (i == 0 || shape.vertices[i - 1][0] != v || std::binary_search(seam.begin(), seam.end(), v)) continue;
    out.push_back({"S7", "v" + std::to_string(v) + " has two vt but lies on no seam of its patch with itself",
                   patch, r.points[v]});
  }
  std::sort(by_uv.begin(), by_uv.end());
  for (std::size_t i = 1; i < by_uv.size(); ++i)
    if (by_uv[i][0] == by_uv[i - 1][0])
      out.push_back({"S7", "vt " + std::to_string(by_uv[i][0]) + " stands for two points", patch,
                     r.points[by_uv[i][1]]});
}

void check_turned_over(const StripMesh& r, int patch, double diagonal, std::vector<Defect>& out) {
  for (const StripMesh::Triangle& t : r.patches[patch].triangles) {
    if (flat_area(r, t) > 0) continue;
    if (smallest_height(t.v, r.points) <= kDegenerate * diagonal) continue;  // S9 says so
    out.push_back({"S7", "a triangle is turned over or flat in the layout", patch, r.points[t.v[0]]});
  }
}

// A full turn at a vertex of the outline folds the outline onto itself there.
void check_angles(const StripMesh& r, int patch, const PatchShape& shape, std::vector<Defect>& out) {
  std::vector<double> angle(shape.vertices.size(), 0);
  for (const Triple& f : shape.faces)
    for (int k = 0; k < 3; ++k) {
      const Vector2& at = r.uvs[shape.vertices[f[k]][1]];
      const Vector2 u = r.uvs[shape.vertices[f[(k + 1) % 3]][1]] - at,
                    w = r.uvs[shape.vertices[f[(k + 2) % 3]][1]] - at;
      angle[f[k]] += std::atan2(std::abs(cross(u, w)), u.dot(w));
    }
  for (int i : shape.loop)
    if (angle[i] >= 2 * kPi - kFullTurn)
      out.push_back({"S7", "360 degrees or more of the part meet at v" + std::to_string(shape.vertices[i][0]),
                     patch, r.points[shape.vertices[i][0]]});
}

void check_outline(const StripMesh& r, int patch, const PatchShape& shape, std::vector<Defect>& out) {
  std::vector<Vector2> outline;
  Eigen::AlignedBox2d box;
  for (int i : shape.loop) outline.push_back(r.uvs[shape.vertices[i][1]]), box.extend(outline.back());
  const Contact contact = self_contact(outline, kContact * box.diagonal().norm());
  if (contact.i >= 0) {
    const std::size_t n = shape.loop.size();
    const auto point = [&](int i) { return shape.vertices[shape.loop[static_cast<std::size_t>(i) % n]][0]; };
    out.push_back({"S7",
                   "outline edges " + edge_name(point(contact.i), point(contact.i + 1)) + " and " +
                       edge_name(point(contact.j), point(contact.j + 1)) + " meet",
                   patch, r.points[point(contact.i)]});
  }
  double sum = 0;
  for (const StripMesh::Triangle& t : r.patches[patch].triangles) sum += std::abs(flat_area(r, t));
  if (out.empty() && !(std::abs(sum - std::abs(signed_area(outline))) <= kArea * sum))
    out.push_back({"S7", "the triangles' areas do not sum to the outline's", patch, place_of(r, patch)});
}

double distance_from_plane(const StripMesh& r, const PatchShape& shape) {
  Vector3 center = Vector3::Zero();
  for (const auto& [v, t] : shape.vertices)
    center += r.points[v] / static_cast<double>(shape.vertices.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& [v, t] : shape.vertices)
    spread += (r.points[v] - center) * (r.points[v] - center).transpose();
  const Vector3 normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
  double worst = 0;
  for (const auto& [v, t] : shape.vertices)
    worst = std::max(worst, std::abs(normal.dot(r.points[v] - center)));
  return worst;
}

// Inner edges of the patch cut open by point, ascending; a seam with itself is none.
std::vector<std::array<int, 2>> inner_edges(const PatchShape& shape) {
  std::vector<std::array<int, 2>> inner;
  for (const EdgeTable::Edge& e : shape.table.edges) {
    const int a = shape.vertices[e.a][0], b = shape.vertices[e.b][0];
    if (e.count == 2) inner.push_back({std::min(a, b), std::max(a, b)});
  }
  std::sort(inner.begin(), inner.end());
  return inner;
}

}  // namespace

Vector3 place_of(const StripMesh& r, int patch) {
  const auto& triangles = r.patches[patch].triangles;
  return triangles.empty() ? Vector3::Zero() : r.points[triangles[triangles.size() / 2].v[0]];
}

void append(std::vector<Defect>& to, std::vector<Defect> more) {
  to.insert(to.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

std::vector<Defect> check_disk(const StripMesh& r, int patch, const PatchShape& shape) {
  const auto defect = [&](const std::string& text) {
    return std::vector<Defect>{{"S3", text, patch, place_of(r, patch)}};
  };
  const Topology& t = shape.topology;
  if (t.faces == 0) return defect("the patch has no faces");
  if (!shape.disk)
    return defect("the patch is no disk: " + std::to_string(t.components) + " pieces, " +
                  std::to_string(t.border_loops) + " border loops, chi " + std::to_string(t.euler()) +
                  (t.manifold() ? "" : ", not manifold") +
                  (t.oriented() ? "" : ", faces oriented against each other"));
  if (!shape.inner.empty())
    return defect("the patch has an inner vertex, v" +
                  std::to_string(shape.vertices[shape.inner.front()][0]));
  if (!shape.tree) return defect("the patch's dual graph is no tree");
  return {};
}

std::vector<Defect> check_isometry(const StripMesh& r, int patch, double* worst) {
  std::vector<Defect> out;
  const double size = patch_size(r, r.patches[patch]);
  double largest = 0;
  std::array<int, 2> where{-1, -1};
  for (const StripMesh::Triangle& t : r.patches[patch].triangles)
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3;
      const double solid = (r.points[t.v[k]] - r.points[t.v[l]]).norm(),
                   flat = (r.uvs[t.vt[k]] - r.uvs[t.vt[l]]).norm();
      const double error = size > 0 ? std::abs(flat - solid) / size : 0;
      if (error > largest) largest = error, where = {t.v[k], t.v[l]};
    }
  if (worst) *worst = std::max(*worst, largest);
  if (!(largest <= kIsometry))
    out.push_back({"S6",
                   "edge " + edge_name(where[0], where[1]) + " has another length in the layout: off by " +
                       std::to_string(largest * 1e6) + " millionths of the patch's size",
                   patch, r.points[where[0]]});
  return out;
}

std::vector<Defect> check_flat(const StripMesh& r, int patch, const PatchShape& shape, double diagonal) {
  std::vector<Defect> out;
  check_correspondence(r, patch, shape, out);
  check_turned_over(r, patch, diagonal, out);
  if (!shape.disk) return out;  // S3 says so; there is no outline to look at
  check_angles(r, patch, shape, out);
  check_outline(r, patch, shape, out);
  return out;
}

std::vector<Defect> check_rulings(const StripMesh& r, int patch, const PatchShape& shape) {
  std::vector<Defect> out;
  const auto& rulings = r.patches[patch].rulings;
  const auto inner = inner_edges(shape);
  std::vector<int> inside;
  for (int i : shape.inner) inside.push_back(shape.vertices[i][0]);
  std::vector<std::array<int, 2>> seen;
  for (const auto& ruling : rulings) {
    const int a = ruling[0], b = ruling[1];  // not bound by name: Clang 14 captures no such names
    const std::array<int, 2> edge{std::min(a, b), std::max(a, b)};
    const auto fault = [&](const char* text) {
      out.push_back({"S8", "ruling " + edge_name(a, b) + text, patch, r.points[a]});
    };
    if (!std::binary_search(inner.begin(), inner.end(), edge)) fault(" is no inner edge of its patch");
    if (std::count(inside.begin(), inside.end(), a) + std::count(inside.begin(), inside.end(), b))
      fault(" ends inside the patch");
    seen.push_back(edge);
  }
  std::sort(seen.begin(), seen.end());
  if (const auto it = std::adjacent_find(seen.begin(), seen.end()); it != seen.end())
    out.push_back(
        {"S8", "ruling " + edge_name((*it)[0], (*it)[1]) + " is listed twice", patch, r.points[(*it)[0]]});
  if (!rulings.empty() || shape.topology.faces <= 2) return out;
  if (distance_from_plane(r, shape) > kPlanar * patch_size(r, r.patches[patch]))
    out.push_back({"S8", "a curved patch has no rulings", patch, place_of(r, patch)});
  return out;
}

std::vector<Defect> check_triangles(const StripMesh& r, int patch, double diagonal) {
  std::vector<Defect> out;
  for (const StripMesh::Triangle& t : r.patches[patch].triangles) {
    if (t.v[0] == t.v[1] || t.v[1] == t.v[2] || t.v[2] == t.v[0])
      out.push_back({"S9", "a triangle names v" + std::to_string(t.v[t.v[0] == t.v[1] ? 0 : 2]) + " twice",
                     patch, r.points[t.v[0]]});
    else if (!(smallest_height(t.v, r.points) > kDegenerate * diagonal))
      out.push_back({"S9",
                     "triangle v" + std::to_string(t.v[0]) + " v" + std::to_string(t.v[1]) + " v" +
                         std::to_string(t.v[2]) + " has no area",
                     patch, r.points[t.v[0]]});
  }
  return out;
}

}  // namespace sheetform::certificate
