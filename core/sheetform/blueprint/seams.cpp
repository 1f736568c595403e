#include "sheetform/blueprint/seams.h"

#include <algorithm>
#include <set>

#include "sheetform/base/error.h"

namespace sheetform {
namespace {

constexpr double kSpacing = 0.8;     // of the notch size, between the notches of a group
constexpr double kGroupShare = 0.3;  // of the seam that a group may take
constexpr double kAt[2] = {0.28,
                           0.72};   // middles of the groups; the middle of the seam is left to its number
constexpr double kSingleAt = 0.35;  // of the one notch of a short seam: off the middle

// The uvs of `arch` along the boundary of a patch, walked forward (counter-clockwise) or backward; empty: not
// there.
std::vector<int> side_along(const StripMesh::Patch& patch, const std::vector<int>& arch, bool forward) {
  const std::size_t n = patch.boundary.size(), m = arch.size();
  for (std::size_t start = 0; start < n && m <= n + 1; ++start) {
    const auto place = [&](std::size_t j) { return forward ? (start + j) % n : (start + n - j % n) % n; };
    std::size_t j = 0;
    while (j < m && patch.boundary[place(j)] == arch[j]) ++j;
    if (j < m) continue;
    std::vector<int> vt;
    for (j = 0; j < m; ++j) vt.push_back(patch.boundary_vt[place(j)]);
    return vt;
  }
  return {};
}

Seam seam_of(const StripMesh& strips, int arch, bool mirrored) {
  const StripMesh::Arch& a = strips.arches[arch];
  Seam seam;
  seam.arch = arch, seam.parts = a.patches;
  const bool first_forward = !side_along(strips.patches[a.patches[0]], a.vertices, true).empty();
  for (int k = 0; k < 2; ++k) {
    const bool forward = first_forward == (k == 0);
    seam.vt[k] = side_along(strips.patches[a.patches[k]], a.vertices, forward);
    seam.left[k] = forward != mirrored;
    if (seam.vt[k].empty())
      throw Error(ErrorCode::kInternal, "an arch is not on the boundary of its patch",
                  "arch " + std::to_string(arch));
  }
  return seam;
}

// Counts of the two groups; the first is always the smaller, so that no code is another one turned around.
std::vector<std::array<int, 2>> all_codes() {
  std::vector<std::array<int, 2>> codes;
  for (int b = 2; b <= 5; ++b)
    for (int a = 1; a < b; ++a) codes.push_back({a, b});
  return codes;
}

void give_code(Seam& seam, double notch_size, std::vector<std::set<std::array<int, 2>>>& used) {
  static const std::vector<std::array<int, 2>> codes = all_codes();
  const double spacing = kSpacing * notch_size;
  const auto fits = [&](const std::array<int, 2>& c) { return c[1] * spacing <= kGroupShare * seam.length; };
  if (notch_size <= 0 || !fits(codes[0])) {
    if (notch_size > 0 && seam.length >= 3 * notch_size)
      seam.code = {1, 0}, seam.at = {kSingleAt * seam.length, 0};
    return;
  }
  seam.code = codes[0];
  for (const std::array<int, 2>& c : codes)
    if (fits(c) && !used[seam.parts[0]].count(c) && !used[seam.parts[1]].count(c)) {
      seam.code = c;
      break;
    }
  seam.at = {kAt[0] * seam.length, kAt[1] * seam.length};
  used[seam.parts[0]].insert(seam.code), used[seam.parts[1]].insert(seam.code);
}

}  // namespace

std::vector<Seam> seams_of(const StripMesh& strips, const std::vector<Vector2>& flat, double notch_size,
                           bool mirrored) {
  std::vector<Seam> seams;
  std::vector<std::set<std::array<int, 2>>> used(strips.patches.size());
  for (std::size_t a = 0; a < strips.arches.size(); ++a) {
    if (strips.arches[a].patches[1] < 0) continue;
    Seam seam = seam_of(strips, static_cast<int>(a), mirrored);
    seam.number = static_cast<int>(seams.size()) + 1;
    seam.length = length_of(side_of(seam, 0, flat));
    give_code(seam, notch_size, used);
    seams.push_back(std::move(seam));
  }
  return seams;
}

double length_of(const std::vector<Vector2>& line) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) sum += (line[i + 1] - line[i]).norm();
  return sum;
}

PointOnLine point_at(const std::vector<Vector2>& line, double s) {
  std::size_t i = 0;
  for (; i + 2 < line.size(); ++i) {
    const double step = (line[i + 1] - line[i]).norm();
    if (s <= step) break;
    s -= step;
  }
  const Vector2 d = line[i + 1] - line[i];
  const double step = d.norm();
  const Vector2 direction = step > 0 ? Vector2(d / step) : Vector2::UnitX();
  return {line[i] + std::clamp(s, 0.0, step) * direction, direction};
}

std::vector<Vector2> side_of(const Seam& seam, int k, const std::vector<Vector2>& flat) {
  std::vector<Vector2> line;
  for (int t : seam.vt[k]) line.push_back(flat[t]);
  return line;
}

std::vector<double> notch_places(const Seam& seam, double notch_size) {
  std::vector<double> places;
  for (int g = 0; g < 2; ++g)
    for (int i = 0; i < seam.code[g]; ++i)
      places.push_back(seam.at[g] + (i - (seam.code[g] - 1) / 2.0) * kSpacing * notch_size);
  return places;
}

}  // namespace sheetform
