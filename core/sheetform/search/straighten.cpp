// The part of the search that lets patches go on across the plane of symmetry.
#include <algorithm>
#include <cmath>

#include "sheetform/search/layout_search.h"

namespace sheetform {
namespace {

constexpr double kCrease = 0.342;  // sine of half of 40 degrees: the surface has an edge along the plane

// Mean slope of the surface to its mirror image along the arch.
double slope(const SurfaceMesh& mesh, const Arch& arch) {
  double sum = 0, length = 0;
  for (int e : arch.edges) {
    const double l = mesh.edge_length(e);
    sum += l * std::abs(mesh.face_normal_raw(mesh.edges[e].f0).normalized().x()), length += l;
  }
  return sum / std::max(length, 1e-300);
}

}  // namespace

// The path of the arch's edges is a new one, so that what is known of the patch as it was stays apart.
void LayoutSearch::set_straight(const std::vector<int>& edges, bool straight) {
  surface_.straight.resize(surface_.mesh.edges.size(), 0);
  for (int e : edges) surface_.straight[e] = straight;
  network_.insert_edges(edges, PathKind::kSymmetry);
  changed();
}

bool LayoutSearch::try_straighten(int edge) {
  const Arch arch = layout().arches[layout_.edge_arch[edge]];
  if (arch.closed() || slope(surface_.mesh, arch) > kCrease || surface_.is_drawn(network_.network(), arch))
    return false;
  const int face = surface_.mesh.edges[edge].f0;
  have_places();
  const std::vector<int> faces = layout_.patches[layout_.face_patch[face]].faces;
  set_straight(arch.edges, true);
  if (evaluator_->patch(layout(), layout_.face_patch[face])->viable() && region_fits(faces)) return true;
  for (int e : arch.edges) surface_.straight[e] = 0;
  network_.restore_edges(arch.edges, std::vector<int>(arch.edges.size(), arch.path));
  changed();
  return false;
}

int LayoutSearch::straighten_plane() {
  std::vector<std::pair<double, int>> order;  // longest first, lowest edge next
  for (const Arch& arch : layout().arches)
    if (surface_.on_plane(arch) && !surface_.is_straight(arch))
      order.emplace_back(-arch.length, *std::min_element(arch.edges.begin(), arch.edges.end()));
  std::sort(order.begin(), order.end());
  return static_cast<int>(std::count_if(order.begin(), order.end(),
                                        [&](const auto& entry) { return try_straighten(entry.second); }));
}

int LayoutSearch::release_plane(const std::vector<int>& patches) {
  std::vector<std::vector<int>> released;
  for (int p : patches)
    for (const ArchUse& use : layout().patches[p].boundary)
      if (surface_.is_straight(layout_.arches[use.arch])) released.push_back(layout_.arches[use.arch].edges);
  for (const std::vector<int>& edges : released) set_straight(edges, false);
  return static_cast<int>(released.size());
}

}  // namespace sheetform
