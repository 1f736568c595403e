#include "sheetform/decompose.h"

#include <chrono>
#include <algorithm>
#include <cmath>

#include "sheetform/search/finish.h"
#include "sheetform/search/layout_search.h"

namespace sheetform {
namespace {

using Clock = std::chrono::steady_clock;

// Adds the seconds since the last lap to a named timing.
class Laps {
 public:
  explicit Laps(std::map<std::string, double>& timings) : timings_(timings), last_(Clock::now()) {}
  void lap(const std::string& name) {
    const auto now = Clock::now();
    timings_[name] += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

 private:
  std::map<std::string, double>& timings_;
  Clock::time_point last_;
};

// The similarity that puts the input's bounding box to diagonal 1 around the origin.
struct Normalisation {
  Vector3 centre = Vector3::Zero();
  double diagonal = 1;
  Vector3 in(const Vector3& p) const { return (p - centre) / diagonal; }
  Vector3 out(const Vector3& p) const { return p * diagonal + centre; }
};

Normalisation normalisation(const TriangleSoup& soup) {
  Normalisation n;
  Vector3 lo = soup.points.front(), hi = lo;
  for (const Vector3& p : soup.points) lo = lo.cwiseMin(p), hi = hi.cwiseMax(p);
  n.centre = (lo + hi) / 2;
  n.diagonal = (hi - lo).norm();
  return n;
}

EvaluationParams evaluation_params(const DecomposeParams& params, double e_max) {
  EvaluationParams e;
  e.e_max = e_max;
  e.max_sides = params.max_sides;
  e.self_seams = params.self_seams;
  e.t_junctions = params.t_junctions;
  auto env = [](const char* n, double d) { const char* v = std::getenv(n); return v ? std::atof(v) : d; };
  e.morph.rounds = (int)env("ROUNDS", e.morph.rounds); e.morph.slide = env("SLIDE", e.morph.slide); e.morph.smooth = env("SMOOTHW", e.morph.smooth);
  e.ruling.align_weight = env("ALIGN", e.ruling.align_weight); e.ruling.twist_weight = env("TWIST", e.ruling.twist_weight); e.e_max *= env("EFRAC", 1); e.spacing = env("SPACING", e.spacing); e.corner_turn = env("TURN", e.corner_turn);
  return e;
}

StripMesh decompose_component(const SurfaceMesh& mesh, const std::vector<char>& crease_edge, const ClosestPointTree& tree,
                              const TriangleSoup& reference, const DecomposeParams& params, double e_max, Report& report,
                              RunContext& context) {
  Laps laps(report.timings);
  const CurvatureField curvature = principal_curvature(mesh, crease_edge, {}, context);
  const CrossField field = cross_field(mesh, crease_edge, curvature, nullptr, {}, context);
  laps.lap("field");
  const TracingGraph graph = tracing_graph(mesh, crease_edge, field, {}, context);
  std::vector<Path> candidates = trace_candidates(mesh, graph, field, {}, context);
  laps.lap("trace");
  SearchSurface surface;
  surface.mesh = mesh;
  surface.versions.assign(mesh.points.size(), 0);
  surface.guide = surface_guide(mesh, curvature);
  surface.input = &tree;
  PathNetwork network = bare_network(mesh);
  SearchParams search_params;
  search_params.evaluation = evaluation_params(params, 0.95 * e_max); search_params.lawson_rounds = search_params.evaluation.morph.rounds;
  LayoutSearch search(surface, std::move(network), graph, std::move(candidates), search_params, context);
  search.insert();
  report.notes.push_back("inserted: " + std::to_string(search.layout().patches.size()) + " patches, failing " + std::to_string(search.evaluation().failing));
  for (std::size_t i=0;i<search.evaluation().patches.size();++i) { auto& pe=*search.evaluation().patches[i]; if (!pe.viable() || search.evaluation().patch_error[i]>search_params.evaluation.e_max) report.notes.push_back(std::string("fail ")+to_string(pe.verdict)+" faces "+std::to_string(search.layout().patches[i].faces.size())+" corners "+std::to_string(pe.corners.size())+" err "+std::to_string(pe.error)+" global "+std::to_string(search.evaluation().patch_error[i])+" m "+std::to_string(pe.polygon.size())+" defect "+std::to_string((int)search.layout().patches[i].defect)); }
  laps.lap("insert");
  search.remove_paths();
  report.notes.push_back("paths removed: " + std::to_string(search.layout().patches.size()));
  if (params.t_junctions) search.remove_arches();
  report.notes.push_back("arches removed: " + std::to_string(search.layout().patches.size()));
  laps.lap("remove");
  if (const char* tries = std::getenv("TRIES")) { int k = search.improve(std::atoi(tries), 1); report.notes.push_back("improved " + std::to_string(k) + ": " + std::to_string(search.layout().patches.size())); }
  if (std::getenv("DIAG")) for (auto& l : search.diagnose()) report.notes.push_back(l);
  laps.lap("improve");
  StripMesh best;
  for (int attempt = 0; attempt < 12; ++attempt) {
    search.smooth();
    EvaluationParams fine = evaluation_params(params, 0.95 * e_max);
    fine.spacing = 0.015;
    const FinishedLayout finished = finish_layout(surface, search.network().network(), search.layout(), fine, 8, context);
    if (!finished.failing.empty()) {
      std::string why;
      for (PatchVerdict v : finished.why) why += std::string(" ") + to_string(v);
      report.notes.push_back("final pass: split" + why);
      if (search.split(finished.failing, PatchVerdict::kOverlap) > 0) continue;
    }
    best = assemble_strips(finished.source);
    const DistanceReport d = measure_distance(reference, tree, best, 4000, context);
    report.notes.push_back("final pass: " + std::to_string(best.patches.size()) + " patches, distance " + std::to_string(d.input_to_result) + " back " + std::to_string(d.result_to_input) + " own " + std::to_string(*std::max_element(finished.patch_error.begin(), finished.patch_error.end())) + " search " + std::to_string(search.evaluation().max_error));
    std::vector<int> bad;
    for (int p = 0; p < static_cast<int>(best.patches.size()); ++p)
      if (d.patch_error[p] > e_max) bad.push_back(p);
    if (bad.empty()) break;
    if (search.split(bad, PatchVerdict::kError) == 0) break;
  }
  laps.lap("final");
  report.notes.push_back("evaluations " + std::to_string(search.evaluator().evaluations()) + ", hits " + std::to_string(search.evaluator().hits()));
  return best;
}

}  // namespace

void validate(const DecomposeParams& params) {
  if (!(params.e_max > 0 && params.e_max <= 0.5))
    throw Error(ErrorCode::kInvalidParameter, "e_max must be above 0 and at most 0.5", "e_max", "use a fraction of the diagonal such as 0.02");
}

Decomposition decompose(const InputMesh& input, const DecomposeParams& params, const UserField*, RunContext& context) {
  validate(params);
  Decomposition result;
  result.params = params;
  Laps laps(result.report.timings);
  const Normalisation norm = normalisation(input.soup);
  TriangleSoup soup = input.soup;
  for (Vector3& p : soup.points) p = norm.in(p);
  const ClosestPointTree tree(soup.points, soup.faces);
  const SurfaceMesh mesh = build_surface_mesh(soup.points, soup.faces);
  laps.lap("prepare");
  StripMesh strips = decompose_component(mesh, std::vector<char>(mesh.edges.size(), 0), tree, soup, params, params.e_max, result.report, context);
  for (Vector3& p : strips.points) p = norm.out(p);
  for (Vector2& u : strips.uvs) u *= norm.diagonal;
  result.strips = std::move(strips);
  result.bbox_diagonal = norm.diagonal;
  result.input_vertices = static_cast<int>(input.soup.points.size());
  result.input_faces = static_cast<int>(input.soup.faces.size());
  const SurfaceMesh original = build_surface_mesh(input.soup.points, input.soup.faces);
  result.certificate = certify(input.soup, &original, result.strips, params.max_sides, 20000, context);
  result.report.patches = static_cast<int>(result.strips.patches.size());
  result.report.hausdorff = result.certificate.distance.hausdorff() / norm.diagonal;
  result.report.mean_distance = result.certificate.distance.mean / norm.diagonal;
  result.report.e_max_met = result.report.hausdorff <= params.e_max;
  result.report.isometry_error = result.certificate.isometry_error;
  laps.lap("certify");
  return result;
}

}  // namespace sheetform
