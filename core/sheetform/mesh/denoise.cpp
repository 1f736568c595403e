#include "sheetform/mesh/denoise.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "sheetform/mesh/sharpness.h"

namespace sheetform {
namespace {

constexpr double kMostUneven = 0.75;  // standard deviation / mean of edge lengths
constexpr int kSample = 1500;         // edges that are looked at
constexpr double kTurn = 8;           // degrees: of an edge that may be noise
constexpr double kTurnsBack = 1.5;    // that much more than the surface around: it is
constexpr double kLeastNoise = 0.085;
constexpr double kNoBarrier = 360;  // degrees: noise turns by any angle

constexpr int kRounds = 10, kFilterings = 2, kSteps = 5;
constexpr double kSimilar = 0.4;    // distance of unit normals that belong together (23 degrees)
constexpr int kOftenEnough = 4096;  // faces between two looks at whether to stop

bool too_uneven(const SurfaceMesh& mesh) {
  const double mean = mean_edge_length(mesh);
  double squares = 0;
  for (int e = 0; e < mesh.edge_count(); ++e) squares += std::pow(mesh.edge_length(e) - mean, 2);
  return squares > std::pow(kMostUneven * mean, 2) * mesh.edge_count();
}

// One list for each vertex or face, all in one array.
struct Lists {
  std::vector<int> begin{0}, items;
  const int* first(int i) const { return items.data() + begin[i]; }
  const int* last(int i) const { return items.data() + begin[i + 1]; }
};

class Denoiser {
 public:
  Denoiser(const SurfaceMesh& mesh, const RunContext& context) : mesh_(mesh), context_(context) {
    list_faces_at_vertices();
    list_faces_around_faces();
    normals_.resize(mesh.faces.size()), middles_ = filtered_ = normals_;
    areas_.resize(mesh.faces.size()), folded_.resize(mesh.faces.size());
  }

  SurfaceMesh run() {
    for (int round = 0; round < kRounds; ++round) {
      context_.checkpoint();
      measure();
      turn_folded();
      for (int i = 0; i < kFilterings; ++i) filter_normals();
      for (int i = 0; i < kSteps; ++i) context_.checkpoint(), follow_normals();
    }
    return std::move(mesh_);
  }

 private:
  void list_faces_at_vertices() {
    std::vector<int> count(mesh_.points.size() + 1, 0);
    for (const auto& f : mesh_.faces)
      for (int v : f) ++count[v + 1];
    for (std::size_t v = 1; v < count.size(); ++v) count[v] += count[v - 1];
    at_vertex_.begin = count;
    at_vertex_.items.resize(3 * mesh_.faces.size());
    for (int f = 0; f < mesh_.face_count(); ++f)
      for (int v : mesh_.faces[f]) at_vertex_.items[count[v]++] = f;
  }

  // Each face that has a vertex in common, the face itself too.
  void list_faces_around_faces() {
    std::vector<int> seen(mesh_.faces.size(), -1);
    for (int f = 0; f < mesh_.face_count(); ++f) {
      if (f % kOftenEnough == 0) context_.checkpoint();
      for (int v : mesh_.faces[f])
        for (const int* g = at_vertex_.first(v); g != at_vertex_.last(v); ++g)
          if (seen[*g] != f) seen[*g] = f, around_.items.push_back(*g);
      around_.begin.push_back(static_cast<int>(around_.items.size()));
    }
  }

  void measure() {
    for (int f = 0; f < mesh_.face_count(); ++f) {
      const Vector3 n = mesh_.face_normal_raw(f);
      areas_[f] = n.norm() / 2;
      normals_[f] = areas_[f] > 0 ? Vector3(n / (2 * areas_[f])) : Vector3::Zero();
      middles_[f] = mesh_.face_middle(f);
    }
    double sum = 0;
    int count = 0;
    for (const auto& edge : mesh_.edges)
      if (!edge.border()) sum += (middles_[edge.f0] - middles_[edge.f1]).norm(), ++count;
    spacing_ = sum / std::max(1, count);
  }

  // Noise along the surface folds triangles over. Such a one takes the normal of those around.
  void turn_folded() {
    for (int f = 0; f < mesh_.face_count(); ++f) {
      Vector3 sum = Vector3::Zero();
      for (const int* g = around_.first(f); g != around_.last(f); ++g) sum += areas_[*g] * normals_[*g];
      filtered_[f] = sum.dot(normals_[f]) < 0 ? Vector3(sum.normalized()) : normals_[f];
    }
    normals_.swap(filtered_);
  }

  // A normal becomes the mean of those nearby that are like it.
  void filter_normals() {
    const double near = 1 / (2 * std::max(spacing_ * spacing_, 1e-300)), like = 1 / (2 * kSimilar * kSimilar);
    for (int f = 0; f < mesh_.face_count(); ++f) {
      if (f % kOftenEnough == 0) context_.checkpoint();
      Vector3 sum = Vector3::Zero();
      for (const int* g = around_.first(f); g != around_.last(f); ++g)
        sum += areas_[*g] *
               std::exp(-near * (middles_[f] - middles_[*g]).squaredNorm() -
                        like * (normals_[f] - normals_[*g]).squaredNorm()) *
               normals_[*g];
      filtered_[f] = sum.norm() > 0 ? Vector3(sum.normalized()) : normals_[f];
    }
    normals_.swap(filtered_);
  }

  // Moves each vertex towards the planes of the filtered normals through the middles of its faces; next to a
  // folded triangle also along the surface, to the middle of its neighbours.
  void follow_normals() {
    for (int f = 0; f < mesh_.face_count(); ++f) {
      middles_[f] = mesh_.face_middle(f);
      folded_[f] = mesh_.face_normal_raw(f).dot(normals_[f]) < 0;
    }
    for (int v = 0; v < mesh_.vertex_count(); ++v) {
      if (mesh_.border_vertex[v]) continue;
      Vector3 sum = Vector3::Zero();
      const bool unfold =
          std::any_of(at_vertex_.first(v), at_vertex_.last(v), [&](int f) { return folded_[f] != 0; });
      for (const int* f = at_vertex_.first(v); f != at_vertex_.last(v); ++f) {
        const Vector3 way = middles_[*f] - mesh_.points[v];
        sum += unfold ? way : Vector3(normals_[*f] * normals_[*f].dot(way));
      }
      mesh_.points[v] += sum / static_cast<double>(at_vertex_.last(v) - at_vertex_.first(v));
    }
  }

  SurfaceMesh mesh_;
  const RunContext& context_;
  Lists at_vertex_, around_;
  std::vector<Vector3> normals_, filtered_, middles_;
  std::vector<double> areas_;
  std::vector<char> folded_;
  double spacing_ = 0;  // of the middles of neighbours, mean
};

}  // namespace

bool is_noisy(const SurfaceMesh& mesh) {
  if (mesh.edges.empty() || too_uneven(mesh)) return false;
  const Sharpness sharpness(mesh);
  const int step = std::max(1, mesh.edge_count() / kSample);
  double length = 0, noise = 0;
  for (int e = 0; e < mesh.edge_count(); e += step) {
    if (mesh.edges[e].border()) continue;
    length += mesh.edge_length(e);
    if (sharpness.dihedral(e) > kTurn && sharpness.share(e, kNoBarrier) > kTurnsBack)
      noise += mesh.edge_length(e);
  }
  return noise > kLeastNoise * length;
}

SurfaceMesh denoised(const SurfaceMesh& mesh, const RunContext& context) {
  return Denoiser(mesh, context).run();
}

}  // namespace sheetform
