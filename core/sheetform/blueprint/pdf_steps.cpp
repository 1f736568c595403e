#include "sheetform/blueprint/pdf_steps.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "sheetform/blueprint/assembly.h"

namespace sheetform {
namespace {

constexpr int kColumns = 2, kRows = 3;
constexpr double kPixelsPerMm = 6;
constexpr int kPaper = 255, kInk = 0, kGhost = 254,
              kShades = 120;        // palette: ink, shades of grey, shades of the new part, to come, paper
constexpr double kSteady = 0.7;     // of the best view: the view before stays as long as it shows that much
constexpr double kLabel = 2.2;      // mm, height of the names in a picture
constexpr double kVisible = 0.004;  // of the picture that a part must take to be named in it
constexpr double kDegrees = 3.14159265358979323846 / 180;

std::string palette() {
  std::string out(3 * 256, '\xFF');
  const auto set = [&](int index, std::array<double, 3> rgb) {
    for (int k = 0; k < 3; ++k)
      out[static_cast<std::size_t>(3 * index + k)] =
          static_cast<char>(static_cast<int>(255 * std::clamp(rgb[k], 0.0, 1.0) + 0.5));
  };
  set(kInk, {0.15, 0.15, 0.15}), set(kGhost, {0.8, 0.82, 0.86});
  for (int i = 0; i < kShades; ++i) {
    const double light = i / (kShades - 1.0);
    set(1 + i, {0.55 + 0.37 * light, 0.55 + 0.37 * light, 0.57 + 0.37 * light});
    set(1 + kShades + i, {0.5 + 0.5 * light, 0.28 + 0.42 * light, 0.08 + 0.17 * light});
  }
  return out;
}

/// A picture with depth: pixels nearer to the eye win. Knows which part each pixel shows.
class Picture {
 public:
  Picture(int width, int height)
      : width_(width),
        height_(height),
        depth_(static_cast<std::size_t>(width) * height, -3e38f),
        part_(depth_.size(), -1) {
    image_.width = width, image_.height = height;
    image_.pixels.assign(depth_.size(), static_cast<char>(kPaper));
  }

  // Corners in pixels (y down) with their depth towards the eye.
  void triangle(const Vector3& a, const Vector3& b, const Vector3& c, int colour, int part) {
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
        put(x, y, u * a.z() + v * b.z() + (1 - u - v) * c.z(), colour, part);
      }
    }
  }

  void line(const Vector3& a, const Vector3& b, double bias, int colour) {
    const int n = 1 + static_cast<int>(1.5 * (b - a).head<2>().norm());
    for (int i = 0; i <= n; ++i) {
      const Vector3 p = a + (b - a) * i / n;
      for (int dy = 0; dy < 2; ++dy)
        for (int dx = 0; dx < 2; ++dx)
          put(static_cast<int>(std::floor(p.x() - 0.5)) + dx, static_cast<int>(std::floor(p.y() - 0.5)) + dy,
              p.z() + bias, colour, -1);
    }
  }

  // Nothing lies in front of the point.
  bool shows(const Vector3& p, double bias) const {
    const int x = static_cast<int>(std::floor(p.x())), y = static_cast<int>(std::floor(p.y()));
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return false;
    return p.z() + bias >= depth_[static_cast<std::size_t>(y) * width_ + x];
  }

  // A pixel of this part near the middle of what is seen of it; nothing where that is too little.
  std::optional<Vector2> middle_of(int part) const {
    Vector2 sum = Vector2::Zero();
    std::vector<Vector2> seen;
    for (std::size_t i = 0; i < part_.size(); ++i)
      if (part_[i] == part)
        seen.emplace_back(static_cast<double>(i % width_), static_cast<double>(i / width_)),
            sum += seen.back();
    if (static_cast<double>(seen.size()) < kVisible * static_cast<double>(part_.size())) return std::nullopt;
    const Vector2 mean = sum / static_cast<double>(seen.size());
    return *std::min_element(seen.begin(), seen.end(), [&](const Vector2& a, const Vector2& b) {
      return (a - mean).squaredNorm() < (b - mean).squaredNorm();
    });
  }

  PdfImage take() { return std::move(image_); }

 private:
  void put(int x, int y, double depth, int colour, int part) {
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
    const std::size_t i = static_cast<std::size_t>(y) * width_ + x;
    if (depth <= depth_[i]) return;
    depth_[i] = static_cast<float>(depth);
    image_.pixels[i] = static_cast<char>(colour);
    if (part >= 0) part_[i] = part;
  }

  int width_, height_;
  std::vector<float> depth_;
  std::vector<int> part_;
  PdfImage image_;
};

struct Camera {
  Vector3 axis = Vector3::Zero();  // of the model, points up in the picture
  Vector3 right = Vector3::Zero(), up = Vector3::Zero(), eye = Vector3::Zero(), middle = Vector3::Zero();
  double scale = 1;                  // pixels for one unit of the mesh
  Vector2 center = Vector2::Zero();  // pixels
  Vector3 operator()(const Vector3& p) const {
    return {center.x() + scale * right.dot(p - middle), center.y() - scale * up.dot(p - middle),
            scale * eye.dot(p - middle)};
  }
};

// A direction as it is where z points up, turned to where `up` does.
Vector3 upright(const Vector3& v, UpAxis up) {
  switch (up) {
    case UpAxis::kX:
      return {v.z(), v.x(), v.y()};
    case UpAxis::kY:
      return {v.x(), v.z(), -v.y()};
    case UpAxis::kZ:
      return v;
    case UpAxis::kMinusX:
      return {-v.z(), v.x(), -v.y()};
    case UpAxis::kMinusY:
      return {v.x(), -v.z(), v.y()};
    case UpAxis::kMinusZ:
      return {v.x(), -v.y(), -v.z()};
  }
  return v;
}

// Views from all around, from a little above first.
std::vector<Vector3> views(UpAxis up) {
  std::vector<Vector3> out;
  for (double height : {25.0, -25.0, 65.0, -65.0})
    for (int turn = 0; turn < 8; ++turn) {
      const double a = (45 * turn - 60) * kDegrees, h = height * kDegrees;
      const Vector3 eye(std::cos(a) * std::cos(h), std::sin(a) * std::cos(h), std::sin(h));
      out.push_back(upright(eye, up));
    }
  return out;
}

// How much of a part's outside is turned towards the eye.
double shown(const Blueprint& b, int part, const Vector3& eye) {
  double sum = 0;
  const std::vector<Vector3>& p = b.strips.points;
  for (const StripMesh::Triangle& t : b.strips.patches[b.parts[part].patch].triangles)
    sum += std::max(0.0, (p[t.v[1]] - p[t.v[0]]).cross(p[t.v[2]] - p[t.v[0]]).dot(eye));
  return sum;
}

Camera seen_from(const Vector3& eye, Camera c) {
  c.eye = eye;
  c.right = c.axis.cross(eye).normalized(), c.up = eye.cross(c.right);
  return c;
}

// One scale for all pictures: whatever the view, the whole model is on it.
Camera camera_for(const Blueprint& b, const std::vector<Vector3>& all, UpAxis axis, int width, int height) {
  Camera c;
  c.axis = upright(Vector3::UnitZ(), axis);
  Eigen::AlignedBox3d box;
  for (const Vector3& p : b.strips.points) box.extend(p);
  c.middle = box.center(), c.center = Vector2(width, height) / 2;
  const Vector2 room = c.center - Vector2::Constant(3);
  double share = 1e-12;  // of that room which a model of scale 1 takes
  for (const Vector3& eye : all) {
    const Camera view = seen_from(eye, c);
    for (const Vector3& p : b.strips.points)
      share = std::max({share, std::abs(view.right.dot(p - c.middle)) / room.x(),
                        std::abs(view.up.dot(p - c.middle)) / room.y()});
  }
  c.scale = 1 / share;
  return c;
}

/// The picture of one step and what is written into it, in pixels from the upper left.
struct StepPicture {
  PdfImage image;
  std::vector<std::pair<Vector2, std::string>> names;  ///< most important first
};

void draw_part(const Blueprint& b, int part, bool fresh, const Camera& camera, Picture& picture) {
  const StripMesh::Patch& patch = b.strips.patches[b.parts[part].patch];
  const std::vector<Vector3>& x = b.strips.points;
  for (const StripMesh::Triangle& t : patch.triangles) {
    const Vector3 &p = x[t.v[0]], &q = x[t.v[1]], &r = x[t.v[2]];
    const double light = std::abs((q - p).cross(r - p).stableNormalized().dot(camera.eye));
    const int shade = static_cast<int>(light * (kShades - 1) + 0.5);
    picture.triangle(camera(p), camera(q), camera(r), 1 + shade + (fresh ? kShades : 0), part);
  }
  for (std::size_t k = 0; k < patch.boundary.size(); ++k)
    picture.line(camera(x[patch.boundary[k]]), camera(x[patch.boundary[(k + 1) % patch.boundary.size()]]),
                 1.0, kInk);
}

StepPicture draw_step(const Blueprint& b, const std::vector<AssemblyStep>& steps, std::size_t step,
                      const Camera& camera, int width, int height) {
  Picture picture(width, height);
  for (std::size_t i = 0; i <= step; ++i) draw_part(b, steps[i].part, i == step, camera, picture);
  // What is still to come, thin and grey behind.
  for (const StripMesh::Arch& arch : b.strips.arches)
    for (std::size_t i = 0; i + 1 < arch.vertices.size(); ++i)
      picture.line(camera(b.strips.points[arch.vertices[i]]), camera(b.strips.points[arch.vertices[i + 1]]),
                   0, kGhost);
  StepPicture out;
  const int fresh = steps[step].part;
  const auto name = [&](int part) {
    if (const auto at = picture.middle_of(part)) out.names.emplace_back(*at, b.parts[part].label);
  };
  name(fresh);
  std::set<int> neighbours;
  for (int s : steps[step].seams) {
    const Seam& seam = b.seams[s];
    neighbours.insert({seam.parts[0], seam.parts[1]});
    const std::vector<int>& arch = b.strips.arches[seam.arch].vertices;
    const Vector3 p =
        camera((b.strips.points[arch[(arch.size() - 1) / 2]] + b.strips.points[arch[arch.size() / 2]]) / 2);
    if (picture.shows(p, 4.0)) out.names.emplace_back(p.head<2>(), std::to_string(seam.number));
  }
  for (int part : neighbours)
    if (part != fresh) name(part);
  out.image = picture.take();
  return out;
}

/// The pages, filled row by row.
class StepPages {
 public:
  StepPages(const Blueprint& b, double width, double height, UpAxis up, PdfFile& file)
      : b_(b),
        file_(file),
        up_(up),
        width_(width),
        height_(height),
        cell_((width - 2 * kMargin) / kColumns, (height - 2 * kMargin - kTitle) / kRows),
        size_(cell_ - Vector2(8, 18)),
        pixels_(std::min(kPixelsPerMm, 700 / std::max(1.0, size_.maxCoeff()))) {}

  void write() {
    if (cell_.minCoeff() < 30) return;  // no picture that anyone could read
    const std::vector<AssemblyStep> steps = assembly_order(b_);
    const std::vector<Vector3> all = views(up_);
    const std::string colours = palette();
    const int w = static_cast<int>(size_.x() * pixels_), h = static_cast<int>(size_.y() * pixels_);
    const Camera camera = camera_for(b_, all, up_, w, h);
    Vector3 eye = all.front();
    for (std::size_t first = 0; first < steps.size(); first += kColumns * kRows) {
      PdfPage page(width_, height_);
      page.text({kMargin + 4, height_ - kMargin - 4}, "Assembly: the new part is orange", 3.2);
      for (std::size_t i = first; i < std::min(steps.size(), first + kColumns * kRows); ++i) {
        eye = next_view(all, eye, steps[i].part);
        StepPicture picture = draw_step(b_, steps, i, seen_from(eye, camera), w, h);
        picture.image.palette = colours;
        const auto k = static_cast<int>(i - first);
        const Vector2 low(kMargin + (k % kColumns) * cell_.x() + 4,
                          height_ - kMargin - kTitle - (k / kColumns + 1) * cell_.y());
        add(page, low, std::to_string(i + 1) + ".  " + step_text(b_, steps[i]), std::move(picture));
      }
      file_.add_page(std::move(page));
    }
  }

 private:
  static constexpr double kMargin = 12, kTitle = 8;

  // The view before, as long as it shows the part well enough: a model that tumbles is hard to follow.
  Vector3 next_view(const std::vector<Vector3>& all, const Vector3& before, int part) const {
    const Vector3* best = &all.front();
    for (const Vector3& eye : all)
      if (shown(b_, part, eye) > shown(b_, part, *best)) best = &eye;
    return shown(b_, part, before) >= kSteady * shown(b_, part, *best) ? before : *best;
  }

  void add(PdfPage& page, const Vector2& low, const std::string& text, StepPicture picture) const {
    const Vector2 corner = low + Vector2(0, 12);
    const double height = picture.image.height / pixels_;
    page.image(corner, corner + Vector2(picture.image.width / pixels_, height), std::move(picture.image));
    std::vector<TurnedBox> taken;  // names do not lie on each other: the first ones say most
    for (const auto& [at, name] : picture.names) {
      const Vector2 half(helvetica_width(name, kLabel) / 2, kLabel / 2);
      const Vector2 middle = corner + Vector2(at.x() / pixels_, height - at.y() / pixels_);
      const TurnedBox box{middle, Vector2::UnitX(), half.x() + 0.5, half.y() + 0.5};
      if (std::any_of(taken.begin(), taken.end(), [&](const TurnedBox& t) { return overlap(t, box); }))
        continue;
      taken.push_back(box);
      page.fill(box.corners(), "#ffffff");
      page.text(middle - half, name, kLabel);
    }
    double y = low.y() + 7;
    for (const std::string& line : in_two(text, cell_.x() - 8)) page.text({low.x(), y}, line, 2.3), y -= 4.5;
  }

  // Two lines at most; what is longer stands in the list of steps.
  static std::vector<std::string> in_two(const std::string& text, double room) {
    std::vector<std::string> lines{""};
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = std::min(text.find(' ', at), text.size() - 1) + 1;
      const std::string piece = text.substr(at, end - at);
      if (helvetica_width(lines.back() + piece + " ...", 2.3) > room) {
        if (lines.size() == 2) {
          lines.back() += " ...";
          break;
        }
        lines.emplace_back();
      }
      lines.back() += piece;
      at = end;
    }
    return lines;
  }

  const Blueprint& b_;
  PdfFile& file_;
  UpAxis up_;
  double width_, height_;
  Vector2 cell_, size_;
  double pixels_;
};

}  // namespace

void add_step_pages(const Blueprint& b, double width, double height, UpAxis up, PdfFile& file) {
  StepPages(b, width, height, up, file).write();
}

}  // namespace sheetform
