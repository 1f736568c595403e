#include "sheetform/ruling/rulings.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sheetform {
namespace {

constexpr double kForbidden = 1e9;
// Of min_height: triangles that are lower are as good as none.
constexpr double kNoHeight = 0.002;
constexpr int kSamples = 7;  // inner samples of a chord

// Residuals of d (zero at both ends) after the best affine function of the parameter is taken away.
double half_sagitta(const std::array<Vector3, kSamples>& d) {
  constexpr int n = kSamples + 2;
  Vector3 mean = Vector3::Zero(), slope = Vector3::Zero();
  double tt = 0;
  for (int k = 0; k < n; ++k) {
    const double t = static_cast<double>(k) / (n - 1) - 0.5;
    tt += t * t;
    if (k == 0 || k == n - 1) continue;
    mean += d[k - 1];
    slope += t * d[k - 1];
  }
  mean /= n, slope /= tt;
  double worst = 0;
  for (int k = 0; k < n; ++k) {
    const double t = static_cast<double>(k) / (n - 1) - 0.5;
    const Vector3 value = k == 0 || k == n - 1 ? Vector3(Vector3::Zero()) : d[k - 1];
    worst = std::max(worst, (value - mean - slope * t).squaredNorm());
  }
  return 0.75 * std::sqrt(worst);  // of an arc: half of the sagitta, the best that any straight line can do
}

struct ChordScore {
  float cost = 0, error = 0, misalignment = 0;
};

class StripSearch {
 public:
  StripSearch(const PatchPolygon& polygon, const ChartRaster& raster, const RulingParams& params,
              const std::function<bool(int, int)>* forbidden)
      : polygon_(polygon), raster_(raster), params_(params), forbidden_(forbidden), m_(polygon.size()) {}

  RulingSet run() {
    RulingSet set;
    if (m_ < 3) return set;
    for (int i = 0; i < m_; ++i) total_area_ += cross(polygon_.uv[i], polygon_.uv[(i + 1) % m_]) / 2;
    if (total_area_ <= 0) return set;
    score_chords();
    score_triangles();
    fill_table();
    collect(set);
    return set;
  }

 private:
  ChordScore& score(int i, int j) { return scores_[static_cast<std::size_t>(i) * m_ + j]; }

  bool neighbours(int i, int j) const { return j == (i + 1) % m_ || i == (j + 1) % m_; }

  ChordScore judge(int i, int j) const {
    const ChordScore never{static_cast<float>(kForbidden), 0, 0};
    if (forbidden_ != nullptr && (*forbidden_)(i, j)) return never;
    const Vector2 a = polygon_.uv[i], b = polygon_.uv[j], direction = b - a;
    const Vector3 &p = polygon_.point[i], &q = polygon_.point[j];
    const Vector2 along = direction / std::max(direction.norm(), 1e-150);
    std::array<Vector3, kSamples> d;
    double misaligned = 0;
    int first = -1, last = -1;
    for (int k = 0; k < kSamples; ++k) {
      const double t = (k + 1.0) / (kSamples + 1);
      const Vector2 u = a + t * direction;
      const int triangle = raster_.triangle_at(u);
      if (triangle < 0) {
        if (params_.keep_inside) return never;
        d[k].setZero();
        continue;
      }
      d[k] = raster_.lift(triangle, u) - ((1 - t) * p + t * q);
      misaligned += raster_.misalignment(triangle, along);
      if (first < 0) first = triangle;
      last = triangle;
    }
    ChordScore s;
    s.error = static_cast<float>(half_sagitta(d));
    s.misalignment = static_cast<float>(misaligned / kSamples);
    const double relative = s.error / params_.e_max;
    const double cosine = first < 0 ? 1.0 : raster_.normal(first).dot(raster_.normal(last));
    const double twist2 = 2 * (1 - std::clamp(cosine, -1.0, 1.0));
    s.cost = static_cast<float>(std::min(relative * relative * relative * relative, 1e4) +
                                params_.twist_weight * twist2 + params_.align_weight * misaligned / kSamples);
    return s;
  }

  void score_chords() {
    scores_.assign(static_cast<std::size_t>(m_) * m_, {});
    for (int i = 0; i < m_; ++i)
      for (int j = i + 2; j < m_; ++j) {
        if (neighbours(i, j)) continue;
        score(i, j) = score(j, i) = judge(i, j);
      }
  }

  // Cost of the triangle i, k, j (counter-clockwise) with its share of the chords beside it.
  double triangle_cost(int i, int k, int j) {
    const Vector2 &a = polygon_.uv[i], &b = polygon_.uv[k], &c = polygon_.uv[j];
    const double area = cross(b - a, c - a) / 2;
    const float first = score(i, k).cost, second = score(k, j).cost, third = score(j, i).cost;
    double cost = std::max(area, 0.0) / total_area_ * 0.5 * (first + second + third);
    for (float side : {first, second, third})
      if (side >= kForbidden) cost += kForbidden;
    const double longest2 = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}),
                 least = params_.min_height * std::sqrt(longest2);
    if (2 * area < least) {
      const double lack = 1 - 2 * area / std::max(least, 1e-300);  // over 1: inverted
      cost += area > 0 ? 0.05 * lack : 10 + lack;
      if (2 * area < kNoHeight * least) cost += params_.flat_cost;
    }
    return cost;
  }

  // Every triangle of an outline edge and a point occurs twice in the table.
  void score_triangles() {
    triangle_.assign(static_cast<std::size_t>(m_) * m_, 0);
    for (int i = 0; i < m_; ++i)
      for (int l = 2; l < m_; ++l)
        triangle(i, wrapped(i + l)) = triangle_cost(i, wrapped(i + 1), wrapped(i + l));
  }

  // The triangle of outline edge (i, i+1) and point j.
  double& triangle(int i, int j) { return triangle_[static_cast<std::size_t>(i) * m_ + j]; }
  // table(i, l): best strip over the outline from point i to point i+l, closed by the chord between them.
  double& table(int i, int l) { return table_[static_cast<std::size_t>(i) * m_ + l]; }
  char& choice(int i, int l) { return choice_[static_cast<std::size_t>(i) * m_ + l]; }

  // Of an index below 2 m.
  int wrapped(int i) const { return i < m_ ? i : i - m_; }

  void fill_table() {
    table_.assign(static_cast<std::size_t>(m_) * m_, 0);
    choice_.assign(static_cast<std::size_t>(m_) * m_, 0);
    for (int l = 2; l < m_; ++l)
      for (int i = 0; i < m_; ++i) {
        const int j = wrapped(i + l);
        const double ahead = table(wrapped(i + 1), l - 1) + triangle(i, j);
        const double behind = table(i, l - 1) + triangle(wrapped(j + m_ - 1), i);
        table(i, l) = std::min(ahead, behind);
        choice(i, l) = behind < ahead;
      }
  }

  // Triangles of table(i, l) from the chord inwards.
  void unroll(int i, int l, std::vector<std::array<int, 3>>& out) {
    while (l >= 2) {
      const int j = wrapped(i + l);
      if (choice(i, l)) {
        out.push_back({i, wrapped(j + m_ - 1), j});
      } else {
        out.push_back({i, wrapped(i + 1), j});
        i = wrapped(i + 1);
      }
      --l;
    }
  }

  void collect(RulingSet& set) {
    double best = std::numeric_limits<double>::infinity();
    int best_i = 0, best_l = m_ - 1;
    if (m_ == 3) best = table(0, 2);
    for (int i = 0; i < m_; ++i)
      for (int l = 2; l <= m_ - 2; ++l) {
        const double c = table(i, l) + table(wrapped(i + l), m_ - l);
        if (c < best) best = c, best_i = i, best_l = l;
      }
    set.cost = best;
    set.found = best < kForbidden;
    std::vector<std::array<int, 3>> head, tail;
    unroll(best_i, best_l, head);
    if (m_ > 3) unroll(wrapped(best_i + best_l), m_ - best_l, tail);
    set.triangles.assign(head.rbegin(), head.rend());
    set.triangles.insert(set.triangles.end(), tail.begin(), tail.end());
    list_chords(set);
  }

  void list_chords(RulingSet& set) {
    double total = 0;
    for (std::size_t t = 0; t + 1 < set.triangles.size(); ++t) {
      const auto &x = set.triangles[t], &y = set.triangles[t + 1];
      std::array<int, 2> shared{};
      int n = 0;
      for (int v : x)
        if (n < 2 && (v == y[0] || v == y[1] || v == y[2])) shared[n++] = v;
      const double area = (area_of(x) + area_of(y)) / 2;
      set.chords.push_back({shared[0], shared[1], std::max(area, 0.0)});
      set.predicted_error =
          std::max(set.predicted_error, static_cast<double>(score(shared[0], shared[1]).error));
      total += std::max(area, 0.0);
      set.misalignment += std::max(area, 0.0) * score(shared[0], shared[1]).misalignment;
    }
    if (total > 0) set.misalignment /= total;
  }

  double area_of(const std::array<int, 3>& t) const {
    return cross(polygon_.uv[t[1]] - polygon_.uv[t[0]], polygon_.uv[t[2]] - polygon_.uv[t[0]]) / 2;
  }

  const PatchPolygon& polygon_;
  const ChartRaster& raster_;
  const RulingParams& params_;
  const std::function<bool(int, int)>* forbidden_;
  int m_;
  double total_area_ = 0;
  std::vector<ChordScore> scores_;
  std::vector<double> triangle_, table_;
  std::vector<char> choice_;
};

}  // namespace

SurfaceGuide surface_guide(const SurfaceMesh& mesh, const CurvatureField& curvature) {
  SurfaceGuide guide;
  const int n = mesh.face_count();
  guide.ruling_direction.assign(n, Vector3::Zero());
  guide.strength.assign(n, 0);
  guide.normal.resize(n);
  const double diagonal = bounding_box_diagonal(mesh.points);
  for (int f = 0; f < n; ++f) {
    guide.normal[f] = mesh.face_normal_raw(f).normalized();
    Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero();
    double sum = 0;
    for (int v : mesh.faces[f]) {
      const double big = std::abs(curvature.k_max[v]), small = std::abs(curvature.k_min[v]);
      if (big <= 0) continue;
      // The direction counts from |k_max| of 1/diagonal on and for |k_min| below |k_max| / 2 (the judge's own
      // limits).
      const double s =
          std::min(1.0, big * diagonal / 1.5) * std::clamp(1.6 * (1 - small / big) - 0.5, 0.0, 1.0);
      tensor += s * curvature.dir_min[v] * curvature.dir_min[v].transpose();
      sum += s / 3;
    }
    if (sum < 1e-6) continue;
    // Power iteration for the dominant direction, from the strongest column.
    int column = 0;
    for (int k = 1; k < 3; ++k)
      if (tensor.col(k).squaredNorm() > tensor.col(column).squaredNorm()) column = k;
    Vector3 d = tensor.col(column);
    for (int k = 0; k < 3; ++k) d = (tensor * d).normalized();
    guide.ruling_direction[f] = (d - guide.normal[f] * guide.normal[f].dot(d)).normalized();
    guide.strength[f] = sum;
  }
  return guide;
}

std::vector<double> sample_arch(const SurfaceMesh& mesh, const Arch& arch, double spacing) {
  std::vector<double> length(arch.edges.size() + 1, 0);
  for (std::size_t i = 0; i < arch.edges.size(); ++i)
    length[i + 1] = length[i] + mesh.edge_length(arch.edges[i]);
  const int least = arch.closed() ? 6 : 2;
  const int segments = std::max(least, static_cast<int>(std::lround(length.back() / spacing)));
  std::vector<double> at{0};
  std::size_t edge = 0;
  for (int s = 1; s < segments; ++s) {
    const double want = length.back() * s / segments;
    while (edge + 1 < arch.edges.size() && length[edge + 1] < want) ++edge;
    const double span = std::max(length[edge + 1] - length[edge], 1e-300);
    at.push_back(static_cast<double>(edge) + std::clamp((want - length[edge]) / span, 0.0, 1.0));
  }
  at.push_back(static_cast<double>(arch.edges.size()));
  return at;
}

Vector3 arch_point(const SurfaceMesh& mesh, const Arch& arch, double at) {
  const int i = std::min(static_cast<int>(at), static_cast<int>(arch.edges.size()) - 1);
  const double t = at - i;
  return (1 - t) * mesh.points[arch.vertices[i]] + t * mesh.points[arch.vertices[i + 1]];
}

PatchPolygon patch_polygon(const SurfaceMesh& mesh, const PatchLayout& layout, const Patch& patch,
                           const PatchChart& chart, const std::vector<std::vector<double>>& arch_samples) {
  PatchPolygon polygon;
  for (std::size_t u = 0; u < patch.boundary.size(); ++u) {
    const ArchUse& use = patch.boundary[u];
    const Arch& arch = layout.arches[use.arch];
    const auto& samples = arch_samples[use.arch];
    const auto& line = chart.boundary[u];
    const int n = static_cast<int>(samples.size()), edges = static_cast<int>(arch.edges.size());
    for (int s = 0; s + 1 < n; ++s) {
      const int index = use.forward ? s : n - 1 - s;
      const double at = samples[index], along = use.forward ? at : edges - at;
      const int i = std::min(static_cast<int>(along), edges - 1);
      const double t = along - i;
      polygon.uv.push_back((1 - t) * chart.uv[line[i]] + t * chart.uv[line[i + 1]]);
      polygon.point.push_back(arch_point(mesh, arch, at));
      polygon.origin.push_back({static_cast<int>(u), index});
      const char node = layout.node[arch.vertices[use.forward ? 0 : edges]];
      polygon.node.push_back(s == 0 ? node : static_cast<char>(PatchLayout::kNone));
    }
  }
  return polygon;
}

ChartRaster::ChartRaster(const SurfaceMesh& mesh, const SurfaceGuide& guide, const Patch& patch,
                         const PatchChart& chart, int cells) {
  Vector2 high = Vector2::Constant(-1e300);
  low_ = Vector2::Constant(1e300);
  for (const Vector2& u : chart.uv) low_ = low_.cwiseMin(u), high = high.cwiseMax(u);
  const Vector2 extent = (high - low_).cwiseMax(1e-9);
  cell_ = std::max(std::sqrt(extent.x() * extent.y() / cells),
                   std::max(extent.x(), extent.y()) / (4.0 * std::sqrt(cells)));
  per_cell_ = 1 / cell_;
  low_ -= Vector2::Constant(2 * cell_);
  columns_ = static_cast<int>(extent.x() / cell_) + 5;
  rows_ = static_cast<int>(extent.y() / cell_) + 5;
  cells_.assign(static_cast<std::size_t>(columns_) * rows_, -1);
  maps_.resize(patch.faces.size());
  for (std::size_t i = 0; i < maps_.size(); ++i) {
    const auto& t = chart.triangles[i];
    const auto& face = mesh.faces[patch.faces[i]];
    Map& map = maps_[i];
    map.uv = chart.uv[t[0]];
    map.origin = mesh.points[face[0]];
    map.normal = guide.normal[patch.faces[i]];
    const Vector2 b = chart.uv[t[1]] - map.uv, c = chart.uv[t[2]] - map.uv;
    const Vector3 ab = mesh.points[face[1]] - map.origin, ac = mesh.points[face[2]] - map.origin;
    const double det = cross(b, c);
    map.jacobian.setZero();
    map.ruling.setZero();
    map.strength = guide.strength[patch.faces[i]];
    if (det <= 1e-16) continue;
    map.jacobian.col(0) = (c.y() * ab - b.y() * ac) / det;
    map.jacobian.col(1) = (b.x() * ac - c.x() * ab) / det;
    // The direction as a sum of both sides, up to a positive factor.
    const Vector3& d = guide.ruling_direction[patch.faces[i]];
    const double bb = ab.squaredNorm(), bc = ab.dot(ac), cc = ac.squaredNorm(), db = d.dot(ab),
                 dc = d.dot(ac);
    const Vector2 r = (cc * db - bc * dc) * b + (bb * dc - bc * db) * c;
    const double length = r.norm();
    if (length > 1e-8 * (bb * cc - bc * bc) && std::isfinite(length)) map.ruling = r / length;
    mark(static_cast<int>(i), map.uv, map.uv + b, map.uv + c);
  }
  // One ring outwards: chords that run along the outline stay answerable.
  const std::vector<int> inside = cells_;
  for (int y = 1; y + 1 < rows_; ++y)
    for (int x = 1; x + 1 < columns_; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * columns_ + x;
      if (inside[at] >= 0) continue;
      for (int step : {-1, 1, -columns_, columns_, -columns_ - 1, -columns_ + 1, columns_ - 1, columns_ + 1})
        if (inside[at + step] >= 0) {
          cells_[at] = inside[at + step];
          break;
        }
    }
}

// Marks the cells whose centre the triangle covers.
void ChartRaster::mark(int triangle, const Vector2& a, const Vector2& b, const Vector2& c) {
  const Vector2 lo = a.cwiseMin(b).cwiseMin(c), hi = a.cwiseMax(b).cwiseMax(c);
  const int x0 = std::max(0, static_cast<int>((lo.x() - low_.x()) * per_cell_ - 0.5)),
            x1 = std::min(columns_ - 1, static_cast<int>((hi.x() - low_.x()) * per_cell_ + 0.5));
  const int y0 = std::max(0, static_cast<int>((lo.y() - low_.y()) * per_cell_ - 0.5)),
            y1 = std::min(rows_ - 1, static_cast<int>((hi.y() - low_.y()) * per_cell_ + 0.5));
  const Vector2 ab = b - a, bc = c - b, ca = a - c;
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const Vector2 p = low_ + cell_ * Vector2(x + 0.5, y + 0.5);
      if (cross(ab, p - a) >= 0 && cross(bc, p - b) >= 0 && cross(ca, p - c) >= 0)
        cells_[static_cast<std::size_t>(y) * columns_ + x] = triangle;
    }
}

RulingSet best_rulings(const PatchPolygon& polygon, const ChartRaster& raster, const RulingParams& params,
                       const std::function<bool(int, int)>* forbidden) {
  return StripSearch(polygon, raster, params, forbidden).run();
}

}  // namespace sheetform
