#include <algorithm>
#include <cmath>

#include "sheetform/strip/certificate.h"
#include "sheetform/strip/mirror.h"

namespace sheetform {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

// The mirror image in the line through a and b.
Vector2 reflected(const Vector2& p, const Vector2& a, const Vector2& b) {
  const Vector2 along = (b - a).normalized(), d = p - a;
  return a + 2 * along.dot(d) * along - d;
}

// A patch from the end of its segment on the plane, once around to the start: places of its boundary.
struct Opened {
  std::vector<int> places;
  std::vector<int> arches;  // without the one on the plane
};

class Joiner {
 public:
  Joiner(const StripMesh& whole, const JoinRules& rules) : rules_(rules), mesh_(whole) {}

  StripMesh run() {
    std::vector<char> patch_gone(mesh_.patches.size(), 0), arch_gone(mesh_.arches.size(), 0);
    for (std::size_t a = 0; a < mesh_.arches.size(); ++a) {
      const StripMesh::Arch& arch = mesh_.arches[a];
      if (!arch.on_plane || arch.vertices.size() != 2 || arch.patches[1] < 0) continue;
      const int p = arch.patches[0], q = arch.patches[1];
      if (mesh_.patches[p].mirror_of != q || meets_plane_elsewhere(p, static_cast<int>(a))) continue;
      StripMesh trial = mesh_;
      if (!join(trial, p, q, static_cast<int>(a))) continue;
      mesh_ = std::move(trial);
      patch_gone[q] = arch_gone[a] = 1;
    }
    return without(patch_gone, arch_gone);
  }

 private:
  // Elsewhere the patch may meet its image only along whole seams that are clear of this one, or it would
  // touch itself in single points.
  bool meets_plane_elsewhere(int p, int plane_arch) const {
    const StripMesh::Patch &patch = mesh_.patches[p], &image = mesh_.patches[patch.mirror_of];
    if (std::count(patch.arches.begin(), patch.arches.end(), plane_arch) != 1 || glued_to_itself(p))
      return true;
    std::vector<int> seam_points;
    for (int a : patch.arches)
      if (mesh_.arches[a].on_plane && a != plane_arch)
        seam_points.insert(seam_points.end(), mesh_.arches[a].vertices.begin(),
                           mesh_.arches[a].vertices.end());
    if (!seam_points.empty() && !rules_.self_seams) return true;
    std::vector<int> other = image.boundary;
    std::sort(other.begin(), other.end());
    std::sort(seam_points.begin(), seam_points.end());
    const std::vector<int>& ends = mesh_.arches[plane_arch].vertices;
    return std::any_of(patch.boundary.begin(), patch.boundary.end(), [&](int v) {
      if (!std::binary_search(other.begin(), other.end(), v)) return false;
      const bool end = v == ends[0] || v == ends[1];
      return end == std::binary_search(seam_points.begin(), seam_points.end(), v);
    });
  }

  bool glued_to_itself(int p) const {
    return std::any_of(mesh_.patches[p].arches.begin(), mesh_.patches[p].arches.end(),
                       [&](int a) { return mesh_.arches[a].patches[0] == mesh_.arches[a].patches[1]; });
  }

  Opened opened(const StripMesh::Patch& patch, int plane_arch) const {
    Opened o;
    const int n = static_cast<int>(patch.boundary.size()), arches = static_cast<int>(patch.arches.size());
    int place = 0, k = 0;
    for (; patch.arches[k] != plane_arch; ++k)
      place += static_cast<int>(mesh_.arches[patch.arches[k]].vertices.size()) - 1;
    for (int i = 1; i <= n; ++i) o.places.push_back((place + i) % n);
    for (int i = 1; i < arches; ++i) o.arches.push_back(patch.arches[(k + i) % arches]);
    return o;
  }

  // Whether the joined outline turns at place i; directions are taken as far as `reach`, not past a node.
  bool turns(const StripMesh& mesh, const StripMesh::Patch& patch, const std::vector<char>& node,
             int i) const {
    const int n = static_cast<int>(patch.boundary.size());
    const Vector2& at = mesh.uvs[patch.boundary_vt[i]];
    const auto away = [&](int step) {
      int k = i;
      do k = (k + step + n) % n;
      while (!node[k] && (mesh.uvs[patch.boundary_vt[k]] - at).norm() < 0.9 * rules_.corner_reach);
      return mesh.uvs[patch.boundary_vt[k]];
    };
    const Vector2 in = at - away(-1), out = away(1) - at;
    return rules_.every_node || std::abs(std::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out))) >
                                    rules_.corner_turn * kDegree;
  }

  // Makes p the patch over both sides of the plane; q and the arch are no longer used.
  bool join(StripMesh& mesh, int p, int q, int plane_arch) const {
    const StripMesh::Patch half = mesh_.patches[p], image = mesh_.patches[q];
    const Opened mine = opened(half, plane_arch), other = opened(image, plane_arch);
    const int n = static_cast<int>(mine.places.size());
    const Vector2 a = mesh.uvs[half.boundary_vt[mine.places[n - 1]]],
                  b = mesh.uvs[half.boundary_vt[mine.places[0]]];
    // Points of the segment have the half's uv, all other ones of the image a reflected one of their own.
    std::vector<int> vt(mesh.uvs.size(), -1);
    vt[image.boundary_vt[other.places[0]]] = half.boundary_vt[mine.places[n - 1]];
    vt[image.boundary_vt[other.places[n - 1]]] = half.boundary_vt[mine.places[0]];
    for (int i = 1; i + 1 < n; ++i) {
      const int t = image.boundary_vt[other.places[i]];
      vt[t] = t;
      mesh.uvs[t] = reflected(mesh_.uvs[half.boundary_vt[mine.places[n - 1 - i]]], a, b);
    }
    StripMesh::Patch whole;
    whole.component = half.component;
    whole.triangles = half.triangles;
    for (StripMesh::Triangle t : image.triangles) {
      for (int& x : t.vt) x = vt[x];
      whole.triangles.push_back(t);
    }
    std::vector<char> node, corner;
    outline(mesh, half, mine, vt, whole, node, corner);
    outline(mesh, image, other, vt, whole, node, corner);
    const int m = static_cast<int>(whole.boundary.size());
    for (int i : {0, m / 2}) corner[i] = turns(mesh, whole, node, i);
    for (int i = 0; i < m; ++i)
      if (corner[i]) whole.corners.push_back(i);
    if (static_cast<int>(whole.corners.size()) > rules_.max_sides) return false;
    whole.rulings = rulings_of(half, image, half.boundary[mine.places[n - 1]], half.boundary[mine.places[0]]);
    mesh.patches[p] = whole;
    for (StripMesh::Arch& arch : mesh.arches)
      for (int& side : arch.patches)
        if (side == q) side = p;
    return check_patch(mesh, p, 1.0).empty();
  }

  // Appends all places but the last, which is the first of the other side.
  void outline(const StripMesh& mesh, const StripMesh::Patch& side, const Opened& opened,
               const std::vector<int>& vt, StripMesh::Patch& whole, std::vector<char>& node,
               std::vector<char>& corner) const {
    const std::size_t first = whole.boundary.size();
    for (std::size_t i = 0; i + 1 < opened.places.size(); ++i) {
      const int place = opened.places[i], t = side.boundary_vt[place];
      whole.boundary.push_back(side.boundary[place]);
      whole.boundary_vt.push_back(vt[t] < 0 ? t : vt[t]);
      corner.push_back(std::binary_search(side.corners.begin(), side.corners.end(), place));
      node.push_back(0);
    }
    std::size_t at = first;
    for (int a : opened.arches) {
      node[at] = 1;
      at += mesh.arches[a].vertices.size() - 1;
      whole.arches.push_back(a);
    }
  }

  // Along the sweep where the segment is at one end of it.
  static std::vector<std::array<int, 2>> rulings_of(const StripMesh::Patch& half,
                                                    const StripMesh::Patch& image, int from, int to) {
    const auto on_segment = [&](const StripMesh::Triangle& t) {
      return std::count(t.v.begin(), t.v.end(), from) && std::count(t.v.begin(), t.v.end(), to);
    };
    std::vector<std::array<int, 2>> before = half.rulings, after = image.rulings;
    std::reverse(on_segment(half.triangles.back()) ? after.begin() : before.begin(),
                 on_segment(half.triangles.back()) ? after.end() : before.end());
    before.push_back({from, to});
    before.insert(before.end(), after.begin(), after.end());
    return before;
  }

  StripMesh without(const std::vector<char>& patch_gone, const std::vector<char>& arch_gone) const {
    StripMesh out;
    out.points = mesh_.points;
    std::vector<int> patch_id, arch_id;
    int patches = 0, arches = 0;
    for (char gone : patch_gone) patch_id.push_back(gone ? -1 : patches++);
    for (char gone : arch_gone) arch_id.push_back(gone ? -1 : arches++);
    for (std::size_t p = 0; p < mesh_.patches.size(); ++p) {
      if (patch_gone[p]) continue;
      StripMesh::Patch patch = mesh_.patches[p];
      for (int& a : patch.arches) a = arch_id[a];
      if (patch.mirror_of >= 0) patch.mirror_of = patch_id[patch.mirror_of];
      out.patches.push_back(std::move(patch));
    }
    keep_used_uvs(out);
    for (std::size_t a = 0; a < mesh_.arches.size(); ++a) {
      if (arch_gone[a]) continue;
      StripMesh::Arch arch = mesh_.arches[a];
      for (int& p : arch.patches)
        if (p >= 0) p = patch_id[p];
      out.arches.push_back(std::move(arch));
    }
    return out;
  }

  void keep_used_uvs(StripMesh& out) const {
    std::vector<int> id(mesh_.uvs.size(), -1);
    for (const StripMesh::Patch& patch : out.patches)
      for (int t : patch.boundary_vt) id[t] = 0;
    for (std::size_t t = 0; t < id.size(); ++t) {
      if (id[t] < 0) continue;
      id[t] = static_cast<int>(out.uvs.size());
      out.uvs.push_back(mesh_.uvs[t]);
    }
    for (StripMesh::Patch& patch : out.patches) {
      for (int& t : patch.boundary_vt) t = id[t];
      for (StripMesh::Triangle& triangle : patch.triangles)
        for (int& t : triangle.vt) t = id[t];
    }
  }

  const JoinRules& rules_;
  StripMesh mesh_;
};

}  // namespace

StripMesh join_images(const StripMesh& whole, const JoinRules& rules) { return Joiner(whole, rules).run(); }

}  // namespace sheetform
