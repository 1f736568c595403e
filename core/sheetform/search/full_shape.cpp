#include "sheetform/search/full_shape.h"

#include "sheetform/morph/full_morph.h"
#include "sheetform/search/plane_join.h"

namespace sheetform {
namespace {

// Per arch: it belongs to a patch that stays.
std::vector<char> kept_arches(const PatchLayout& layout, const std::vector<RuledPatch>& ruled) {
  std::vector<char> kept(layout.arches.size(), 0);
  for (std::size_t p = 0; p < ruled.size(); ++p)
    if (ruled[p].chart == nullptr)
      for (const ArchUse& use : layout.patches[p].boundary) kept[use.arch] = 1;
  return kept;
}

std::vector<Vector3> places_of(const LayoutEvaluation& e, int arch) {
  std::vector<Vector3> places;
  for (int u : e.arch_unknowns[arch]) places.push_back(e.position[u]);
  return places;
}

}  // namespace

std::vector<Vector3> full_morph_places(const SearchSurface& surface, const PatchLayout& layout,
                                       const LayoutEvaluation& evaluation, double spacing,
                                       const std::vector<char>& keep, const RunContext& context) {
  std::vector<std::vector<double>> samples;
  for (const Arch& a : layout.arches) samples.push_back(outline_samples(surface, a, spacing));
  std::vector<RuledPatch> ruled(layout.patches.size());
  for (std::size_t p = 0; p < ruled.size(); ++p) {
    const PatchEvaluation& e = *evaluation.patches[p];
    if (!keep[p] && e.chart != nullptr && !e.rulings.chords.empty())
      ruled[p] = {e.chart.get(), ruling_lines(layout.patches[p], e.polygon, e.rulings, samples)};
  }
  FullMorphProblem problem =
      full_morph_problem(surface.mesh, layout, ruled, samples, surface.curvature, context);
  const std::vector<char> kept = kept_arches(layout, ruled);
  for (std::size_t a = 0; a < kept.size(); ++a)
    if (kept[a] && !problem.arch_stop[a].empty())
      problem.held[a] = places_of(evaluation, static_cast<int>(a));
  const FullMorphResult full = full_morph(problem, {}, context);
  std::vector<Vector3> places = evaluation.position;
  for (std::size_t a = 0; a < kept.size(); ++a)
    for (std::size_t s = 0; s < full.arch_points[a].size(); ++s)
      places[evaluation.arch_unknowns[a][s]] = full.arch_points[a][s];
  // A node of a patch that stays is not moved by arches that only touch it.
  for (std::size_t a = 0; a < kept.size(); ++a)
    if (kept[a])
      for (int u : evaluation.arch_unknowns[a]) places[u] = evaluation.position[u];
  return places;
}

}  // namespace sheetform
