#include "sheetform/bending.h"

#include <algorithm>
#include <cstdio>

#include "sheetform/blueprint/fold_lines.h"
#include "sheetform/blueprint/result_writer.h"

namespace sheetform {
namespace {

constexpr std::size_t kNamed = 5;  // parts that a note names

}  // namespace

BendReport measure_bending(const StripMesh& strips, double scale, std::optional<double> asked) {
  BendReport report;
  report.reach = asked ? *asked / 2 : kBendReach * scale * bounding_box_diagonal(strips.points);
  std::vector<Vector2> flat = strips.uvs;
  for (Vector2& p : flat) p *= scale;
  for (int p = 0; p < static_cast<int>(strips.patches.size()); ++p) {
    const std::vector<Crease> creases = creases_of(strips, p);
    const std::vector<double> radii = bend_radii(strips, p, creases, flat, report.reach);
    const auto least = std::min_element(radii.begin(), radii.end());
    report.patch_radius.push_back(least == radii.end() ? std::numeric_limits<double>::infinity() : *least);
    if (report.patch_radius.back() >= report.smallest) continue;
    const Crease& at = creases[least - radii.begin()];
    report.smallest = *least, report.patch = p;
    report.place = (strips.points[at.v[0]] + strips.points[at.v[1]]) / 2;
  }
  return report;
}

std::string too_sharp(const BendReport& report, const StripMesh& strips, double least) {
  std::vector<std::pair<double, std::size_t>> sharp;
  for (std::size_t p = 0; p < report.patch_radius.size(); ++p)
    if (report.patch_radius[p] < least) sharp.emplace_back(report.patch_radius[p], p);
  if (sharp.empty()) return {};
  std::sort(sharp.begin(), sharp.end());
  const std::vector<std::string> labels = part_labels(strips);
  char text[80];
  std::snprintf(text, sizeof text,
                "%zu of %zu parts bend more sharply than the radius of %g mm: ", sharp.size(),
                report.patch_radius.size(), least);
  std::string note = text;
  for (std::size_t i = 0; i < std::min(sharp.size(), kNamed); ++i) {
    std::snprintf(text, sizeof text, "%s%s (%.3g mm)", i > 0 ? ", " : "", labels[sharp[i].second].c_str(),
                  sharp[i].first);
    note += text;
  }
  return note + (sharp.size() > kNamed ? " and others" : "");
}

SpacingReport measure_spacing(const StripMesh& strips, double scale) {
  SpacingReport report;
  double shortest = std::numeric_limits<double>::infinity();
  for (const StripMesh::Arch& arch : strips.arches)
    for (std::size_t i = 0; i + 1 < arch.vertices.size(); ++i) {
      const double length =
          scale * (strips.points[arch.vertices[i + 1]] - strips.points[arch.vertices[i]]).norm();
      shortest = std::min(shortest, length), report.longest = std::max(report.longest, length);
    }
  if (report.longest > 0) report.shortest = shortest;
  return report;
}

}  // namespace sheetform
