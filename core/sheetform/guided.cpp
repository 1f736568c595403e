#include "sheetform/guided.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sheetform/base/error.h"
#include "sheetform/mesh/keep_out.h"
#include "sheetform/mesh/place_text.h"
#include "sheetform/mesh/surface_curve.h"

namespace sheetform {
namespace {

constexpr double kReach = 0.05;       // of the diagonal: how far from the mesh strokes may be drawn
constexpr double kLongest = 100;      // diagonals, all strokes together
constexpr double kAlongPlane = 0.75;  // edges: so near to the plane a stroke is taken to run along it
constexpr double kFollowing = 0.002;  // of the diagonal: spacing of the places where the result is looked at
constexpr double kGrazed = 0.01;      // of the radius: so deep a seam may touch a region

[[noreturn]] void refuse(const std::string& what, const std::string& where, const std::string& fix) {
  throw Error(ErrorCode::kInvalidParameter, what, where, fix);
}

std::string stroke_name(const char* list, std::size_t i) {
  return "guides, " + std::string(list) + "[" + std::to_string(i) + "]";
}

std::string percent(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g %%", 100 * x);
  return text;
}

class Checker {
 public:
  Checker(const TriangleSoup& mesh, const RunContext& context)
      : tree_(mesh.points, mesh.faces, context), context_(context) {
    Vector3 lo = Vector3::Constant(1e300), hi = -lo;
    for (const auto& f : mesh.faces)
      for (int v : f) lo = lo.cwiseMin(mesh.points[v]), hi = hi.cwiseMax(mesh.points[v]);
    diagonal_ = (hi - lo).norm();
  }

  void check(const std::vector<Vector3>& points, std::size_t least, const std::string& name) {
    if (points.size() < least)
      refuse("the stroke has " + std::to_string(points.size()) + " points", name,
             "give " + std::to_string(least) + " at least");
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (k % 4096 == 0) context_.checkpoint();
      const std::string where = name + ", point " + std::to_string(k);
      if (!points[k].allFinite()) refuse("a coordinate is not finite", where, "give three numbers");
      const double reach = kReach * diagonal_;
      if (tree_.closest(points[k], reach * reach).face < 0)
        refuse("the point is farther than 5 % of the diagonal from the mesh", where,
               "draw on the surface, in the coordinates of the uploaded mesh");
      if (k > 0) length_ += (points[k] - points[k - 1]).norm();
      if (length_ > kLongest * diagonal_)
        refuse("the strokes are longer than 100 diagonals of the mesh", where,
               "draw fewer or simpler strokes");
    }
  }

 private:
  ClosestPointTree tree_;
  const RunContext& context_;
  double diagonal_ = 0, length_ = 0;
};

Vector3 on_half(const Vector3& p) { return {std::abs(p.x()), p.y(), p.z()}; }

// The polyline folded at x = 0, cut where it crosses.
std::vector<std::vector<Vector3>> fold(std::vector<Vector3> points, bool closed) {
  if (closed) points.push_back(points.front());
  std::vector<std::vector<Vector3>> pieces{{on_half(points.front())}};
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vector3 &a = points[i - 1], &b = points[i];
    if ((a.x() < 0 && b.x() > 0) || (a.x() > 0 && b.x() < 0)) {
      Vector3 at = a + a.x() / (a.x() - b.x()) * (b - a);
      at.x() = 0;
      pieces.back().push_back(at);
      pieces.push_back({at});
    }
    pieces.back().push_back(on_half(b));
  }
  return pieces;
}

// The seams of the result as segments; `wanted`: those that nothing but the search has put there.
ClosestPointTree seam_tree(const StripMesh& strips) {
  std::vector<std::array<int, 3>> segments;
  for (const StripMesh::Arch& arch : strips.arches)
    for (std::size_t i = 0; i + 1 < arch.vertices.size(); ++i)
      segments.push_back({arch.vertices[i], arch.vertices[i + 1], arch.vertices[i + 1]});
  return {strips.points, segments};
}

// What of the seams lies inside of one region.
struct Inside {
  double length = 0, depth = 0;
  Vector3 place = Vector3::Zero();
};

std::vector<Inside> seams_inside(const KeepOut& regions, std::size_t count, const StripMesh& strips,
                                 double step) {
  std::vector<Inside> inside(count);
  for (const StripMesh::Arch& arch : strips.arches) {
    if (arch.drawn || arch.patches[1] < 0) continue;
    for (std::size_t i = 0; i + 1 < arch.vertices.size(); ++i) {
      const Vector3 &a = strips.points[arch.vertices[i]], &b = strips.points[arch.vertices[i + 1]];
      const int n = std::max(1, static_cast<int>(std::ceil((b - a).norm() / step)));
      for (int k = 0; k < n; ++k) {
        int brush = -1;
        const Vector3 p = a + (b - a) * ((k + 0.5) / n);
        const double depth = regions.depth(p, 0, &brush);
        if (brush < 0) continue;
        inside[brush].length += (b - a).norm() / n;
        if (depth > inside[brush].depth) inside[brush].depth = depth, inside[brush].place = p;
      }
    }
  }
  return inside;
}

}  // namespace

void check_guides(const UserGuides& guides, const TriangleSoup& mesh, const RunContext& context) {
  if (guides.empty()) return;
  Checker checker(mesh, context);
  for (std::size_t i = 0; i < guides.seams.size(); ++i)
    checker.check(guides.seams[i].points, guides.seams[i].closed ? 3 : 2, stroke_name("seams", i));
  for (std::size_t i = 0; i < guides.keep_out.size(); ++i) {
    const std::string name = stroke_name("keep_out", i);
    if (!(guides.keep_out[i].radius > 0) || !std::isfinite(guides.keep_out[i].radius))
      refuse("the radius is not above 0", name, "give the half width of the brush in units of the mesh");
    checker.check(guides.keep_out[i].points, 1, name);
  }
}

std::vector<ComponentGuides> guides_by_component(const std::vector<ComponentGuides>& strokes,
                                                 const SurfaceMesh& mesh, const std::vector<int>& component,
                                                 int count) {
  std::vector<ComponentGuides> parts(count);
  if (strokes.empty()) return parts;
  const ClosestPointTree tree(mesh.points, mesh.faces);
  const auto of = [&](const Vector3& p) { return component[tree.closest(p).face]; };
  for (const ComponentGuides& all : strokes) {
    for (std::size_t i = 0; i < all.guides.seams.size(); ++i) {
      SeamStroke piece{{}, all.guides.seams[i].closed};
      int at = of(all.guides.seams[i].points.front());
      const auto close = [&] {
        if (piece.points.size() < 2) return;
        parts[at].guides.seams.push_back(piece);
        parts[at].seam.push_back(all.seam[i]);
      };
      for (const Vector3& p : all.guides.seams[i].points) {
        if (const int next = of(p); next != at) {
          piece.closed = false;
          close();
          piece.points.clear(), at = next;
        }
        piece.points.push_back(p);
      }
      close();
    }
    for (const BrushStroke& brush : all.guides.keep_out) {
      std::vector<BrushStroke> pieces(count, BrushStroke{{}, brush.radius});
      for (const Vector3& p : brush.points) pieces[of(p)].points.push_back(p);
      for (int c = 0; c < count; ++c)
        if (!pieces[c].points.empty()) parts[c].guides.keep_out.push_back(pieces[c]);
    }
  }
  return parts;
}

std::vector<ComponentGuides> unfolded(const UserGuides& guides) {
  ComponentGuides all{guides, {}};
  for (std::size_t i = 0; i < guides.seams.size(); ++i) all.seam.push_back(static_cast<int>(i));
  return {all};
}

std::vector<ComponentGuides> folded(const UserGuides& guides) {
  ComponentGuides half;
  for (std::size_t i = 0; i < guides.seams.size(); ++i) {
    const auto pieces = fold(guides.seams[i].points, guides.seams[i].closed);
    for (const auto& points : pieces) {
      const bool whole = pieces.size() == 1 && guides.seams[i].closed;
      if (points.size() < 2) continue;
      half.guides.seams.push_back({points, whole});
      half.seam.push_back(static_cast<int>(i));
    }
  }
  for (const BrushStroke& brush : guides.keep_out)
    for (const auto& points : fold(brush.points, false))
      half.guides.keep_out.push_back({points, brush.radius});
  return {half};
}

std::vector<char> drawn_on_plane(const SurfaceMesh& half, const std::vector<SeamStroke>& seams) {
  if (seams.empty()) return {};
  const double edge = mean_edge_length(half), near = kAlongPlane * edge;
  const ClosestPointTree surface(half.points, half.faces);
  std::vector<char> drawn(half.edges.size(), 0);
  for (const SeamStroke& seam : seams) {
    const ClosestPointTree tree =
        curve_tree(curve_on_surface(surface, seam.points, seam.closed, 0.25 * edge));
    for (int e = 0; e < half.edge_count(); ++e) {
      const Vector3 &a = half.points[half.edges[e].v0], &b = half.points[half.edges[e].v1];
      if (!half.edges[e].border() || std::abs(a.x()) + std::abs(b.x()) > 1e-9) continue;
      const ClosestPoint at_a = tree.closest(a, near * near), at_b = tree.closest(b, near * near);
      drawn[e] |= at_a.face >= 0 && at_b.face >= 0 && (at_a.point - at_b.point).norm() > 0.6 * (a - b).norm();
    }
  }
  return drawn;
}

std::vector<std::string> unmet_guides(const UserGuides& guides, const SurfaceMesh& mesh,
                                      const StripMesh& strips, double reach, const RunContext& context) {
  std::vector<std::string> notes;
  if (guides.empty()) return notes;
  const double diagonal = bounding_box_diagonal(mesh.points), step = kFollowing * diagonal;
  const ClosestPointTree surface(mesh.points, mesh.faces, context), seams = seam_tree(strips);
  for (std::size_t i = 0; i < guides.seams.size() && !seams.empty(); ++i) {
    double worst = 0;
    Vector3 place = Vector3::Zero();
    for (const CurvePoint& p :
         curve_on_surface(surface, guides.seams[i].points, guides.seams[i].closed, step)) {
      const double d = std::sqrt(seams.closest(p.point).squared_distance);
      if (d > worst) worst = d, place = p.point;
    }
    if (worst > reach)
      notes.push_back("seams[" + std::to_string(i) + "] as drawn is up to " + percent(worst / diagonal) +
                      " of the diagonal away from the seams of the result, at " + text_of(place));
  }
  const KeepOut regions(mesh, guides.keep_out, step, context);
  const std::vector<Inside> inside = seams_inside(regions, guides.keep_out.size(), strips, step);
  for (std::size_t i = 0; i < inside.size(); ++i)
    if (inside[i].depth > kGrazed * guides.keep_out[i].radius)
      notes.push_back("keep_out[" + std::to_string(i) +
                      "] could not be kept free: " + percent(inside[i].length / diagonal) +
                      " of the diagonal of seams run through it, at " + text_of(inside[i].place));
  return notes;
}

}  // namespace sheetform
