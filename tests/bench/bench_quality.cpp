// Quality of results over a set of meshes as a table, and its comparison with an earlier one.
//   bench_quality [options] [mesh...]           runs, prints and writes a table; without meshes: own shapes
//   bench_quality --compare NOW.csv BEFORE.csv  compares two tables by geometric means
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>

#include "bench_run.h"
#include "quality.h"

namespace sheetform::bench {
namespace {

// A share in percent; "-" where there is nothing to share.
std::string share(double x) {
  return x < 0 ? "-" : std::to_string(static_cast<int>(std::lround(100 * x))) + " %";
}

void put_quality(const Quality& q, CsvTable& t) {
  t.put("two_sided_hausdorff", std::max(q.input_to_result, q.result_to_input));
  t.put("input_to_result", q.input_to_result);
  t.put("result_to_input", q.result_to_input);
  t.put("mean_distance", q.mean_distance);
  t.put("normal_deviation", q.normal_deviation);
  t.put("normal_deviation_p95", q.normal_deviation_p95);
  t.put("aligned", q.aligned < 0 ? std::string() : std::to_string(q.aligned));
  t.put("aligned_where", q.aligned_where);
  t.put("bend", q.bend);
  t.put("smallest_area", q.smallest_area);
  t.put("narrowest", q.narrowest);
  t.put("small_parts", q.small_parts);
  t.put("narrow_parts", q.narrow_parts);
  t.put("creases_kept", q.creases_kept < 0 ? std::string() : std::to_string(q.creases_kept));
  t.put("sharp_kept", q.sharp_kept < 0 ? std::string() : std::to_string(q.sharp_kept));
  t.put("sharp_length", q.sharp_length);
  t.put("self_seams", q.self_seams);
  t.put("t_junctions", q.t_junctions);
}

void row(const InputMesh& input, const DecomposeParams& params, const Options& options, CsvTable& table) {
  RunContext context;
  context.threads = options.threads;
  const auto begin = std::chrono::steady_clock::now();
  const Decomposition result = decompose(input, params, nullptr, context);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const Quality q = measure_quality(input, result, context);
  table.put("patches", result.report.patches);
  table.put("valid", result.certificate.strict());
  table.put("tolerance_met", std::max(q.input_to_result, q.result_to_input) <= params.e_max);
  table.put("cut_length", result.report.cut_length);
  put_quality(q, table);
  table.put("seconds", seconds);
  std::printf(
      "%-16s %5.3g %3d parts, cut %.2f, Hausdorff %.2f / %.2f %% (mean %.2f), normals %.1f deg (p95 %.1f),",
      input.name.c_str(), params.e_max, result.report.patches, result.report.cut_length,
      100 * q.input_to_result, 100 * q.result_to_input, 100 * q.mean_distance, q.normal_deviation,
      q.normal_deviation_p95);
  std::printf(
      " aligned %s, bend %.1f deg, least part %.2f %% of the area, %.1f %% wide, creases kept %s (all sharp "
      "edges: %s), %.1f s%s\n",
      share(q.aligned).c_str(), q.bend, 100 * q.smallest_area, 100 * q.narrowest,
      share(q.creases_kept).c_str(), share(q.sharp_kept).c_str(), seconds,
      std::max(q.input_to_result, q.result_to_input) <= params.e_max ? "" : ", TOLERANCE NOT MET");
  std::fflush(stdout);
}

}  // namespace
}  // namespace sheetform::bench

int main(int argc, char** argv) try {
  using namespace sheetform::bench;
  if (argc == 4 && std::string(argv[1]) == "--compare") {
    print_comparison(read_csv(argv[2]), read_csv(argv[3]));
    return 0;
  }
  const Options options = parse_options(argc, argv);
  return run_all(options, own_shapes(), row);
} catch (const std::exception& e) {
  std::fprintf(stderr, "bench_quality: %s\n", e.what());
  return 2;
}
