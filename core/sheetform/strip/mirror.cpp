#include "sheetform/strip/mirror.h"

#include <algorithm>
#include <numeric>

namespace sheetform {
namespace {

std::vector<char> points_on_plane(const StripMesh& half) {
  std::vector<char> on(half.points.size(), 0);
  for (const StripMesh::Arch& a : half.arches)
    if (a.on_plane)
      for (int v : a.vertices) on[v] = 1;
  return on;
}

// The same loop from the same start the other way around, which is counter-clockwise for the image.
std::vector<int> turned_loop(const std::vector<int>& loop) {
  std::vector<int> turned = loop;
  if (!turned.empty()) std::reverse(turned.begin() + 1, turned.end());
  return turned;
}

class Mirror {
 public:
  explicit Mirror(const StripMesh& half) : half_(half), whole_(half) {}

  StripMesh run() {
    add_points();
    for (const Vector2& uv : half_.uvs) whole_.uvs.emplace_back(-uv.x(), uv.y());
    add_arches();
    const int patches = static_cast<int>(half_.patches.size());
    for (int p = 0; p < patches; ++p) {
      whole_.patches[p].mirror_of = patches + p;
      whole_.patches.push_back(image(half_.patches[p], p));
    }
    number_components();
    return std::move(whole_);
  }

 private:
  void add_points() {
    const std::vector<char> shared = points_on_plane(half_);
    for (std::size_t v = 0; v < half_.points.size(); ++v) {
      const Vector3& p = half_.points[v];
      point_image_.push_back(static_cast<int>(shared[v] ? v : whole_.points.size()));
      if (!shared[v]) whole_.points.emplace_back(-p.x(), p.y(), p.z());
    }
  }

  void add_arches() {
    const int patches = static_cast<int>(half_.patches.size());
    for (std::size_t a = 0; a < half_.arches.size(); ++a) {
      StripMesh::Arch arch = half_.arches[a];
      arch_image_.push_back(static_cast<int>(arch.on_plane ? a : whole_.arches.size()));
      if (arch.on_plane) {
        whole_.arches[a].patches[1] = arch.patches[0] + patches;
        continue;
      }
      for (int& v : arch.vertices) v = point_image_[v];
      for (int& p : arch.patches)
        if (p >= 0) p += patches;
      whole_.arches.push_back(std::move(arch));
    }
  }

  StripMesh::Patch image(const StripMesh::Patch& of, int id) const {
    const int uvs = static_cast<int>(half_.uvs.size()), n = static_cast<int>(of.boundary.size());
    StripMesh::Patch patch = of;
    patch.mirror_of = id;
    for (auto& t : patch.triangles) {
      for (int k = 0; k < 3; ++k) t.v[k] = point_image_[t.v[k]], t.vt[k] += uvs;
      std::swap(t.v[1], t.v[2]);
      std::swap(t.vt[1], t.vt[2]);
    }
    patch.boundary = turned_loop(of.boundary), patch.boundary_vt = turned_loop(of.boundary_vt);
    for (int& v : patch.boundary) v = point_image_[v];
    for (int& vt : patch.boundary_vt) vt += uvs;
    for (int& corner : patch.corners) corner = (n - corner) % n;
    std::sort(patch.corners.begin(), patch.corners.end());
    std::reverse(patch.arches.begin(), patch.arches.end());
    for (int& a : patch.arches) a = arch_image_[a];
    for (auto& r : patch.rulings) r = {point_image_[r[0]], point_image_[r[1]]};
    return patch;
  }

  void number_components() {
    std::vector<int> parent(whole_.patches.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto find = [&](int i) {
      while (parent[i] != i) i = parent[i] = parent[parent[i]];
      return i;
    };
    for (const StripMesh::Arch& a : whole_.arches) {
      if (a.patches[1] < 0) continue;
      const int p = find(a.patches[0]), q = find(a.patches[1]);
      parent[std::max(p, q)] = std::min(p, q);
    }
    int count = 0;
    for (std::size_t p = 0; p < parent.size(); ++p) {
      const int root = find(static_cast<int>(p));
      whole_.patches[p].component = root == static_cast<int>(p) ? count++ : whole_.patches[root].component;
    }
  }

  const StripMesh& half_;
  StripMesh whole_;
  std::vector<int> point_image_, arch_image_;
};

}  // namespace

StripMesh with_mirror_image(const StripMesh& half) { return Mirror(half).run(); }

}  // namespace sheetform
