#include "sheetform/strip/one_way_distance.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <queue>
#include <utility>

#include "sheetform/base/parallel_groups.h"

namespace sheetform::certificate {
namespace {

// Pieces that are split at once: more than threads need, few enough that all are near the top of the queue.
constexpr std::size_t kAtOnce = 512;
// Pieces, or faces to look for places beyond a limit in, that one thread takes at once.
constexpr int kTogether = 32;
// In a face where a place beyond the limit is known, one is only looked for that is worse by this share of
// the limit, and by more where that place is far beyond it.
constexpr double kWorse = 1e-3, kMuchWorse = 0.1, kFarBeyond = 1.05;

// No point of the triangle is farther than this from the nearest of its corners.
double cover_radius(const std::array<Vector3, 3>& p) {
  std::array<double, 3> side2{(p[1] - p[0]).squaredNorm(), (p[2] - p[1]).squaredNorm(),
                              (p[0] - p[2]).squaredNorm()};
  std::sort(side2.begin(), side2.end());
  const double four_areas2 = 4 * (p[1] - p[0]).cross(p[2] - p[0]).squaredNorm();
  if (side2[0] + side2[1] <= side2[2] || !(four_areas2 > 0)) return std::sqrt(side2[2]) / 2;
  return std::min(std::sqrt(side2[0] * side2[1] * side2[2] / four_areas2), std::sqrt(side2[2] / 3));
}

int longest_side(const std::array<Vector3, 3>& p) {
  int longest = 0;
  for (int k = 1; k < 3; ++k)
    if ((p[(k + 1) % 3] - p[k]).squaredNorm() > (p[(longest + 1) % 3] - p[longest]).squaredNorm())
      longest = k;
  return longest;
}

}  // namespace

void Farthest::raise(int face, double distance, const Vector3& point, const ClosestPoint& hit) {
  if (!(distance > at(face))) return;
  if (slot_[face] < 0) slot_[face] = static_cast<int>(places_.size()), places_.emplace_back();
  places_[slot_[face]] = {distance, point, hit};
}

// Part of a face, with what is known of its corners.
struct OneWayDistance::Piece {
  std::array<Vector3, 3> corners;
  std::array<Hit, 3> hits;
  int face = -1;
  double bound = std::numeric_limits<double>::infinity();  // no point of the piece is farther
};

// What was found where a piece was split.
struct OneWayDistance::Probe {
  Vector3 point;
  int face = -1;
  ClosestPoint hit;
};

OneWayDistance::OneWayDistance(const Surface& from, const Surface& to, const ClosestPointTree& tree,
                               const HeightBound* heights, double enough, const RunContext& context)
    : from_face(from.faces.size()),
      to_face(to.faces.size()),
      from_(from),
      to_(to),
      tree_(tree),
      heights_(heights),
      enough_(enough),
      context_(context) {}

ClosestPoint OneWayDistance::closest(const Vector3& point) const {
  return tree_.closest(point, std::numeric_limits<double>::infinity(), enough_ * enough_);
}

void OneWayDistance::keep(const Vector3& point, int face, const ClosestPoint& hit) {
  const double d = std::sqrt(hit.squared_distance);
  from_face.raise(face, d, point, hit);
  if (hit.face >= 0) to_face.raise(hit.face, d, point, hit);
  if (d > max) max = d, worst = point;
}

double OneWayDistance::measure(const std::vector<AreaSample>& samples, std::vector<int>* hits) {
  double sum = 0;
  for (const Hit& hit : hits_of(samples)) {
    sum += hit.distance;
    if (hits != nullptr) hits->push_back(hit.face);
  }
  return samples.empty() ? 0 : sum / static_cast<double>(samples.size());
}

std::vector<OneWayDistance::Hit> OneWayDistance::hits_of(const std::vector<AreaSample>& samples) {
  std::vector<ClosestPoint> hits(samples.size());
  constexpr int kChunk = 512;
  const int n = static_cast<int>(samples.size());
  parallel_in_groups(context_, n, kChunk, [&](int i) { hits[i] = closest(samples[i].point); });
  context_.checkpoint();
  std::vector<Hit> out;
  for (int i = 0; i < n; ++i) {
    keep(samples[i].point, samples[i].face, hits[i]);
    out.push_back({hits[i].face, std::sqrt(hits[i].squared_distance), hits[i].point});
  }
  return out;
}

std::vector<OneWayDistance::Hit> OneWayDistance::vertex_hits(const std::vector<int>& faces) {
  std::vector<int> face_of(from_.points.size(), -1);
  for (int f : faces)
    for (int v : from_.faces[f])
      if (face_of[v] < 0) face_of[v] = f;
  std::vector<AreaSample> samples;
  std::vector<int> vertices;
  for (std::size_t v = 0; v < face_of.size(); ++v)
    if (face_of[v] >= 0)
      samples.push_back({from_.points[v], face_of[v]}), vertices.push_back(static_cast<int>(v));
  const std::vector<Hit> hits = hits_of(samples);
  std::vector<Hit> out(from_.points.size());
  for (std::size_t i = 0; i < hits.size(); ++i) out[vertices[i]] = hits[i];
  return out;
}

// Two bounds. The distance to any one face is convex, so over the piece it is largest at a corner. And a
// point x = sum w_k p_k of the piece is no farther from the nearest of the hits y_k than in their mean
// square, sum w_k |x - y_k|^2 = |x - y|^2 + sum w_k |y - y_k|^2 with y = sum w_k y_k: the first of these is
// at most the farthest corner's, the second the squared cover radius of the hits.
double OneWayDistance::bound_of(const Piece& piece) const {
  double farthest = 0;
  for (const Hit& h : piece.hits) farthest = std::max(farthest, h.distance);
  const double spread = cover_radius({piece.hits[0].point, piece.hits[1].point, piece.hits[2].point});
  double bound = std::min(piece.bound, std::hypot(farthest, spread));
  for (int k = 0; k < 3; ++k) {
    const int face = piece.hits[k].face;
    if (face < 0 || (k > 0 && face == piece.hits[k - 1].face)) continue;
    const auto& t = to_.faces[face];
    double most = 0;
    for (int i = 0; i < 3 && most < bound; ++i)
      most = std::max(most, piece.hits[i].face == face
                                ? piece.hits[i].distance
                                : distance_to_triangle(piece.corners[i], to_.points[t[0]], to_.points[t[1]],
                                                       to_.points[t[2]]));
    bound = std::min(bound, most);
  }
  return bound;
}

// Of what lies over the whole piece; only where it is at most `limit`, else infinity.
double OneWayDistance::height_of(const Piece& piece, double limit) const {
  for (const Hit& h : piece.hits)
    if (h.face < 0 || h.distance > limit) return std::numeric_limits<double>::infinity();
  return (*heights_)(piece.corners, {piece.hits[0].face, piece.hits[1].face, piece.hits[2].face}, limit);
}

OneWayDistance::Piece OneWayDistance::whole_face(int face, const std::vector<Hit>& vertices) const {
  const auto& t = from_.faces[face];
  Piece piece;
  for (int k = 0; k < 3; ++k) piece.corners[k] = from_.points[t[k]], piece.hits[k] = vertices[t[k]];
  piece.face = face, piece.bound = bound_of(piece);
  return piece;
}

// Splits the longest side of the piece in the middle.
OneWayDistance::Probe OneWayDistance::split(const Piece& piece, std::array<Piece, 2>& halves) const {
  const int side = longest_side(piece.corners);
  Probe probe;
  probe.point = (piece.corners[side] + piece.corners[(side + 1) % 3]) / 2;
  probe.face = piece.face;
  probe.hit = closest(probe.point);
  halves = {piece, piece};
  for (int i = 0; i < 2; ++i) {
    halves[i].corners[(side + i) % 3] = probe.point;
    halves[i].hits[(side + i) % 3] = {probe.hit.face, std::sqrt(probe.hit.squared_distance), probe.hit.point};
    halves[i].bound = bound_of(halves[i]);
  }
  return probe;
}

// A queue that only takes pieces that may matter, and tells what the others are bounded by. known: by face,
// what a piece has to reach beyond. Only places are moved about in the heap, pieces are ten times as large.
class OneWayDistance::Open {
 public:
  Open(const OneWayDistance& way, std::function<double(int)> known) : way_(way), known_(std::move(known)) {}
  void push(Piece piece) {
    if (!matters(piece)) return;
    piece.bound = std::min(piece.bound, way_.height_of(piece, known_(piece.face)));
    if (!matters(piece)) return;
    int slot = static_cast<int>(pieces_.size());
    if (free_.empty())
      pieces_.push_back(piece);
    else
      slot = free_.back(), free_.pop_back(), pieces_[slot] = piece;
    queue_.push({piece.bound, made_++, slot});
  }
  std::vector<Piece> pop(std::size_t most) {
    std::vector<Piece> out;
    for (; !queue_.empty() && out.size() < most; queue_.pop()) {
      const int slot = queue_.top().slot;
      if (matters(pieces_[slot])) out.push_back(pieces_[slot]);
      free_.push_back(slot);
    }
    return out;
  }
  double bound() const { return std::max(left_, queue_.empty() ? 0 : queue_.top().bound); }
  // Takes over what the other has not split, where it still matters.
  void take(Open& other) {
    left_ = std::max(left_, other.left_);
    for (; !other.queue_.empty(); other.queue_.pop()) push(other.pieces_[other.queue_.top().slot]);
  }

 private:
  struct Entry {
    double bound;
    std::int64_t order;  // of making, which decides between equal bounds
    int slot;
    bool operator<(const Entry& other) const {
      return bound != other.bound ? bound < other.bound : order > other.order;
    }
  };
  bool matters(const Piece& piece) {
    if (piece.bound > known_(piece.face)) return true;
    left_ = std::max(left_, piece.bound);
    return false;
  }
  const OneWayDistance& way_;
  std::function<double(int)> known_;
  std::priority_queue<Entry> queue_;
  std::vector<Piece> pieces_;  // by slot
  std::vector<int> free_;      // slots
  std::int64_t made_ = 0;
  double left_ = 0;
};

// One after another, at most so many. found: told of each probe before the next piece is taken.
std::vector<OneWayDistance::Probe> OneWayDistance::split_all(
    Open& open, int splits, const std::function<void(int, double)>& found) const {
  std::vector<Probe> probes;
  while (static_cast<int>(probes.size()) < splits) {
    const std::vector<Piece> now = open.pop(1);
    if (now.empty()) break;
    std::array<Piece, 2> halves;
    const Probe& probe = probes.emplace_back(split(now[0], halves));
    found(probe.face, std::sqrt(probe.hit.squared_distance));
    for (const Piece& half : halves) open.push(half);
  }
  return probes;
}

void OneWayDistance::find_largest(const Goal& goal) {
  std::vector<int> faces(from_.faces.size());
  std::iota(faces.begin(), faces.end(), 0);
  const std::vector<Hit> vertices = vertex_hits(faces);
  Open open(*this, [this, finest = goal.finest](int) { return max + finest; });
  int done = split_in_groups(vertices, goal, open);
  while (done < goal.splits) {
    context_.checkpoint();
    if (done >= goal.few_splits && open.bound() <= goal.settled) break;
    const std::vector<Piece> now = open.pop(std::min(kAtOnce, static_cast<std::size_t>(goal.splits - done)));
    const int n = static_cast<int>(now.size());
    if (n == 0) break;
    done += n;
    std::vector<Probe> probes(now.size());
    std::vector<std::array<Piece, 2>> pairs(now.size());
    parallel_in_groups(context_, n, kTogether, [&](int i) { probes[i] = split(now[i], pairs[i]); });
    for (const Probe& p : probes) keep(p.point, p.face, p.hit);
    for (const auto& pair : pairs)
      for (const Piece& half : pair) open.push(half);
  }
  at_most = std::max(max, open.bound());
}

// The few splits, shared out among groups of faces that threads take one by one; what they leave is opened.
int OneWayDistance::split_in_groups(const std::vector<Hit>& vertices, const Goal& goal, Open& open) {
  const int n = static_cast<int>(from_.faces.size()), groups = (n + kTogether - 1) / kTogether;
  std::vector<std::vector<Probe>> found(groups);
  std::vector<std::unique_ptr<Open>> left(groups);
  parallel_for(context_, groups, [&](int g) {
    context_.checkpoint();
    const int first = g * kTogether, last = std::min(n, first + kTogether);
    double largest = max;
    left[g] = std::make_unique<Open>(*this, [&](int) { return largest + goal.finest; });
    for (int f = first; f < last; ++f) left[g]->push(whole_face(f, vertices));
    const auto share = static_cast<int>(static_cast<std::int64_t>(goal.few_splits) * (last - first) / n);
    found[g] =
        split_all(*left[g], share, [&](int, double distance) { largest = std::max(largest, distance); });
  });
  int done = 0;
  for (const auto& probes : found)
    for (const Probe& p : probes) keep(p.point, p.face, p.hit), ++done;
  for (const auto& rest : left) open.take(*rest);
  return done;
}

// Groups of both ways in one loop: else the longer way would be left to one thread.
void find_beyond(const std::array<OneWayDistance::Faces, 2>& ways, double limit, int splits,
                 const RunContext& context) {
  struct Group {
    int way, first, count;
    std::vector<OneWayDistance::Probe> found;
  };
  std::vector<Group> groups;
  std::array<std::vector<OneWayDistance::Hit>, 2> vertices;
  for (int w = 0; w < 2; ++w) {
    const int n = static_cast<int>(ways[w].faces.size());
    vertices[w] = ways[w].way.vertex_hits(ways[w].faces);
    for (int i = 0; i < n; i += kTogether) groups.push_back({w, i, std::min(kTogether, n - i), {}});
  }
  parallel_for(context, static_cast<int>(groups.size()), [&](int i) {
    context.checkpoint();
    Group& g = groups[i];
    const auto& [way, faces] = ways[g.way];
    const double share = static_cast<double>(g.count) / static_cast<double>(faces.size());
    g.found = way.probes_beyond(&faces[g.first], g.count, vertices[g.way], limit,
                                static_cast<int>(share * splits) + 1);
  });
  for (const Group& g : groups)
    for (const OneWayDistance::Probe& p : g.found) ways[g.way].way.keep(p.point, p.face, p.hit);
}

// The splits of these faces, which ascend, one after another.
std::vector<OneWayDistance::Probe> OneWayDistance::probes_beyond(const int* faces, int count,
                                                                 const std::vector<Hit>& vertices,
                                                                 double limit, int splits) const {
  std::vector<double> largest(count);
  const auto here = [&](int face) -> double& {
    return largest[std::lower_bound(faces, faces + count, face) - faces];
  };
  Open open(*this, [&](int face) {
    const double so_far = here(face), worse = so_far > kFarBeyond * limit ? kMuchWorse : kWorse;
    return so_far > limit ? so_far + worse * limit : limit;
  });
  for (int i = 0; i < count; ++i) {
    largest[i] = from_face.at(faces[i]);
    open.push(whole_face(faces[i], vertices));
  }
  return split_all(open, splits,
                   [&](int face, double distance) { here(face) = std::max(here(face), distance); });
}

}  // namespace sheetform::certificate
