#include "sheetform/mesh/remesher.h"

#include <OpenMesh/Core/System/omstream.hh>
#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "sheetform/base/error.h"

namespace sheetform {
namespace {

constexpr int kRounds = 5, kMostCleanings = 20;
constexpr double kLong = 4.0 / 3, kShort = 4.0 / 5;  // of the wanted length (Botsch and Kobbelt 2004)
constexpr double kChord =
    0.6;  // of the wanted length: a longer edge between two lines is to have a vertex between
constexpr double kLineSag = 0.25;  // of the wanted length: how far a removed vertex of a line may lie off it
constexpr double kLoss =
    0.3;  // of the wanted length: how far removed vertices or edges may come to lie off the surface
constexpr double kStepLoss =
    0.05;  // of the wanted length: the same for one step of relaxation (tips would melt away)
constexpr double kShorter = 0.9;  // of a split edge: how long its halves may be
constexpr double kThin = 0.1;     // height / longest side; 0.87 is equilateral
constexpr double kFlat = 1e-3;    // the same, of what says nothing about the surface

// Height over the longest side, divided by that side.
double fatness(const Vector3& a, const Vector3& b, const Vector3& c) {
  const double longest2 = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return longest2 > 0 ? (b - a).cross(c - a).norm() / longest2 : 0;
}

// Of normals, of any length.
bool turns_over(const Vector3& old, const Vector3& now) {
  return now.dot(old) <= 0.3 * now.norm() * old.norm();
}

double distance_to_segment(const Vector3& p, const Vector3& a, const Vector3& b) {
  const Vector3 d = b - a;
  const double length2 = d.squaredNorm();
  const double t = length2 > 0 ? std::clamp((p - a).dot(d) / length2, 0.0, 1.0) : 0;
  return (p - a - t * d).norm();
}

// Between the lines through a and b and through c and d.
double line_distance(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  const Vector3 across = (b - a).cross(d - c);
  return std::abs(across.dot(c - a)) / std::max(across.norm(), 1e-300);
}

struct Entry {
  double length;
  int edge;
  bool operator<(const Entry& o) const { return length < o.length || (length == o.length && edge > o.edge); }
  bool operator>(const Entry& o) const { return o < *this; }
};

}  // namespace

Remesher::Remesher(const SurfaceMesh& input, const FeatureLines& lines, double length,
                   const RunContext& context, double most_loss)
    : lines_(lines), length_(length), context_(context), most_loss_(std::min(most_loss, kLoss * length)) {
  load(input);
}

void Remesher::load(const SurfaceMesh& input) {
  [[maybe_unused]] static const bool quiet =
      (omerr().disable(), true);  // once: the stream is shared by all threads
  mesh_.reserve(input.points.size(), input.edges.size(), input.faces.size());
  for (const Vector3& p : input.points) add_vertex(p, kFree);
  for (const auto& f : input.faces) {
    pause();
    if (!mesh_.add_face(Vertex(f[0]), Vertex(f[1]), Vertex(f[2])).is_valid())
      throw Error(ErrorCode::kInternal, "the half-edge mesh refuses a face");
  }
  edge_line_.assign(mesh_.n_edges(), -1);
  for (int e = 0; e < input.edge_count(); ++e) {
    if (lines_.edge_line[e] < 0) continue;
    const Half h = mesh_.find_halfedge(Vertex(input.edges[e].v0), Vertex(input.edges[e].v1));
    line(mesh_.edge_handle(h)) = lines_.edge_line[e];
    kinds_[input.edges[e].v0] = kinds_[input.edges[e].v1] = kOnLine;
  }
  for (int v = 0; v < input.vertex_count(); ++v)
    if (lines_.corner[v]) kinds_[v] = kCorner;
  const double faces = surface_area(input) / (std::sqrt(3.0) / 4 * length_ * length_);
  most_vertices_ = static_cast<int>(std::min(4.0 * (faces + input.vertex_count()) + 1000, 2e7));
}

OpenMesh::VertexHandle Remesher::add_vertex(const Vector3& p, Kind kind) {
  points_.push_back(p);
  kinds_.push_back(kind);
  losses_.push_back(0);
  return mesh_.new_vertex();
}

void Remesher::pause() {
  if (++operations_ % 4096 == 0) context_.checkpoint();
}

double Remesher::length_of(Edge e) const {
  const Half h = mesh_.halfedge_handle(e, 0);
  return (point(mesh_.to_vertex_handle(h)) - point(mesh_.from_vertex_handle(h))).norm();
}

Vector3 Remesher::raw_normal(Face f) const {
  const Half h = mesh_.halfedge_handle(f);
  const Vector3& a = point(mesh_.from_vertex_handle(h));
  const Vector3& b = point(mesh_.to_vertex_handle(h));
  const Vector3& c = point(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h)));
  return (b - a).cross(c - a);
}

Vector3 Remesher::vertex_normal(Vertex v) const {
  Vector3 sum = Vector3::Zero();
  for (const Face f : mesh_.vf_range(v)) sum += raw_normal(f);
  return sum;
}

// Projects, but not to the far side of a thin wall.
Vector3 Remesher::on_surface(const Vector3& p, const Vector3& normal) const {
  const ClosestPoint c = tree_->closest(p, 4 * length_ * length_);
  if (c.face < 0) return p;
  return surface_->face_normal_raw(c.face).dot(normal) >= 0 ? c.point : p;
}

// An edge inside whose ends both lie on lines: no path can pass between them.
bool Remesher::is_chord(Edge e) const {
  const Half h = mesh_.halfedge_handle(e, 0);
  return line(e) < 0 && kind(mesh_.from_vertex_handle(h)) != kFree &&
         kind(mesh_.to_vertex_handle(h)) != kFree;
}

double Remesher::longest_allowed(Edge e) const {
  return is_chord(e) ? (kChord + kShort) / 2 * length_ : kLong * length_;
}

void Remesher::split_long() {
  std::priority_queue<Entry> queue;
  auto push = [&](Edge e) {
    if (mesh_.status(e).deleted()) return;
    const double length = length_of(e);
    if (length > longest_allowed(e)) queue.push({length, e.idx()});
  };
  for (int e = 0; e < static_cast<int>(mesh_.n_edges()); ++e) push(Edge(e));
  while (!queue.empty() && static_cast<int>(mesh_.n_vertices()) < most_vertices_) {
    const Edge e(queue.top().edge);
    const double length = queue.top().length;
    queue.pop();
    if (length_of(e) != length) continue;  // has been split meanwhile
    split(e);
    for (const Edge around : mesh_.ve_range(Vertex(static_cast<int>(mesh_.n_vertices()) - 1))) push(around);
    pause();
  }
}

// Whether no edge to `p`, were the edge split there, is longer than what it comes from. Where the nearest
// point of the surface is elsewhere it may be, and splitting has no end.
bool Remesher::shortens(Half h, const Vector3& p) const {
  const Vector3 &a = point(mesh_.from_vertex_handle(h)), &b = point(mesh_.to_vertex_handle(h));
  if (std::max((p - a).norm(), (p - b).norm()) > kShorter * (b - a).norm()) return false;
  for (const Half side : {h, mesh_.opposite_halfedge_handle(h)}) {
    if (mesh_.is_boundary(side)) continue;
    const Vector3& c = point(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(side)));
    if ((p - c).norm() > std::max((a - c).norm(), (b - c).norm())) return false;
  }
  return true;
}

// Fatness of the thinnest face there would be, were the edge split at `p`.
double Remesher::thinnest(Half h, const Vector3& p) const {
  double least = 1;
  for (const Half side : {h, mesh_.opposite_halfedge_handle(h)}) {
    if (mesh_.is_boundary(side)) continue;
    const Vector3& c = point(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(side)));
    for (const Vertex v : {mesh_.from_vertex_handle(h), mesh_.to_vertex_handle(h)})
      least = std::min(least, fatness(point(v), p, c));
  }
  return least;
}

// Whether no face, were the edge split at `p`, turns over or becomes a sliver that it would not be with the
// middle: a bend of the line may lie at the third vertex of a face, or beyond.
bool Remesher::keeps_faces(Half h, const Vector3& p) const {
  const Vector3 &a = point(mesh_.from_vertex_handle(h)), &b = point(mesh_.to_vertex_handle(h));
  const double before = thinnest(h, (a + b) / 2), after = thinnest(h, p);
  if (after <= kThin && after < before) return false;
  if (before <= kFlat) return true;
  for (const Half side : {h, mesh_.opposite_halfedge_handle(h)}) {
    if (mesh_.is_boundary(side)) continue;
    const Vector3& c = point(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(side)));
    const Vector3 old = (b - a).cross(c - a);
    if (turns_over(old, (p - a).cross(c - a)) || turns_over(old, (b - p).cross(c - p))) return false;
  }
  return true;
}

void Remesher::split(Edge e) {
  const Half h = mesh_.halfedge_handle(e, 0);
  const Vertex a = mesh_.from_vertex_handle(h), b = mesh_.to_vertex_handle(h);
  const int on = line(e);
  Vector3 p = (point(a) + point(b)) / 2;
  if (on >= 0) {
    const Vector3 q = lines_.project(on, p);
    if (keeps_faces(h, q)) p = q;
  } else {
    Vector3 normal = Vector3::Zero();
    for (const Half side : {h, mesh_.opposite_halfedge_handle(h)})
      if (!mesh_.is_boundary(side)) normal += raw_normal(mesh_.face_handle(side));
    const Vector3 q = on_surface(p, normal);
    if (shortens(h, q) && thinnest(h, q) > kFlat) p = q;
  }
  const Vertex v = add_vertex(p, on >= 0 ? kOnLine : kFree);
  mesh_.split(e, v);
  edge_line_.resize(mesh_.n_edges(), -1);
  for (const Half out : mesh_.voh_range(v)) {
    const Vertex to = mesh_.to_vertex_handle(out);
    line(mesh_.edge_handle(out)) = to == a || to == b ? on : -1;
  }
}

// first: the input may have long thin triangles all around, whose edges must not keep short ones from going.
void Remesher::collapse_short(bool first) {
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  std::vector<double> queued(mesh_.n_edges(), -1);  // the length with which an edge waits
  auto push = [&](Edge e) {
    const double length = length_of(e);
    double& waits = queued[static_cast<std::size_t>(e.idx())];
    if (length >= kShort * length_ || waits == length) return;
    waits = length;
    queue.push({length, e.idx()});
  };
  for (int e = 0; e < static_cast<int>(mesh_.n_edges()); ++e)
    if (!mesh_.status(Edge(e)).deleted()) push(Edge(e));
  while (!queue.empty()) {
    const Edge e(queue.top().edge);
    const double length = queue.top().length;
    queue.pop();
    pause();
    double& waits = queued[static_cast<std::size_t>(e.idx())];
    if (waits == length) waits = -1;
    if (mesh_.status(e).deleted() || length_of(e) != length) continue;
    const Half h = best_collapse(e, first);
    if (!h.is_valid()) continue;
    const Vertex stays = mesh_.to_vertex_handle(h);
    collapse(h);
    for (const Edge around : mesh_.ve_range(stays)) push(around);
  }
}

// The direction in which the edge may be collapsed; of two the one that leaves shorter edges.
OpenMesh::HalfedgeHandle Remesher::best_collapse(Edge e, bool first) {
  struct Way {
    Half h;
    double longest = 0, limit = 0;
  };
  std::array<Way, 2> ways;
  for (int side = 0; side < 2; ++side) {
    Way& way = ways[side];
    way.h = mesh_.halfedge_handle(e, side);
    const Vector3 &gone = point(mesh_.from_vertex_handle(way.h)),
                  &stays = point(mesh_.to_vertex_handle(way.h));
    double now = 0;
    for (const Vertex v : mesh_.vv_range(mesh_.from_vertex_handle(way.h))) {
      way.longest = std::max(way.longest, (point(v) - stays).norm());
      now = std::max(now, (point(v) - gone).norm());
    }
    way.limit = first ? std::max(kLong * length_, 1.2 * now) : kLong * length_;
  }
  if (ways[1].longest < ways[0].longest) std::swap(ways[0], ways[1]);
  for (const Way& way : ways)
    if (way.longest <= way.limit && may_collapse(way.h)) return way.h;
  return Half();
}

bool Remesher::may_collapse(Half h) {
  const Vertex gone = mesh_.from_vertex_handle(h);
  if (kind(gone) == kCorner || (kind(gone) == kOnLine && line(mesh_.edge_handle(h)) < 0)) return false;
  return !ends_tetrahedron(h) && keeps_lines(h) && keeps_shape(h) && mesh_.is_collapse_ok(h);
}

// Of a tetrahedron two faces back to back would stay, which is no surface (and fine for is_collapse_ok).
bool Remesher::ends_tetrahedron(Half h) const {
  const Vertex gone = mesh_.from_vertex_handle(h), stays = mesh_.to_vertex_handle(h);
  return mesh_.valence(gone) == 3 && mesh_.valence(stays) == 3 && !mesh_.is_boundary(gone) &&
         !mesh_.is_boundary(stays);
}

// No two lines may fall together, no line may cut its bends short, no long chord may arise.
bool Remesher::keeps_lines(Half h) const {
  const Vertex gone = mesh_.from_vertex_handle(h), stays = mesh_.to_vertex_handle(h);
  for (const Half side : {h, mesh_.opposite_halfedge_handle(h)}) {
    if (mesh_.is_boundary(side)) continue;
    const Edge a = mesh_.edge_handle(mesh_.next_halfedge_handle(side)),
               b = mesh_.edge_handle(mesh_.prev_halfedge_handle(side));
    if (line(a) >= 0 && line(b) >= 0) return false;
  }
  for (const Half out : mesh_.voh_range(gone)) {
    const Vertex v = mesh_.to_vertex_handle(out);
    if (v == stays) continue;
    const double length = (point(v) - point(stays)).norm();
    if (line(mesh_.edge_handle(out)) >= 0) {
      if (distance_to_segment(point(gone), point(v), point(stays)) > kLineSag * length_) return false;
    } else if (kind(gone) == kFree && kind(v) != kFree && kind(stays) != kFree && length > kChord * length_) {
      return false;
    }
  }
  return true;
}

// No face may turn over or become thinner than the thinnest one was, and the surface stays near.
bool Remesher::keeps_shape(Half h) const {
  const Vertex gone = mesh_.from_vertex_handle(h), stays = mesh_.to_vertex_handle(h);
  const Vector3& p = point(stays);
  const Vector3 around = vertex_normal(gone);
  double before = 1, after = 1;
  for (const Half out : mesh_.voh_range(gone)) {
    const Vertex v = mesh_.to_vertex_handle(out);
    if (mesh_.is_boundary(out)) continue;
    const Vertex w = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(out));
    const Vector3 old = raw_normal(mesh_.face_handle(out));
    before = std::min(before, fatness(point(gone), point(v), point(w)));
    if (v == stays || w == stays) continue;
    const Vector3 now = (point(v) - p).cross(point(w) - p);
    const bool flat = fatness(point(gone), point(v), point(w)) < kFlat;
    const Vector3& reference = flat ? around : old;
    if (turns_over(reference, now)) return false;
    after = std::min(after, fatness(p, point(v), point(w)));
  }
  return (after > kThin || after >= before) && loss(h) < most_loss_;
}

// Bound of the distance between what `h` and the collapses before it removed and what is left.
double Remesher::loss(Half h) const {
  const Vertex gone = mesh_.from_vertex_handle(h), stays = mesh_.to_vertex_handle(h);
  double nearest = std::numeric_limits<double>::infinity();
  for (const Half out : mesh_.voh_range(gone)) {
    const Vertex v = mesh_.to_vertex_handle(out), w = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(out));
    if (mesh_.is_boundary(out) || v == stays || w == stays) continue;
    nearest = std::min(nearest, distance_to_triangle(point(gone), point(stays), point(v), point(w)));
  }
  if (!std::isfinite(nearest)) nearest = (point(gone) - point(stays)).norm();
  return std::max(losses_[static_cast<std::size_t>(stays.idx())],
                  losses_[static_cast<std::size_t>(gone.idx())] + nearest);
}

void Remesher::collapse(Half h) {
  const Vertex stays = mesh_.to_vertex_handle(h);
  std::array<std::pair<Vertex, int>, 2>
      merged;  // third vertices of the two faces, and the line of the edge that is left
  int count = 0;
  for (const Half side : {h, mesh_.opposite_halfedge_handle(h)}) {
    if (mesh_.is_boundary(side)) continue;
    const Half a = mesh_.next_halfedge_handle(side), b = mesh_.prev_halfedge_handle(side);
    merged[count++] = {mesh_.to_vertex_handle(a),
                       std::max(line(mesh_.edge_handle(a)), line(mesh_.edge_handle(b)))};
  }
  losses_[static_cast<std::size_t>(stays.idx())] = loss(h);
  mesh_.collapse(h);
  for (int i = 0; i < count; ++i) {
    const Half left = mesh_.find_halfedge(stays, merged[i].first);
    if (left.is_valid()) line(mesh_.edge_handle(left)) = merged[i].second;
  }
}

void Remesher::flip_edges() {
  for (int i = 0; i < static_cast<int>(mesh_.n_edges()); ++i) {
    const Edge e(i);
    if (mesh_.status(e).deleted() || line(e) >= 0 || mesh_.is_boundary(e)) continue;
    pause();
    if (should_flip(e) && mesh_.is_flip_ok(e)) mesh_.flip(e);
  }
}

bool Remesher::should_flip(Edge e) const {
  const Half h = mesh_.halfedge_handle(e, 0), o = mesh_.halfedge_handle(e, 1);
  const Vertex a = mesh_.from_vertex_handle(h), b = mesh_.to_vertex_handle(h);
  const Vertex c = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h)),
               d = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(o));
  const Vector3 &pa = point(a), &pb = point(b), &pc = point(c), &pd = point(d);
  const Vector3 n1 = raw_normal(mesh_.face_handle(h)), n2 = raw_normal(mesh_.face_handle(o)), n = n1 + n2;
  const Vector3 m1 = (pd - pc).cross(pb - pc), m2 = (pa - pc).cross(pd - pc);
  if (m1.dot(n) <= 0.5 * m1.norm() * n.norm() || m2.dot(n) <= 0.5 * m2.norm() * n.norm()) return false;
  if (line_distance(pa, pb, pc, pd) > most_loss_) return false;  // large triangles of a coarse input
  const bool new_chord = kind(c) != kFree && kind(d) != kFree;
  if (new_chord && !is_chord(e) && (pc - pd).norm() > kChord * length_) return false;
  const double before = std::min(fatness(pa, pb, pc), fatness(pa, pb, pd)),
               after = std::min(fatness(pc, pd, pb), fatness(pc, pd, pa));
  if (before < 0.3 && after > 1.5 * before) return true;
  if (is_chord(e) && !new_chord && after > 0.3) return true;
  if (n1.dot(n2) < 0.8 * n1.norm() * n2.norm())
    return false;  // the surface bends here: flipping would change it
  if (after <= 0.5 * before || after <= kThin) return false;
  int more = 0;  // of the squares of what valences are off
  const auto change = [&](Vertex v, int by) {
    const int off = static_cast<int>(mesh_.valence(v)) - (mesh_.is_boundary(v) ? 4 : 6);
    more += (off + by) * (off + by) - off * off;
  };
  change(a, -1), change(b, -1), change(c, 1), change(d, 1);
  return more < 0;
}

void Remesher::relax() {
  for (int i = 0; i < static_cast<int>(mesh_.n_vertices()); ++i) {
    const Vertex v(i);
    if (mesh_.status(v).deleted()) continue;
    if (kind(v) == kFree)
      move_free(v);
    else if (kind(v) == kOnLine)
      move_on_line(v);
    pause();
  }
}

// To the centre of gravity of the faces around, within the tangent plane, then back to the surface.
void Remesher::move_free(Vertex v) {
  Vector3 centre = Vector3::Zero(), normal = Vector3::Zero();
  double weight = 0;
  for (const Half h : mesh_.voh_range(v)) {
    if (mesh_.is_boundary(h)) continue;
    const Vector3& a = point(mesh_.to_vertex_handle(h));
    const Vector3& b = point(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h)));
    const Vector3 n = (a - point(v)).cross(b - point(v));
    const double area = n.norm();
    centre += area * (a + b + point(v)) / 3;
    normal += n;
    weight += area;
  }
  if (!(weight > 0) || !(normal.norm() > 0)) return;
  Vector3 step = centre / weight - point(v);
  const Vector3 up = normal.normalized();
  step -= up * up.dot(step);
  move(v, on_surface(point(v) + step, normal));
}

void Remesher::move_on_line(Vertex v) {
  Vector3 sum = Vector3::Zero();
  int on = -1, neighbours = 0;
  for (const Half h : mesh_.voh_range(v))
    if (line(mesh_.edge_handle(h)) >= 0) {
      on = line(mesh_.edge_handle(h));
      sum += point(mesh_.to_vertex_handle(h));
      ++neighbours;
    }
  if (neighbours == 2) move(v, lines_.project(on, (point(v) + sum / 2) / 2));
}

// Moves unless a face would turn over or become a sliver.
bool Remesher::move(Vertex v, const Vector3& to) {
  const Vector3 from = point(v);
  double before = 1, after = 1, lost = std::numeric_limits<double>::infinity();
  for (const Half h : mesh_.voh_range(v)) {
    if (mesh_.is_boundary(h)) continue;
    const Vector3& a = point(mesh_.to_vertex_handle(h));
    const Vector3& b = point(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h)));
    lost = std::min(lost, distance_to_triangle(from, to, a, b));
    const Vector3 old = (a - from).cross(b - from), now = (a - to).cross(b - to);
    before = std::min(before, fatness(from, a, b));
    after = std::min(after, fatness(to, a, b));
    if (before > kFlat && turns_over(old, now)) return false;
  }
  if ((after < kThin && after < before) || lost > kStepLoss * length_) return false;
  points_[static_cast<std::size_t>(v.idx())] = to;
  return true;
}

void Remesher::run(const SurfaceMesh& surface, const ClosestPointTree& tree) {
  surface_ = &surface, tree_ = &tree;
  for (int round = 0; round < kRounds; ++round) {
    if (round == 0) {
      collapse_short(true);
      flip_edges();
    }
    split_long();
    collapse_short(false);
    flip_edges();
    relax();
    context_.checkpoint();
  }
  flip_edges();
  relax();
}

void Remesher::clean() {
  for (int round = 0; round < kMostCleanings; ++round) {
    collapse_short(true);
    int flips = 0;
    for (int i = 0; i < static_cast<int>(mesh_.n_faces()); ++i) flips += flip_cap(Face(i));
    context_.checkpoint();
    if (flips == 0) break;
  }
}

// A triangle without height but without a short side either loses its longest side. Changes the surface by
// its height.
bool Remesher::flip_cap(Face f) {
  if (mesh_.status(f).deleted()) return false;
  pause();
  Half longest;
  double length = 0;
  for (const Half h : mesh_.fh_range(f))
    if (length_of(mesh_.edge_handle(h)) > length) length = length_of(mesh_.edge_handle(h)), longest = h;
  if (!longest.is_valid() || raw_normal(f).norm() >= kShort * length_ * length) return false;
  const Edge e = mesh_.edge_handle(longest);
  if (line(e) >= 0 || mesh_.is_boundary(e) || !mesh_.is_flip_ok(e)) return false;
  const Half o = mesh_.opposite_halfedge_handle(longest);
  const Vector3 &pa = point(mesh_.from_vertex_handle(longest)), &pb = point(mesh_.to_vertex_handle(longest));
  const Vector3& pc = point(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(longest)));
  const Vector3& pd = point(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(o)));
  const Vector3 n = raw_normal(f) + raw_normal(mesh_.face_handle(o)), m1 = (pd - pc).cross(pb - pc),
                m2 = (pa - pc).cross(pd - pc);
  if (m1.dot(n) <= 0.5 * m1.norm() * n.norm() || m2.dot(n) <= 0.5 * m2.norm() * n.norm()) return false;
  const double before = std::min(fatness(pa, pb, pc), fatness(pa, pb, pd)),
               after = std::min(fatness(pc, pd, pb), fatness(pc, pd, pa));
  if (after <= 1.5 * before) return false;
  mesh_.flip(e);
  return true;
}

SurfaceMesh Remesher::result(std::vector<char>& crease_edge) const {
  std::vector<int> id(mesh_.n_vertices(), -1);
  std::vector<Vector3> points;
  std::vector<std::array<int, 3>> faces;
  for (const Vertex v : mesh_.vertices()) {
    if (mesh_.status(v).deleted()) continue;
    id[v.idx()] = static_cast<int>(points.size());
    points.push_back(point(v));
  }
  for (const Face f : mesh_.faces()) {
    std::array<int, 3> t{};
    int k = 0;
    for (const Vertex v : mesh_.fv_range(f)) t[k++] = id[v.idx()];
    faces.push_back(t);
  }
  SurfaceMesh mesh = build_surface_mesh(std::move(points), std::move(faces));
  crease_edge.assign(mesh.edges.size(), 0);
  for (const Edge e : mesh_.edges()) {
    if (line(e) < 0 || mesh_.is_boundary(e)) continue;
    const Half h = mesh_.halfedge_handle(e, 0);
    crease_edge[mesh.find_edge(id[mesh_.from_vertex_handle(h).idx()], id[mesh_.to_vertex_handle(h).idx()])] =
        1;
  }
  return mesh;
}

}  // namespace sheetform
