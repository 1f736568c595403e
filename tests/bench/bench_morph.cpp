// The paper's full morph beside the reduced one, on layouts that the search finds for mesh files.
//   bench_morph [--e-max 0.02] [--spacing 0.03] [--patches] mesh...
// Per mesh one line for each morph: unknowns, seconds, the largest displacement of a point on a ruling
// (fraction of the bounding box' diagonal), the largest distance between the strips over the moved outlines
// and the surface, and how smooth the outlines are: the mean turn between two pieces of an arch, in degrees
// (first of all that of the arches on the surface). Then how the displacements per patch compare. --patches
// lists them.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "sheetform/mesh/creases.h"
#include "sheetform/mesh/mesh_io.h"
#include "sheetform/mesh/mesh_repair.h"
#include "sheetform/mesh/prepare.h"
#include "sheetform/morph/full_morph.h"
#include "sheetform/search/layout_search.h"

namespace sheetform {
namespace {

struct Options {
  double e_max = 0.02, spacing = 0.03;
  bool patches = false;
  std::vector<std::string> files;
};

Options parse(int argc, char** argv) {
  Options o;
  for (int i = 1; i < argc; ++i) {
    const std::string arg = argv[i];
    if (arg == "--e-max" && i + 1 < argc)
      o.e_max = std::stod(argv[++i]);
    else if (arg == "--spacing" && i + 1 < argc)
      o.spacing = std::stod(argv[++i]);
    else if (arg == "--patches")
      o.patches = true;
    else
      o.files.push_back(arg);
  }
  return o;
}

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

SurfaceMesh normalised(SurfaceMesh mesh) {
  const double diagonal = bounding_box_diagonal(mesh.points);
  for (Vector3& p : mesh.points) p /= diagonal;
  return mesh;
}

// A searched layout and both morphs of it. All components of the mesh are one problem.
class Comparison {
 public:
  Comparison(const std::string& file, const Options& options) {
    const MeshFile read = read_mesh_file(file);
    const SurfaceMesh input = normalised(repair(read.soup, context_).mesh);
    tree_ = ClosestPointTree(input.points, input.faces);
    const PreparedMesh prepared = prepare(input, detect_creases(input, 40), 0.022, context_);
    find_layout(prepared, options);
  }

  void run(const std::string& name, bool list) {
    RunContext& context = context_;
    LayoutEvaluator evaluator(surface_, params_, context);
    const auto patches = evaluator.patches(layout_);
    LayoutEvaluation reduced;
    double reduced_seconds = 1e9;
    for (int i = 0; i < 3; ++i)
      reduced_seconds =
          std::min(reduced_seconds, seconds_of([&] { reduced = evaluator.solve(layout_, patches, 0); }));
    const auto reduced_step = displacements(reduced);
    std::printf("%s: %d faces, %zu patches, turn on the surface %.2f\n", name.c_str(),
                surface_.mesh.face_count(), patches.size(),
                mean_turn([&](std::size_t a) { return rest(a); }));
    std::printf(
        "  %-22s %7zu unknowns                    %.4f s (distances included)  displacement %.4f  distance "
        "%.4f  turn %.2f\n",
        "reduced", reduced.position.size(), reduced_seconds, largest(reduced_step), reduced_distance(reduced),
        mean_turn([&](std::size_t a) { return moved(reduced, a); }));
    const FullMorphProblem problem = full_problem(patches);
    for (const auto& [label, weights] :
         {std::pair{"full, paper's weights", FullMorphWeights{}},
          std::pair{"full, any resolution", resolution_independent_weights()}}) {
      const FullMorphResult full = full_morph(problem, weights, context);
      print(label, problem, full, reduced);
      compare(full, reduced_step, list);
    }
  }

 private:
  void find_layout(const PreparedMesh& prepared, const Options& options) {
    const SurfaceMesh& mesh = prepared.mesh;
    curvature_ = principal_curvature(mesh, prepared.crease_edge, {}, context_);
    const CrossField field = cross_field(mesh, prepared.crease_edge, curvature_, nullptr, {}, context_);
    const TracingGraph graph = tracing_graph(mesh, prepared.crease_edge, field, {}, context_);
    surface_.mesh = mesh;
    surface_.versions.assign(mesh.points.size(), 0);
    surface_.guide = surface_guide(mesh, curvature_);
    surface_.input = &tree_;
    PathNetwork network = bare_network(mesh);
    add_creases(mesh, prepared.crease_edge, network);
    SearchParams search_params;
    search_params.evaluation.e_max = options.e_max;
    LayoutSearch search(surface_, std::move(network), graph,
                        trace_candidates(mesh, graph, field, {}, context_), search_params, context_);
    search.insert();
    search.remove_paths();
    layout_ = search.layout();
    params_ = search_params.evaluation;
    params_.spacing = options.spacing;
  }

  FullMorphProblem full_problem(const std::vector<std::shared_ptr<const PatchEvaluation>>& patches) const {
    std::vector<std::vector<double>> samples;
    for (const Arch& a : layout_.arches) samples.push_back(sample_arch(surface_.mesh, a, params_.spacing));
    std::vector<RuledPatch> ruled(patches.size());
    for (std::size_t p = 0; p < ruled.size(); ++p)
      if (patches[p]->chart != nullptr)
        ruled[p] = {patches[p]->chart.get(),
                    ruling_lines(layout_.patches[p], patches[p]->polygon, patches[p]->rulings, samples)};
    return full_morph_problem(surface_.mesh, layout_, ruled, samples, &curvature_, context_);
  }

  // Per patch: the largest displacement at its ruling samples.
  std::vector<double> displacements(const LayoutEvaluation& e) const {
    std::vector<double> worst(e.patches.size(), 0);
    for (std::size_t p = 0; p < worst.size(); ++p)
      for (MorphSample s : e.patches[p]->samples) {
        if (s.weight <= 0) continue;
        for (int& u : s.unknown) u = e.unknowns[p][u];
        worst[p] = std::max(worst[p], (s.at(e.position) - s.target).norm());
      }
    return worst;
  }

  // Largest distance of the strips over moved outlines from the surface, as the search measures it.
  double distance(const LayoutEvaluation& e,
                  const std::function<Vector3(std::size_t, int)>& outline_point) const {
    double worst = 0;
    for (std::size_t p = 0; p < e.patches.size(); ++p) {
      const PatchEvaluation& patch = *e.patches[p];
      std::vector<Vector3> position(patch.polygon.size());
      for (int i = 0; i < patch.polygon.size(); ++i) position[i] = outline_point(p, i);
      worst =
          std::max(worst, patch_error(patch.samples, patch.rulings.triangles, position, tree_, 0, nullptr));
    }
    return worst;
  }
  double reduced_distance(const LayoutEvaluation& e) const {
    return distance(e, [&](std::size_t p, int i) { return e.position[e.unknowns[p][i]]; });
  }
  double full_distance(const FullMorphResult& full, const LayoutEvaluation& e) const {
    return distance(e, [&](std::size_t p, int i) {
      const auto& origin = e.patches[p]->polygon.origin[i];
      return full.arch_points[layout_.patches[p].boundary[origin.use].arch][origin.sample];
    });
  }

  void print(const char* label, const FullMorphProblem& problem, const FullMorphResult& full,
             const LayoutEvaluation& reduced) const {
    const FullMorphFigures& f = full.figures;
    std::printf(
        "  %-22s %7d unknowns %8lld nonzeros  %.4f s (cut %.3f rows %.3f factor %.3f solve %.3f)"
        "  displacement %.4f  distance %.4f  turn %.2f  gap %.4f  bow %.4f  %zu rulings, %d dropped\n",
        label, f.unknowns, f.nonzeros,
        problem.build_seconds + f.assemble_seconds + f.factor_seconds + f.solve_seconds,
        problem.build_seconds, f.assemble_seconds, f.factor_seconds, f.solve_seconds,
        largest(full.ruling_displacement), full_distance(full, reduced),
        mean_turn([&](std::size_t a) { return full.arch_points[a]; }), full.gap, full.bow,
        problem.mesh.rulings.size(), problem.dropped);
  }

  std::vector<Vector3> rest(std::size_t arch) const {
    std::vector<Vector3> points;
    for (double at : sample_arch(surface_.mesh, layout_.arches[arch], params_.spacing))
      points.push_back(arch_point(surface_.mesh, layout_.arches[arch], at));
    return points;
  }
  static std::vector<Vector3> moved(const LayoutEvaluation& e, std::size_t arch) {
    std::vector<Vector3> points;
    for (int u : e.arch_unknowns[arch]) points.push_back(e.position[u]);
    return points;
  }
  // Degrees between consecutive pieces, over all arches.
  double mean_turn(const std::function<std::vector<Vector3>(std::size_t)>& points_of) const {
    double sum = 0;
    int count = 0;
    for (std::size_t a = 0; a < layout_.arches.size(); ++a) {
      const std::vector<Vector3> p = points_of(a);
      for (std::size_t i = 1; i + 1 < p.size(); ++i, ++count) {
        const Vector3 in = p[i] - p[i - 1], out = p[i + 1] - p[i];
        sum += std::atan2(in.cross(out).norm(), in.dot(out));
      }
    }
    return count > 0 ? sum / count * 180 / 3.14159265358979323846 : 0;
  }

  static double largest(const std::vector<double>& x) {
    return x.empty() ? 0 : *std::max_element(x.begin(), x.end());
  }

  static void compare(const FullMorphResult& full, const std::vector<double>& reduced, bool list) {
    const std::vector<double>& a = full.ruling_displacement;
    const auto n = static_cast<double>(a.size());
    std::vector<double> ratio;
    double ma = 0, mb = 0, ab = 0, aa = 0, bb = 0;
    for (std::size_t p = 0; p < a.size(); ++p) ma += a[p] / n, mb += reduced[p] / n;
    for (std::size_t p = 0; p < a.size(); ++p) {
      ab += (a[p] - ma) * (reduced[p] - mb), aa += (a[p] - ma) * (a[p] - ma),
          bb += (reduced[p] - mb) * (reduced[p] - mb);
      if (a[p] > 0) ratio.push_back(reduced[p] / a[p]);
      if (list) std::printf("    patch %3zu  full %.4f  reduced %.4f\n", p, a[p], reduced[p]);
    }
    if (ratio.empty()) return;
    std::sort(ratio.begin(), ratio.end());
    std::printf("    reduced / full per patch: correlation %.2f, ratio %.2f .. %.2f .. %.2f\n",
                ab / std::sqrt(std::max(aa * bb, 1e-300)), ratio.front(), ratio[ratio.size() / 2],
                ratio.back());
  }

  RunContext context_;
  ClosestPointTree tree_;
  SearchSurface surface_;
  CurvatureField curvature_;
  PatchLayout layout_;
  EvaluationParams params_;
};

}  // namespace
}  // namespace sheetform

int main(int argc, char** argv) {
  const sheetform::Options options = sheetform::parse(argc, argv);
  if (options.files.empty()) {
    std::fprintf(stderr, "usage: bench_morph [--e-max 0.02] [--spacing 0.03] [--patches] mesh...\n");
    return 2;
  }
  int status = 0;
  for (const std::string& file : options.files) try {
      sheetform::Comparison(file, options).run(std::filesystem::path(file).stem().string(), options.patches);
    } catch (const std::exception& e) {
      std::fprintf(stderr, "%s: %s\n", file.c_str(), e.what());
      status = 1;
    }
  return status;
}
