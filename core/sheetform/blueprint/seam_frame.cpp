#include "sheetform/blueprint/seam_frame.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <set>

#include "sheetform/blueprint/option_limits.h"
#include "sheetform/blueprint/stroke_font.h"

namespace sheetform {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Triangles as STL keeps them: 50 bytes each, little-endian floats.
class StlWriter {
 public:
  void triangle(const Vector3& a, const Vector3& b, const Vector3& c) {
    const Vector3 n = (b - a).cross(c - a).stableNormalized();
    for (const Vector3* p : {&n, &a, &b, &c})
      for (int k = 0; k < 3; ++k) put(std::bit_cast<std::uint32_t>(static_cast<float>((*p)[k])), 4);
    put(0, 2);
    ++count_;
  }
  std::string finish(const std::string& title) {
    std::string out = title.substr(0, 80);
    out.resize(80, ' ');
    std::swap(out, body_);
    put(count_, 4);
    return body_ + out;
  }

 private:
  void put(std::uint32_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) body_ += static_cast<char>((value >> (8 * i)) & 0xFF);
  }
  std::string body_;
  std::uint32_t count_ = 0;
};

using Ring = std::vector<Vector3>;

Ring ring_around(const Vector3& center, const Vector3& u, const Vector3& v, double radius, int sides) {
  Ring ring;
  for (int i = 0; i < sides; ++i) {
    const double a = 2 * kPi * i / sides;
    ring.push_back(center + radius * (std::cos(a) * u + std::sin(a) * v));
  }
  return ring;
}

// Side walls between two rings; counter-clockwise seen from outside when the rings turn so about the way from
// a to b.
void join(StlWriter& out, const Ring& a, const Ring& b) {
  for (std::size_t i = 0, j = a.size() - 1; i < a.size(); j = i++)
    out.triangle(a[j], a[i], b[i]), out.triangle(a[j], b[i], b[j]);
}

void cap(StlWriter& out, const Ring& ring, const Vector3& center, bool front) {
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    if (front)
      out.triangle(center, ring[j], ring[i]);
    else
      out.triangle(center, ring[i], ring[j]);
  }
}

Vector3 across(const Vector3& d) {
  const Vector3 axis = std::abs(d.x()) < 0.8 ? Vector3::UnitX() : Vector3::UnitY();
  return d.cross(axis).normalized();
}

// A tube along a polyline; its section is carried along without twist and cut at the bisecting planes.
void rod(StlWriter& out, const std::vector<Vector3>& line, double radius, int sides) {
  std::vector<Vector3> p;
  for (const Vector3& q : line)
    if (p.empty() || (q - p.back()).norm() > 1e-6) p.push_back(q);
  if (p.size() < 2) return;
  Vector3 d = (p[1] - p[0]).normalized(), u = across(d);
  Ring before;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vector3 next = i + 1 < p.size() ? Vector3((p[i + 1] - p[i]).normalized()) : d;
    const Vector3 mean = (d + next).norm() > 1e-6 ? Vector3((d + next).normalized()) : d;
    u = (u - u.dot(mean) * mean).norm() > 1e-6 ? Vector3((u - u.dot(mean) * mean).normalized())
                                               : across(mean);
    const Ring ring = ring_around(p[i], u, mean.cross(u), radius, sides);
    if (i == 0)
      cap(out, ring, p[i], false);
    else
      join(out, before, ring);
    before = ring;
    d = next;
  }
  cap(out, before, p.back(), true);
}

void ball(StlWriter& out, const Vector3& center, double radius, int sides) {
  const int rings = std::max(2, sides / 2);
  Ring before;
  for (int i = 1; i < rings; ++i) {
    const double a = kPi * i / rings;
    const Vector3 middle = center - radius * std::cos(a) * Vector3::UnitZ();
    const Ring ring = ring_around(middle, Vector3::UnitX(), Vector3::UnitY(), radius * std::sin(a), sides);
    if (i == 1)
      cap(out, ring, center - radius * Vector3::UnitZ(), false);
    else
      join(out, before, ring);
    before = ring;
  }
  cap(out, before, center + radius * Vector3::UnitZ(), true);
}

// Strokes of a text in the plane of `right` and `up` as thin rods, joined to `foot` by a bar below them.
void raised_text(StlWriter& out, const std::string& text, double height, const Vector3& foot,
                 const Vector3& right, const Vector3& up, double gap) {
  const StrokeText strokes = stroke_text(text, height);
  const auto at = [&](const Vector2& p) {
    return Vector3(foot + (p.x() - strokes.width / 2) * right + (gap + p.y()) * up);
  };
  const double thickness = height / 10;
  for (const std::vector<Vector2>& line : strokes.lines) {
    std::vector<Vector3> points;
    for (const Vector2& p : line) points.push_back(at(p));
    rod(out, points, thickness, 6);
  }
  rod(out, {at({-thickness, -thickness}), at({strokes.width + thickness, -thickness})}, 1.5 * thickness, 6);
  rod(out, {foot, at({strokes.width / 2, -thickness})}, 1.5 * thickness, 6);
}

// Mean normal of the faces at the middle of an arch: the numbers stand up along it.
Vector3 normal_at(const Blueprint& b, int vertex, const std::array<int, 2>& patches) {
  Vector3 normal = Vector3::Zero();
  const std::vector<Vector3>& p = b.strips.points;
  for (int patch : patches)
    if (patch >= 0)
      for (const StripMesh::Triangle& t : b.strips.patches[patch].triangles)
        if (t.v[0] == vertex || t.v[1] == vertex || t.v[2] == vertex)
          normal += (p[t.v[1]] - p[t.v[0]]).cross(p[t.v[2]] - p[t.v[0]]).stableNormalized();
  return normal.norm() > 0 ? Vector3(normal.normalized()) : Vector3::UnitZ();
}

// What stands beside a rod: the parts on both sides and the seam's number, on short rods the number alone; at
// the border the part.
std::vector<std::string> texts_of(const Blueprint& b, const StripMesh::Arch& arch, int number) {
  const std::string first = b.parts[arch.patches[0]].label;
  if (number == 0) return {first};
  const std::string digits = std::to_string(number);
  return {first + '/' + b.parts[arch.patches[1]].label + ':' + digits, digits};
}

void add_text(StlWriter& out, const Blueprint& b, const StripMesh::Arch& arch, int number,
              const FrameOptions& o) {
  double length = 0;
  for (std::size_t i = 0; i + 1 < arch.vertices.size(); ++i)
    length += b.scale * (b.strips.points[arch.vertices[i + 1]] - b.strips.points[arch.vertices[i]]).norm();
  const std::vector<std::string> texts = texts_of(b, arch, number);
  const auto text = std::find_if(texts.begin(), texts.end(), [&](const std::string& t) {
    return stroke_text_width(t, o.text_height) <= 0.8 * length;
  });
  if (number == 0 && text == texts.end()) return;
  const std::size_t k = (arch.vertices.size() - 1) / 2;
  const Vector3 p = b.scale * b.strips.points[arch.vertices[k]],
                q = b.scale * b.strips.points[arch.vertices[k + 1]];
  const Vector3 along = (q - p).stableNormalized();
  Vector3 up = normal_at(b, arch.vertices[k], arch.patches);
  up -= up.dot(along) * along;
  if (!(up.norm() > 1e-9)) up = across(along);
  raised_text(out, text == texts.end() ? texts.back() : *text, o.text_height, (p + q) / 2, along,
              up.normalized(), o.radius + o.text_height / 5);
}

}  // namespace

std::string to_seam_frame_stl(const Blueprint& b, const FrameOptions& o) {
  require_in_range(o.radius, "frame_radius"), require_in_range(o.text_height, "frame_text");
  require_in_range(o.sides, "frame_sides");
  StlWriter out;
  std::set<int> nodes;
  for (const StripMesh::Arch& arch : b.strips.arches) {
    if (arch.patches[1] < 0 && !o.borders) continue;
    std::vector<Vector3> line;
    for (int v : arch.vertices) line.push_back(b.scale * b.strips.points[v]);
    rod(out, line, o.radius, o.sides);
    nodes.insert({arch.vertices.front(), arch.vertices.back()});
  }
  for (int v : nodes) ball(out, b.scale * b.strips.points[v], 1.25 * o.radius, o.sides);
  std::vector<int> numbers(b.strips.arches.size(), 0);
  for (const Seam& seam : b.seams) numbers[seam.arch] = seam.number;
  for (std::size_t a = 0; o.text_height > 0 && a < numbers.size(); ++a)
    if (numbers[a] > 0 || o.borders) add_text(out, b, b.strips.arches[a], numbers[a], o);
  // The format has 80 bytes for it: what fits of the origin, printable.
  std::string title = "sheetform " + b.origin.version + " seam frame in mm, job " + b.origin.job +
                      ", input " + b.origin.input_digest;
  std::replace_if(
      title.begin(), title.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return out.finish(title);
}

}  // namespace sheetform
