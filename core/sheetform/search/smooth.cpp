// The part of the search that smooths paths, as far as the patches beside them allow.
#include <algorithm>
#include <array>
#include <set>

#include "sheetform/search/detail_points.h"
#include "sheetform/search/layout_search.h"

namespace sheetform {
namespace {

// Waves along paths of so many edges are halved where the usual smoothing spoils a patch: at least the
// staircase goes. 0: as it was. The last round undoes what the put back spoils beside it.
constexpr std::array<double, 4> kMilder{10, 5, 0, 0};
// Of the tolerance: so far from the surface places of vertices may be left as these slide along.
constexpr double kMostLeft = 0.3;
constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr double kRough = 35;  // degrees: arches that turn more at a vertex have a staircase left

// The sharpest turn of an arch at an inner vertex, in degrees.
double sharpest_turn(const std::vector<Vector3>& points, const Arch& arch) {
  double sharpest = 0;
  for (std::size_t i = 1; i + 1 < arch.vertices.size(); ++i) {
    const Vector3& at = points[arch.vertices[i]];
    sharpest = std::max(sharpest,
                        angle_between(at - points[arch.vertices[i - 1]], points[arch.vertices[i + 1]] - at));
  }
  return sharpest / kDegree;
}

}  // namespace

SmoothParams LayoutSearch::smooth_params(double cutoff) const {
  SmoothParams params;
  params.rest = &rest_.points;
  params.cutoff_edges = cutoff;
  params.most_left = kMostLeft * params_.evaluation.e_max;
  if (surface_.regions != nullptr)
    params.allowed = [&](const Vector3& from, const Vector3& to) { return outside_regions(from, to); };
  return params;
}

void LayoutSearch::smooth(double cutoff) {
  places_.clear(), hopeless_.clear();
  std::vector<char> path_edge(surface_.mesh.edges.size(), 0), fixed(surface_.mesh.points.size(), 0);
  const PathNetwork& net = network_.network();
  for (int e = 0; e < surface_.mesh.edge_count(); ++e) {
    if (!net.used(e)) continue;
    const auto& edge = surface_.mesh.edges[e];
    path_edge[e] = 1;
    if (is_held(net.kinds[net.edge_path[e]])) fixed[edge.v0] = fixed[edge.v1] = 1;
  }
  give_new_versions(
      smooth_paths(surface_.mesh, path_edge, fixed, *surface_.input, smooth_params(cutoff), context_));
}

// After these have moved.
void LayoutSearch::give_new_versions(const std::vector<int>& vertices) {
  std::vector<char> moved(surface_.mesh.points.size(), 0);
  for (int v : vertices) surface_.versions[v] = ++last_version_, moved[v] = 1;
  let_details_follow(moved);
  changed();
}

// Versions of vertices tell patches apart: faces that get other details than they had, or than they had where
// their vertices have moved `to`, have new ones.
void LayoutSearch::let_details_follow(const std::vector<char>& moved, const DetailPoints& to) {
  if (surface_.details == nullptr) return;
  const SurfaceMesh& mesh = surface_.mesh;
  auto details = std::make_shared<const std::vector<DetailPoint>>(followed(mesh, moved, *surface_.details));
  std::vector<int> faces = faces_that_differ(*surface_.details, *details);
  if (to != nullptr)
    for (int f : faces_that_differ(*to, *details))
      if (moved[mesh.faces[f][0]] || moved[mesh.faces[f][1]] || moved[mesh.faces[f][2]]) faces.push_back(f);
  for (int f : faces)
    for (int v : mesh.faces[f]) surface_.versions[v] = ++last_version_;
  surface_.details = std::move(details);
}

// Vertices go to where they are in another shape of the surface, and so do those of faces that this would
// turn over.
void LayoutSearch::move_to(const std::vector<int>& vertices, const Shape& shape) {
  SurfaceMesh& mesh = surface_.mesh;
  const std::vector<Vector3>& points = shape.points;
  std::vector<char> moved(points.size(), 0);
  const auto move = [&](int v) {
    mesh.points[v] = points[v], surface_.versions[v] = shape.versions[v];
    moved[v] = 1;
  };
  for (int v : vertices) move(v);
  const auto normal_there = [&](int f) {
    const auto& t = mesh.faces[f];
    return Vector3((points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]));
  };
  for (bool again = true; again;) {
    again = false;
    for (int f = 0; f < mesh.face_count(); ++f) {
      const Vector3 now = mesh.face_normal_raw(f), there = normal_there(f);
      if (now.dot(there) > 0.3 * now.norm() * there.norm() && now.norm() > 0.1 * there.norm()) continue;
      for (int v : mesh.faces[f])
        if (mesh.points[v] != points[v]) move(v), again = true;
    }
  }
  let_details_follow(moved, shape.details);
  changed();
}

void LayoutSearch::take_shape(Shape shape) {
  surface_.mesh.points = std::move(shape.points), surface_.versions = std::move(shape.versions);
  surface_.details = std::move(shape.details);
  changed();
}

void LayoutSearch::take(State state) {
  take_shape(std::move(state.shape));
  network_ = std::move(state.network), places_ = std::move(state.places);
  layout_ = std::move(state.layout), layout_valid_ = true;
}

LayoutSearch::Shape LayoutSearch::smoothed(double cutoff) {
  Shape now = shape();
  smooth(cutoff);
  Shape out = shape();
  take_shape(std::move(now));
  return out;
}

void LayoutSearch::smooth_what_allows() {
  Shape before = shape();
  const std::vector<double> error_before = evaluation().patch_error;
  smooth();
  for (double cutoff : kMilder) {
    std::vector<int> bad;
    const LayoutEvaluation& e = evaluation();
    for (int p = 0; p < static_cast<int>(e.patches.size()); ++p)
      if (!e.patches[p]->viable() || e.patch_error[p] > std::max(params_.evaluation.e_max, error_before[p]))
        bad.push_back(p);
    if (bad.empty()) return;
    std::vector<int> vertices;
    for (int f : faces_of(bad))
      vertices.insert(vertices.end(), surface_.mesh.faces[f].begin(), surface_.mesh.faces[f].end());
    move_to(vertices, cutoff > 0 ? smoothed(cutoff) : before);
    places_.clear();
  }
  take_shape(std::move(before));
  places_.clear();
}

// Smooths an arch between its ends as they are, and so far from them; false when the patches around no longer
// fit.
bool LayoutSearch::try_smooth_arch(const Arch& arch, double cutoff, double from_ends) {
  have_places();
  Shape before = shape();
  ArchPlaces places = places_;
  SurfaceMesh& mesh = surface_.mesh;
  std::vector<char> path_edge(mesh.edges.size(), 0), fixed(mesh.points.size(), 0);
  for (int e = 0; e < mesh.edge_count(); ++e)
    if (network_.network().used(e)) fixed[mesh.edges[e].v0] = fixed[mesh.edges[e].v1] = 1;
  for (int e : arch.edges) path_edge[e] = 1;
  double along = 0;
  for (std::size_t i = 1; i + 1 < arch.vertices.size(); ++i) {
    along += mesh.edge_length(arch.edges[i - 1]);
    if (along >= from_ends && arch.length - along >= from_ends) fixed[arch.vertices[i]] = 0;
  }
  SmoothParams params = smooth_params(cutoff);
  params.rest = nullptr;
  give_new_versions(smooth_paths(mesh, path_edge, fixed, *surface_.input, params, context_));
  std::set<int> moved;
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int v : mesh.faces[f])
      if (surface_.versions[v] != before.versions[v]) moved.insert(layout_.face_patch[f]);
  const std::vector<int> faces = faces_of({moved.begin(), moved.end()});  // patches have the same faces still
  if (viable_region(network_.network(), faces) && region_fits(faces)) return true;
  take_shape(std::move(before));
  places_ = std::move(places);
  layout_valid_ = true;  // it was not made anew
  return false;
}

void LayoutSearch::smooth_rough_arches() {
  std::vector<int> edges;  // one of each
  for (const Arch& arch : layout().arches)
    if (arch.left >= 0 && arch.right >= 0 && !arch.closed() &&
        sharpest_turn(surface_.mesh.points, arch) > kRough && !is_held(network_.network().kinds[arch.path]))
      edges.push_back(arch.edges.front());
  for (int e : edges) smooth_arch_of(e);
}

void LayoutSearch::smooth_arch_of(int edge) {
  const Arch arch = layout().arches[layout_.edge_arch[edge]];
  // Ends that turn make a corner, and a patch may have one too many: then they stay as they are.
  if (!try_smooth_arch(arch, SmoothParams().cutoff_edges, 0) && !try_smooth_arch(arch, kMilder[0], 0) &&
      !try_smooth_arch(arch, kMilder[1], 0))
    try_smooth_arch(arch, kMilder[0], params_.evaluation.corner_reach);
}

}  // namespace sheetform
