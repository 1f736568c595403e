#include "sheetform/blueprint/pdf_steps.h"

#include <algorithm>
#include <cmath>

#include "sheetform/blueprint/assembly.h"

namespace sheetform {
namespace {

constexpr int kColumns = 2, kRows = 3;
constexpr double kPixelsPerMm = 6;
constexpr int kPaper = 255, kInk = 0,
              kShades = 120;  // palette: ink, shades of grey, shades of the new part, paper

std::string palette() {
  std::string out(3 * 256, '\xFF');
  const auto set = [&](int index, std::array<double, 3> rgb) {
    for (int k = 0; k < 3; ++k)
      out[static_cast<std::size_t>(3 * index + k)] =
          static_cast<char>(static_cast<int>(255 * std::clamp(rgb[k], 0.0, 1.0) + 0.5));
  };
  set(kInk, {0.15, 0.15, 0.15});
  for (int i = 0; i < kShades; ++i) {
    const double light = i / (kShades - 1.0);
    set(1 + i, {0.55 + 0.37 * light, 0.55 + 0.37 * light, 0.57 + 0.37 * light});
    set(1 + kShades + i, {0.5 + 0.5 * light, 0.28 + 0.42 * light, 0.08 + 0.17 * light});
  }
  return out;
}

/// A picture with depth: pixels nearer to the eye win.
class Picture {
 public:
  Picture(int width, int height)
      : width_(width), height_(height), depth_(static_cast<std::size_t>(width) * height, -3e38f) {
    image_.width = width, image_.height = height;
    image_.pixels.assign(depth_.size(), static_cast<char>(kPaper));
  }

  // Corners in pixels (y down) with their depth towards the eye.
  void triangle(const Vector3& a, const Vector3& b, const Vector3& c, int colour) {
    const double area =
        (b - a).head<2>().x() * (c - a).head<2>().y() - (b - a).head<2>().y() * (c - a).head<2>().x();
    if (area == 0) return;
    const int y0 = std::max(0, static_cast<int>(std::floor(std::min({a.y(), b.y(), c.y()}))));
    const int y1 = std::min(height_ - 1, static_cast<int>(std::ceil(std::max({a.y(), b.y(), c.y()}))));
    // Row by row between the sides: long thin triangles cost what they cover, not what their boxes do.
    for (int y = y0; y <= y1; ++y) {
      const double py = y + 0.5;
      double low = 1e9, high = -1e9;
      for (const auto& [p, q] : {std::pair(&a, &b), std::pair(&b, &c), std::pair(&c, &a)}) {
        if ((p->y() > py) == (q->y() > py)) continue;
        const double x = p->x() + (py - p->y()) / (q->y() - p->y()) * (q->x() - p->x());
        low = std::min(low, x), high = std::max(high, x);
      }
      const int x1 = std::min(width_ - 1, static_cast<int>(std::floor(high - 0.5)));
      for (int x = std::max(0, static_cast<int>(std::ceil(low - 0.5))); x <= x1; ++x) {
        const double px = x + 0.5;
        const double u = ((b.x() - px) * (c.y() - py) - (b.y() - py) * (c.x() - px)) / area;
        const double v = ((c.x() - px) * (a.y() - py) - (c.y() - py) * (a.x() - px)) / area;
        put(x, y, u * a.z() + v * b.z() + (1 - u - v) * c.z(), colour);
      }
    }
  }

  void line(const Vector3& a, const Vector3& b, double bias) {
    const int n = 1 + static_cast<int>(1.5 * (b - a).head<2>().norm());
    for (int i = 0; i <= n; ++i) {
      const Vector3 p = a + (b - a) * i / n;
      for (int dy = 0; dy < 2; ++dy)
        for (int dx = 0; dx < 2; ++dx)
          put(static_cast<int>(std::floor(p.x() - 0.5)) + dx, static_cast<int>(std::floor(p.y() - 0.5)) + dy,
              p.z() + bias, kInk);
    }
  }

  PdfImage take() { return std::move(image_); }

 private:
  void put(int x, int y, double depth, int colour) {
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
    const std::size_t i = static_cast<std::size_t>(y) * width_ + x;
    if (depth <= depth_[i]) return;
    depth_[i] = static_cast<float>(depth);
    image_.pixels[i] = static_cast<char>(colour);
  }

  int width_, height_;
  std::vector<float> depth_;
  PdfImage image_;
};

struct Camera {
  Vector3 right, up, eye, middle;
  double scale = 1;  // pixels for one unit of the mesh
  Vector2 center;    // pixels
  Vector3 operator()(const Vector3& p) const {
    return {center.x() + scale * right.dot(p - middle), center.y() - scale * up.dot(p - middle),
            scale * eye.dot(p - middle)};
  }
};

Camera camera_for(const Blueprint& b, const Vector3& eye, int width, int height) {
  Camera c;
  c.eye = eye;
  const Vector3 pole = std::abs(eye.z()) > 0.95 ? Vector3::UnitY() : Vector3::UnitZ();
  c.right = pole.cross(eye).normalized(), c.up = eye.cross(c.right);
  Eigen::AlignedBox3d box;
  for (const Vector3& p : b.strips.points) box.extend(p);
  c.middle = box.center(), c.center = Vector2(width, height) / 2;
  Vector2 reach = Vector2::Constant(1e-12);
  for (const Vector3& p : b.strips.points)
    reach = reach.cwiseMax(Vector2(std::abs(c.right.dot(p - c.middle)), std::abs(c.up.dot(p - c.middle))));
  c.scale = (Vector2(width - 6, height - 6) / 2).cwiseQuotient(reach).minCoeff();
  return c;
}

PdfImage draw_step(const Blueprint& b, const std::vector<AssemblyStep>& steps, std::size_t step, int width,
                   int height) {
  Picture picture(width, height);
  const Camera camera = camera_for(b, view_of_part(b, steps[step].part), width, height);
  for (std::size_t i = 0; i <= step; ++i) {
    const StripMesh::Patch& patch = b.strips.patches[b.parts[steps[i].part].patch];
    for (const StripMesh::Triangle& t : patch.triangles) {
      const Vector3 &p = b.strips.points[t.v[0]], &q = b.strips.points[t.v[1]], &r = b.strips.points[t.v[2]];
      const double light = std::abs((q - p).cross(r - p).stableNormalized().dot(camera.eye));
      const int shade = static_cast<int>(light * (kShades - 1) + 0.5);
      picture.triangle(camera(p), camera(q), camera(r), 1 + shade + (i == step ? kShades : 0));
    }
    for (std::size_t k = 0; k < patch.boundary.size(); ++k)
      picture.line(camera(b.strips.points[patch.boundary[k]]),
                   camera(b.strips.points[patch.boundary[(k + 1) % patch.boundary.size()]]), 1.0);
  }
  return picture.take();
}

}  // namespace

Vector3 view_of_part(const Blueprint& b, int part) {
  Vector3 normal = Vector3::Zero();
  const std::vector<Vector3>& p = b.strips.points;
  for (const StripMesh::Triangle& t : b.strips.patches[b.parts[part].patch].triangles)
    normal += (p[t.v[1]] - p[t.v[0]]).cross(p[t.v[2]] - p[t.v[0]]);
  if (!(normal.norm() > 0)) normal = Vector3::UnitX();
  normal.normalize();
  return (normal + 0.35 * Vector3::UnitZ() + 0.25 * Vector3(normal.y(), -normal.x(), 0)).stableNormalized();
}

void add_step_pages(const Blueprint& b, double width, double height, PdfFile& file) {
  const std::vector<AssemblyStep> steps = assembly_order(b);
  const double margin = 12, cell_w = (width - 2 * margin) / kColumns, cell_h = (height - 2 * margin) / kRows;
  if (cell_w < 30 || cell_h < 30) return;  // no picture that anyone could read
  const Vector2 size(cell_w - 8, cell_h - 16);
  const double pixels = std::min(kPixelsPerMm, 700 / size.maxCoeff());
  const std::string colours = palette();
  for (std::size_t first = 0; first < steps.size(); first += kColumns * kRows) {
    PdfPage page(width, height);
    for (std::size_t i = first; i < std::min(steps.size(), first + kColumns * kRows); ++i) {
      const auto k = static_cast<int>(i - first);
      const Vector2 low(margin + (k % kColumns) * cell_w, height - margin - (k / kColumns + 1) * cell_h);
      PdfImage image =
          draw_step(b, steps, i, static_cast<int>(size.x() * pixels), static_cast<int>(size.y() * pixels));
      image.palette = colours;
      page.image(low + Vector2(4, 10), low + Vector2(4, 10) + size, std::move(image));
      std::string text = std::to_string(i + 1) + ".  " + b.parts[steps[i].part].label;
      for (std::size_t s = 0; s < std::min<std::size_t>(6, steps[i].seams.size()); ++s)
        text += (s == 0 ? "   seams " : ", ") + std::to_string(b.seams[steps[i].seams[s]].number);
      if (steps[i].seams.size() > 6) text += ", ...";
      page.text(low + Vector2(4, 4), text, 2.6);
    }
    file.add_page(std::move(page));
  }
}

}  // namespace sheetform
