#include "sheetform/search/component.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <tuple>
#include <utility>

#include "sheetform/base/error.h"
#include "sheetform/search/finish.h"
#include "sheetform/strip/certificate.h"

namespace sheetform {
namespace {

// A finer measurement finds a little more than the one made here.
constexpr double kMeasured = 0.993;
constexpr int kQuickSamples = 4000, kSamples = 20000;  // the latter as the certificate takes them
constexpr double kOnPlane = 1e-9;                      // of the diagonal

constexpr int kFinerAttempts = 3;
constexpr const char* kFiner = "a part thinner than the tolerance was kept by working to a finer one";

class Laps {
 public:
  void lap(Stage stage) {
    const auto now = Clock::now();
    seconds_[to_string(stage)] += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }
  // The seconds since the last time; stages that took none are named too.
  std::map<std::string, double> take() {
    for (Stage stage : {Stage::kField, Stage::kTrace, Stage::kInsert}) seconds_[to_string(stage)] += 0;
    return std::exchange(seconds_, {});
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::map<std::string, double> seconds_;
  Clock::time_point last_ = Clock::now();
};

// The layout as strips, and what is still wrong with it.
struct Attempt {
  StripMesh strips;
  std::vector<int> invalid;   // patches that break a strict promise
  std::vector<int> too_far;   // valid patches beyond the tolerance
  std::vector<FarPlace> far;  // what the next morph should know
  double distance = 0;
  bool good() const { return invalid.empty() && too_far.empty(); }
};

class ComponentRun {
 public:
  ComponentRun(const ComponentInput& input, const ComponentParams& params, RunContext& context)
      : input_(input),
        params_(params),
        context_(context),
        tree_(input.reference.points, input.reference.faces, context) {}

  std::vector<ComponentResult> run(const std::vector<double>& tolerances) {
    params_.evaluation.e_max = tolerances.front();
    const SurfaceMesh& mesh = input_.prepared.mesh;
    const auto& crease = input_.prepared.crease_edge;
    context_.report(Stage::kField, 0);
    const CurvatureField curvature = principal_curvature(mesh, crease, {}, context_);
    const CrossField field =
        cross_field(mesh, crease, curvature, input_.guide.empty() ? nullptr : &input_.guide, {}, context_);
    laps_.lap(Stage::kField);
    context_.report(Stage::kTrace, 0);
    const TracingGraph graph = tracing_graph(mesh, crease, field, {}, context_);
    TraceParams trace;
    trace.seeds = params_.seeds;
    std::vector<Path> candidates = trace_candidates(mesh, graph, field, trace, context_);
    laps_.lap(Stage::kTrace);
    set_up_surface(curvature);
    const PathNetwork start = start_network();
    std::vector<std::unique_ptr<LayoutSearch>> searches;
    searches.push_back(std::make_unique<LayoutSearch>(surface_, start, graph, std::move(candidates),
                                                      search_params(), context_));
    std::vector<ComponentResult> results;
    for (double e_max : tolerances) {
      params_.evaluation.e_max = e_max;
      if (!results.empty())
        searches.push_back(std::make_unique<LayoutSearch>(*searches.back(), start, search_params()));
      ComponentResult result = solve(*searches.back());
      if (!results.empty() && result.strips.patches.size() > results.back().strips.patches.size())
        result.strips = results.back().strips, result.distance = results.back().distance;
      results.push_back(std::move(result));
    }
    return results;
  }

 private:
  void set_up_surface(const CurvatureField& curvature) {
    surface_.mesh = input_.prepared.mesh;
    surface_.versions.assign(surface_.mesh.points.size(), 0);
    surface_.guide = surface_guide(surface_.mesh, curvature);
    surface_.input = &tree_;
    surface_.details = find_details();
    surface_.elimination_rank = elimination_rank(surface_.mesh);
    if (input_.half) surface_.plane = plane_border(surface_.mesh, kOnPlane);
  }

  PathNetwork start_network() const {
    PathNetwork network = bare_network(surface_.mesh);
    if (input_.half) add_symmetry(surface_.plane.edge, network);
    add_creases(surface_.mesh, input_.prepared.crease_edge, network);
    return network;
  }

  SearchParams search_params() const {
    SearchParams search;
    search.evaluation = params_.evaluation;
    search.evaluation.e_max *= params_.margin;
    return search;
  }

  // From the bare network to the strips; what is shared counts for the first tolerance.
  ComponentResult solve(LayoutSearch& search) {
    search.insert();
    laps_.lap(Stage::kInsert);
    reduce(search);
    if (input_.half) search.straighten_plane();
    laps_.lap(Stage::kRemove);
    finish(search);
    laps_.lap(Stage::kFinal);
    result_.seconds = laps_.take();
    return std::exchange(result_, {});
  }

  // Points of the input that the working mesh misses by more than a small share of the tolerance.
  std::vector<DetailPoint> find_details() const {
    const SurfaceMesh& mesh = input_.prepared.mesh;
    std::vector<DetailPoint> details;
    if (!input_.prepared.remeshed) return details;
    const ClosestPointTree working(mesh.points, mesh.faces, context_);
    const double least = 0.06 * params_.evaluation.e_max;
    for (std::size_t i = 0; i < input_.reference.points.size(); ++i) {
      if (i % 4096 == 0) context_.checkpoint();
      const Vector3& p = input_.reference.points[i];
      const ClosestPoint hit = working.closest(p);
      if (hit.squared_distance > least * least) details.push_back({p, hit.barycentric, hit.face});
    }
    std::stable_sort(details.begin(), details.end(),
                     [](const DetailPoint& a, const DetailPoint& b) { return a.face < b.face; });
    return details;
  }

  void reduce(LayoutSearch& search) {
    search.remove_paths();
    if (params_.evaluation.t_junctions) {
      search.smooth_what_allows();
      search.remove_arches();
      search.smooth_what_allows();
      search.remove_arches();
      search.improve(tries(search), params_.seed);
      search.smooth_what_allows();
      search.remove_arches();
    }
  }

  // Few parts are soon tried out.
  int tries(LayoutSearch& search) const {
    return std::min(params_.improvements, 3 * static_cast<int>(search.layout().patches.size()));
  }

  // Final strips of the present layout; what breaks a promise is split, until nothing does.
  void finish(LayoutSearch& search) {
    bool have_best = false;
    double best = 0;
    for (int round = 0; round < 80; ++round) {
      context_.report(Stage::kFinal, round / (round + 4.0));
      const Attempt attempt = build_best(search);
      const bool valid = attempt.invalid.empty();
      if (search.release_plane(valid ? attempt.too_far : attempt.invalid) > 0) continue;
      if (attempt.invalid.empty()) {
        // More parts must buy less error.
        if (!have_best || attempt.distance < best)
          result_.strips = attempt.strips, result_.distance = best = attempt.distance;
        have_best = true;
        if (attempt.too_far.empty() || round >= 30) return;
        search.reject(attempt.too_far);
        if (search.split(attempt.too_far, PatchVerdict::kError) == 0) return;
      } else if (search.reject(attempt.invalid), search.split(attempt.invalid, PatchVerdict::kOverlap) == 0) {
        break;
      }
      if (round < 6 && params_.evaluation.t_junctions) search.remove_arches();
    }
    if (!have_best) throw Error(ErrorCode::kInternal, "no valid strips were found for a component");
  }

  // Fine outlines bend more smoothly; coarser ones, as the search had them, when those do not fit.
  Attempt build_best(LayoutSearch& search) {
    Attempt best = build(search, params_.fine_spacing);
    for (double spacing = 1.4 * params_.fine_spacing; spacing <= params_.evaluation.spacing && !best.good();
         spacing *= 1.4) {
      Attempt other = build(search, spacing);
      if (rank(other) < rank(best)) best = std::move(other);
    }
    return best;
  }

  Attempt build(LayoutSearch& search, double spacing) {
    EvaluationParams fine = params_.evaluation;
    fine.e_max *= params_.margin;
    fine.spacing = spacing;
    FinalPass pass(surface_, search.network().network(), search.layout(), fine, search.evaluator(), context_);
    Attempt best;
    for (int step = 0, stale = 0; step < 16; ++step) {
      const FinishedLayout finished = pass.solve(10);
      Attempt attempt = measured(finished, kQuickSamples);
      if (attempt.good()) attempt = measured(finished, kSamples);
      if (attempt.good()) return attempt;
      const bool better = step == 0 || rank(attempt) < rank(best);
      stale = better ? 0 : stale + 1;
      const std::vector<int> bad = attempt.invalid.empty() ? attempt.too_far : attempt.invalid;
      pass.draw_to(attempt.far);
      if (better) best = std::move(attempt);
      if (!best.invalid.empty() || stale >= 2) {
        if (!pass.plainer(bad)) break;
        stale = 0;
      }
    }
    return best;
  }

  static std::tuple<std::size_t, std::size_t, double> rank(const Attempt& a) {
    return {a.invalid.size(), a.too_far.size(), a.distance};
  }

  Attempt measured(const FinishedLayout& finished, int samples) {
    Attempt attempt;
    attempt.invalid = finished.failing;
    if (!attempt.invalid.empty()) return attempt;
    attempt.strips = assemble_strips(finished.source);
    for (int p = 0; p < static_cast<int>(attempt.strips.patches.size()); ++p)
      if (!check_patch(attempt.strips, p, 1.0).empty()) attempt.invalid.push_back(p);
    if (!attempt.invalid.empty()) return attempt;
    DistanceReport d = measure_distance(input_.reference, tree_, attempt.strips, samples, context_,
                                        params_.margin * params_.evaluation.e_max);
    attempt.distance = d.hausdorff();
    attempt.far = std::move(d.far);
    for (int p = 0; p < static_cast<int>(attempt.strips.patches.size()); ++p)
      if (d.patch_error[p] > kMeasured * params_.evaluation.e_max) attempt.too_far.push_back(p);
    return attempt;
  }

  const ComponentInput& input_;
  ComponentParams params_;
  RunContext& context_;
  ClosestPointTree tree_;
  SearchSurface surface_;
  ComponentResult result_;
  Laps laps_;
};

// Two sides of a plate thinner than the tolerance may have become one: finer parts keep them apart.
ComponentResult kept_apart(ComponentResult result, const ComponentInput& input, ComponentParams params,
                           RunContext& context) {
  for (int attempt = 0; attempt < kFinerAttempts; ++attempt) {
    if (check_structure(result.strips, &input.prepared.mesh, params.evaluation.max_sides, 1.0).empty()) break;
    params.evaluation.e_max /= 2;
    result = ComponentRun(input, params, context).run({params.evaluation.e_max}).front();
    result.notes.push_back(kFiner);
  }
  return result;
}

}  // namespace

ComponentResult decompose_component(const ComponentInput& input, const ComponentParams& params,
                                    RunContext& context) {
  return sweep_component(input, params, {params.evaluation.e_max}, context).front();
}

std::vector<ComponentResult> sweep_component(const ComponentInput& input, const ComponentParams& params,
                                             const std::vector<double>& e_max, RunContext& context) {
  std::vector<ComponentResult> results = ComponentRun(input, params, context).run(e_max);
  for (std::size_t k = 0; k < results.size(); ++k) {
    ComponentParams own = params;
    own.evaluation.e_max = e_max[k];
    results[k] = kept_apart(std::move(results[k]), input, own, context);
  }
  return results;
}

}  // namespace sheetform
