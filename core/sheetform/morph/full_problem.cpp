// From a layout with rulings to the temporary mesh and the index lists of the six terms.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include "sheetform/base/error.h"
#include "sheetform/morph/full_remesh.h"

namespace sheetform {
namespace {

[[noreturn]] void refuse(const std::string& what, const std::string& where) {
  throw Error(ErrorCode::kInvalidParameter, what, where,
              "give charts, rulings and samples of the same layout");
}

void check_patch_input(const PatchLayout& layout, const std::vector<std::vector<double>>& samples, int p,
                       const RuledPatch& ruled) {
  const Patch& patch = layout.patches[p];
  const std::string where = "patch " + std::to_string(p);
  if (ruled.chart->triangles.size() != patch.faces.size() ||
      ruled.chart->boundary.size() != patch.boundary.size())
    refuse("the chart is not that of the patch", where);
  for (std::size_t u = 0; u < patch.boundary.size(); ++u) {
    const int a = patch.boundary[u].arch;
    const auto edges = layout.arches[a].edges.size();
    if (ruled.chart->boundary[u].size() != edges + 1)
      refuse("the chart's outline is not that of the patch", where);
    if (samples[a].size() < 2 || samples[a].front() != 0 || samples[a].back() != static_cast<double>(edges) ||
        !std::is_sorted(samples[a].begin(), samples[a].end()))
      refuse("samples must run from end to end of an arch", "arch " + std::to_string(a));
  }
  for (const RulingLine& line : ruled.lines)
    for (const OutlinePlace& end : {line.from, line.to}) {
      if (end.use < 0 || end.use >= static_cast<int>(patch.boundary.size()))
        refuse("a ruling has no such outline", where);
      const auto edges = static_cast<double>(layout.arches[patch.boundary[end.use].arch].edges.size());
      if (!(end.at >= 0 && end.at <= edges)) refuse("a ruling ends outside of its arch", where);
    }
}

void check_input(const PatchLayout& layout, const std::vector<RuledPatch>& patches,
                 const std::vector<std::vector<double>>& samples) {
  if (patches.size() != layout.patches.size()) refuse("one entry per patch is needed", "patches");
  if (samples.size() != layout.arches.size()) refuse("one entry per arch is needed", "arch samples");
  for (std::size_t p = 0; p < patches.size(); ++p)
    if (patches[p].chart != nullptr) check_patch_input(layout, samples, static_cast<int>(p), patches[p]);
}

std::vector<ArchStops> arch_stops(const PatchLayout& layout, const std::vector<RuledPatch>& patches,
                                  const std::vector<std::vector<double>>& samples) {
  std::vector<std::vector<double>> at = samples;
  std::vector<char> used(samples.size(), 0);
  for (std::size_t p = 0; p < patches.size(); ++p) {
    if (patches[p].chart == nullptr) continue;
    const auto& boundary = layout.patches[p].boundary;
    for (const ArchUse& use : boundary) used[use.arch] = 1;
    for (const RulingLine& line : patches[p].lines)
      for (const OutlinePlace& end : {line.from, line.to}) at[boundary[end.use].arch].push_back(end.at);
  }
  std::vector<ArchStops> stops(samples.size());
  for (std::size_t a = 0; a < samples.size(); ++a)
    if (used[a]) stops[a] = ArchStops(static_cast<int>(layout.arches[a].edges.size()), std::move(at[a]));
  return stops;
}

std::vector<double> isotropy_factors(const CurvatureField* curvature) {
  if (curvature == nullptr) return {};
  std::vector<double> factor(curvature->k_min.size(), 1);
  for (std::size_t v = 0; v < factor.size(); ++v) {
    const double large = std::abs(curvature->k_max[v]);
    if (large > 0) factor[v] = 1 - std::min(1.0, std::abs(curvature->k_min[v]) / large);
  }
  return factor;
}

// Appends a patch; its ids move up by those of the patches before it.
void append(const Patch& patch, int p, CutPatch cut, RuledMesh& mesh) {
  const int first = mesh.size();
  mesh.rest.insert(mesh.rest.end(), cut.rest.begin(), cut.rest.end());
  mesh.uv.insert(mesh.uv.end(), cut.uv.begin(), cut.uv.end());
  mesh.isotropy.insert(mesh.isotropy.end(), cut.isotropy.begin(), cut.isotropy.end());
  mesh.patch.resize(mesh.rest.size(), p);
  mesh.on_ruling.resize(mesh.rest.size(), 0);
  mesh.on_border.resize(mesh.rest.size(), 0);
  for (std::array<int, 3> t : cut.triangles)
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  for (std::size_t u = 0; u < cut.sides.size(); ++u) {
    for (int& v : cut.sides[u]) mesh.on_border[v += first] = 1;
    // Without rulings nothing else would hold the patch.
    if (cut.rulings.empty())
      for (int v : cut.sides[u]) mesh.on_ruling[v] = 1;
    mesh.sides.push_back({patch.boundary[u].arch, p, std::move(cut.sides[u])});
  }
  for (RuledMesh::Ruling& r : cut.rulings) {
    for (int& v : r.vertices) mesh.on_ruling[v += first] = 1;
    r.patch = p;
    mesh.rulings.push_back(std::move(r));
  }
}

void list_seams(int arches, FullMorphProblem& problem) {
  std::vector<int> first_side(arches, -1);
  for (std::size_t s = 0; s < problem.mesh.sides.size(); ++s) {
    const RuledMesh::Side& side = problem.mesh.sides[s];
    int& other = first_side[side.arch];
    if (other < 0) {
      other = static_cast<int>(s);
      continue;
    }
    const auto& partner = problem.mesh.sides[other].vertices;
    for (std::size_t k = 0; k < partner.size(); ++k)
      if (partner[k] != side.vertices[k])
        problem.seams.emplace_back(std::min(partner[k], side.vertices[k]),
                                   std::max(partner[k], side.vertices[k]));
  }
  std::sort(problem.seams.begin(), problem.seams.end());
  problem.seams.erase(std::unique(problem.seams.begin(), problem.seams.end()), problem.seams.end());
}

void list_outline(const PatchLayout& layout, FullMorphProblem& problem) {
  for (const RuledMesh::Side& side : problem.mesh.sides) {
    const auto& v = side.vertices;
    for (std::size_t k = 1; k + 1 < v.size(); ++k) problem.outline.push_back({v[k - 1], v[k], v[k + 1]});
    const bool smooth_loop = v.front() == v.back() && !layout.node[layout.arches[side.arch].vertices.front()];
    if (smooth_loop && v.size() > 3) problem.outline.push_back({v[v.size() - 2], v[0], v[1]});
  }
}

void list_arches(const SurfaceMesh& mesh, const PatchLayout& layout, const std::vector<ArchStops>& stops,
                 const std::vector<std::vector<double>>& samples, FullMorphProblem& problem) {
  const std::size_t n = layout.arches.size();
  problem.arch_stop.resize(n);
  problem.arch_rest.resize(n);
  problem.held.resize(n);
  for (std::size_t a = 0; a < n; ++a) {
    const Arch& arch = layout.arches[a];
    problem.arch_nodes.push_back({arch.vertices.front(), arch.vertices.back()});
    if (stops[a].count() == 0) continue;
    for (double at : samples[a]) {
      problem.arch_stop[a].push_back(stops[a].nearest(at));
      problem.arch_rest[a].push_back(arch_point(mesh, arch, at));
    }
  }
}

}  // namespace

std::vector<RulingLine> ruling_lines(const Patch& patch, const PatchPolygon& polygon,
                                     const RulingSet& rulings,
                                     const std::vector<std::vector<double>>& arch_samples) {
  const auto place = [&](int point) {
    const PatchPolygon::Origin& o = polygon.origin[point];
    return OutlinePlace{o.use, arch_samples[patch.boundary[o.use].arch][o.sample]};
  };
  std::vector<RulingLine> lines;
  for (const RulingSet::Chord& c : rulings.chords) lines.push_back({place(c.a), place(c.b)});
  return lines;
}

FullMorphProblem full_morph_problem(const SurfaceMesh& mesh, const PatchLayout& layout,
                                    const std::vector<RuledPatch>& patches,
                                    const std::vector<std::vector<double>>& arch_samples,
                                    const CurvatureField* curvature, const RunContext& context) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  check_input(layout, patches, arch_samples);
  const auto stops = arch_stops(layout, patches, arch_samples);
  const auto isotropy = isotropy_factors(curvature);
  std::vector<CutPatch> cut(patches.size());
  parallel_for(context, static_cast<int>(patches.size()), [&](int p) {
    context.checkpoint();
    if (patches[p].chart != nullptr) cut[p] = cut_patch(mesh, layout.patches[p], patches[p], stops, isotropy);
  });
  FullMorphProblem problem;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    problem.dropped += cut[p].dropped;
    append(layout.patches[p], static_cast<int>(p), std::move(cut[p]), problem.mesh);
  }
  list_seams(static_cast<int>(layout.arches.size()), problem);
  list_outline(layout, problem);
  list_arches(mesh, layout, stops, arch_samples, problem);
  problem.patches = static_cast<int>(patches.size());
  problem.build_seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return problem;
}

}  // namespace sheetform
