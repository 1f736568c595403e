// The two-sided distance: samples, vertices, and branch and bound from there.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <queue>

#include "sheetform/strip/certificate.h"

namespace sheetform {
namespace {

// The search stops when nothing can be farther than the largest distance found by this fraction of the
// diagonal.
constexpr double kResolution = 0.8e-4;
constexpr int kSearchBudget = 200'000;  // queries each way; bounds the time on hopeless pairs of surfaces

/// The surface distances are measured from, in plain arrays.
struct Surface {
  const std::vector<Vector3>& points;
  const std::vector<std::array<int, 3>>& faces;
  double area(int f) const {
    const auto& t = faces[f];
    return (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).norm() / 2;
  }
};

double unit_noise(std::uint64_t i) {  // SplitMix64, a fixed stream: results depend on no seed
  std::uint64_t z = (i + 1) * 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-53;
}

struct Sample {
  Vector3 point;
  int face;
};

// One sample in each of `n` equal shares of the area; inside a face the R2 sequence (Roberts) spreads them.
std::vector<Sample> area_samples(const Surface& s, int n) {
  std::vector<double> sum(s.faces.size());
  double total = 0;
  for (std::size_t f = 0; f < s.faces.size(); ++f) sum[f] = total += s.area(static_cast<int>(f));
  std::vector<Sample> out;
  if (!(total > 0)) return out;
  std::size_t f = 0;
  for (int i = 0; i < n; ++i) {
    const double target = (i + unit_noise(static_cast<std::uint64_t>(i))) / n * total;
    while (f + 1 < s.faces.size() && sum[f] <= target) ++f;
    double a = std::fmod(0.5 + i * 0.7548776662466927, 1.0), b = std::fmod(0.5 + i * 0.5698402909980532, 1.0);
    if (a + b > 1) a = 1 - a, b = 1 - b;
    const auto& t = s.faces[f];
    out.push_back(
        {(1 - a - b) * s.points[t[0]] + a * s.points[t[1]] + b * s.points[t[2]], static_cast<int>(f)});
  }
  return out;
}

// Vertices that faces use, each with one of its faces.
std::vector<Sample> vertex_samples(const Surface& s) {
  std::vector<int> face(s.points.size(), -1);
  for (std::size_t f = 0; f < s.faces.size(); ++f)
    for (int v : s.faces[f])
      if (face[v] < 0) face[v] = static_cast<int>(f);
  std::vector<Sample> out;
  for (std::size_t v = 0; v < face.size(); ++v) out.push_back({s.points[v], face[v]});
  return out;
}

std::vector<Sample> midpoint_samples(const Surface& s) {
  std::vector<Sample> out;
  for (std::size_t f = 0; f < s.faces.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = s.faces[f][k], b = s.faces[f][(k + 1) % 3];
      if (a < b) out.push_back({0.5 * (s.points[a] + s.points[b]), static_cast<int>(f)});
    }
  return out;
}

double squared_distance_to_segment(const Vector3& q, const Vector3& a, const Vector3& b) {
  const Vector3 d = b - a;
  const double n = d.squaredNorm();
  return (a + (n > 0 ? std::clamp((q - a).dot(d) / n, 0.0, 1.0) : 0.0) * d - q).squaredNorm();
}

double squared_distance_to_triangle(const Vector3& q, const Vector3& a, const Vector3& b, const Vector3& c) {
  const Vector3 n = (b - a).cross(c - a);
  const double n2 = n.squaredNorm();
  if (n2 > 0 && n.cross(b - a).dot(q - a) >= 0 && n.cross(c - b).dot(q - b) >= 0 &&
      n.cross(a - c).dot(q - c) >= 0) {
    const double h = n.dot(q - a);
    return h * h / n2;
  }
  return std::min({squared_distance_to_segment(q, a, b), squared_distance_to_segment(q, b, c),
                   squared_distance_to_segment(q, c, a)});
}

/// Distances from one surface to another, one way.
class OneWay {
 public:
  OneWay(const Surface& from, const Surface& to, const ClosestPointTree& tree, double resolution,
         const RunContext& context)
      : from_(from),
        to_(to),
        tree_(tree),
        resolution_(resolution),
        context_(context),
        from_face(from.faces.size(), 0),
        to_face(to.faces.size(), 0) {}

  // Measures from each sample and keeps the answers in their order.
  std::vector<ClosestPoint> measure(const std::vector<Sample>& samples) {
    std::vector<ClosestPoint> hits(samples.size());
    constexpr int kChunk = 512;
    const int n = static_cast<int>(samples.size());
    parallel_for(context_, (n + kChunk - 1) / kChunk, [&](int chunk) {
      for (int i = chunk * kChunk; i < std::min(n, (chunk + 1) * kChunk); ++i)
        if (samples[i].face >= 0) hits[i] = tree_.closest(samples[i].point);
    });
    context_.checkpoint();
    for (int i = 0; i < n; ++i)
      if (samples[i].face >= 0) keep(samples[i].point, samples[i].face, hits[i]);
    return hits;
  }

  // Splits the faces that can still hold a point farther than the largest distance found, until none can.
  void search(const std::vector<ClosestPoint>& at_vertex) {
    std::priority_queue<Piece> queue;
    for (std::size_t f = 0; f < from_.faces.size(); ++f) {
      Piece piece;
      piece.face = static_cast<int>(f);
      for (int k = 0; k < 3; ++k)
        piece.corner[k] = from_.points[from_.faces[f][k]], piece.hit[k] = at_vertex[from_.faces[f][k]];
      piece.bound = bound_of(piece);
      push(queue, piece);
    }
    for (int spent = 0; !queue.empty() && queue.top().bound > max + resolution_ && spent < kSearchBudget;
         ++spent) {
      if (spent % 1024 == 0) context_.checkpoint();
      const Piece piece = queue.top();
      queue.pop();
      split(piece, queue);
    }
    upper = std::max(max + resolution_, queue.empty() ? 0.0 : queue.top().bound);
  }

 private:
  // Part of a face with the closest points of its corners.
  struct Piece {
    Vector3 corner[3];
    ClosestPoint hit[3];
    double bound;
    int face;
    bool operator<(const Piece& other) const {
      return bound != other.bound ? bound < other.bound : face > other.face;
    }
  };

  void keep(const Vector3& point, int face, const ClosestPoint& hit) {
    const double d = std::sqrt(hit.squared_distance);
    from_face[face] = std::max(from_face[face], d);
    if (hit.face >= 0) to_face[hit.face] = std::max(to_face[hit.face], d);
    if (d > max) max = d, worst = point;
  }

  // The distance to one triangle is convex, so over the whole piece it is largest at a corner.
  double bound_of(const Piece& piece) const {
    double best = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      if (piece.hit[k].face < 0 || (k > 0 && piece.hit[k].face == piece.hit[k - 1].face)) continue;
      const auto& t = to_.faces[piece.hit[k].face];
      double farthest = piece.hit[k].squared_distance;
      for (int j = 0; j < 3; ++j)
        if (j != k)
          farthest = std::max(farthest, squared_distance_to_triangle(piece.corner[j], to_.points[t[0]],
                                                                     to_.points[t[1]], to_.points[t[2]]));
      best = std::min(best, farthest);
    }
    return std::sqrt(best);
  }

  void push(std::priority_queue<Piece>& queue, const Piece& piece) const {
    if (piece.bound > max + resolution_) queue.push(piece);
  }

  void split(const Piece& piece, std::priority_queue<Piece>& queue) {
    int longest = 0;
    for (int k = 1; k < 3; ++k)
      if (side2(piece, k) > side2(piece, longest)) longest = k;
    const Vector3 middle = 0.5 * (piece.corner[longest] + piece.corner[(longest + 1) % 3]);
    const ClosestPoint hit = tree_.closest(middle);
    keep(middle, piece.face, hit);
    for (int k : {longest, (longest + 1) % 3}) {
      Piece half = piece;
      half.corner[k] = middle, half.hit[k] = hit;
      half.bound = std::min(piece.bound, bound_of(half));
      push(queue, half);
    }
  }

  static double side2(const Piece& p, int k) { return (p.corner[k] - p.corner[(k + 1) % 3]).squaredNorm(); }

  const Surface& from_;
  const Surface& to_;
  const ClosestPointTree& tree_;
  double resolution_;
  const RunContext& context_;

 public:
  double max = 0, upper = 0;
  Vector3 worst = Vector3::Zero();
  std::vector<double> from_face, to_face;  ///< largest distance found from and to each face
};

double mean_distance(const std::vector<ClosestPoint>& hits) {
  double sum = 0;
  for (const ClosestPoint& h : hits) sum += std::sqrt(h.squared_distance);
  return hits.empty() ? 0 : sum / static_cast<double>(hits.size());
}

struct OneWayResult {
  double max, upper, mean;
  Vector3 worst;
  std::vector<double> from_face, to_face;
};

OneWayResult measure_one_way(const Surface& from, const Surface& to, const ClosestPointTree& tree,
                             int samples, bool midpoints, double resolution, const RunContext& context) {
  OneWay way(from, to, tree, resolution, context);
  const double mean = mean_distance(way.measure(area_samples(from, samples)));
  if (midpoints) way.measure(midpoint_samples(from));
  way.search(way.measure(vertex_samples(from)));
  return {way.max, way.upper, mean, way.worst, std::move(way.from_face), std::move(way.to_face)};
}

}  // namespace

DistanceReport measure_distance(const TriangleSoup& input, const ClosestPointTree& tree,
                                const StripMesh& result, int samples, RunContext& context) {
  std::vector<std::array<int, 3>> faces;
  std::vector<int> patch_of;
  for (std::size_t p = 0; p < result.patches.size(); ++p)
    for (const StripMesh::Triangle& t : result.patches[p].triangles) {
      faces.push_back(t.v);
      patch_of.push_back(static_cast<int>(p));
    }
  DistanceReport report;
  report.patch_error.assign(result.patches.size(), 0);
  if (faces.empty() || input.faces.empty()) return report;
  const Surface in{input.points, input.faces}, out{result.points, faces};
  Eigen::AlignedBox3d box;
  for (const auto& f : input.faces)
    for (int v : f) box.extend(input.points[v]);
  const double resolution = kResolution * box.diagonal().norm();
  const ClosestPointTree result_tree(result.points, faces);
  context.checkpoint();
  const OneWayResult to = measure_one_way(in, out, result_tree, samples, false, resolution, context);
  const OneWayResult back = measure_one_way(out, in, tree, samples, true, resolution, context);
  report.input_to_result = to.max, report.result_to_input = back.max;
  report.upper = std::max(to.upper, back.upper);
  report.mean = (to.mean + back.mean) / 2;
  report.worst_place = to.max >= back.max ? to.worst : back.worst;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    double& error = report.patch_error[patch_of[f]];
    error = std::max({error, to.to_face[f], back.from_face[f]});
  }
  return report;
}

}  // namespace sheetform
