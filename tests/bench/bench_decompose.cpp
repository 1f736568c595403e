// Time and memory of whole runs: seconds by stage, and multiples of a yardstick that is measured in the same
// run on the same mesh, so that machines can be compared (a sparse factorisation of the mesh's Laplacian).
//   bench_decompose [options] [mesh...]   without meshes: one shape with 2 k to 512 k faces
#include <chrono>
#include <cstdio>
#include <exception>

#include "bench_run.h"

namespace sheetform::bench {
namespace {

constexpr const char* kStages[] = {"prepare", "field", "trace", "insert", "remove", "final", "certify"};

struct Timed {
  Decomposition result;
  double wall = 1e300, processor = 0, peak_mb = 0;
};

Timed fastest(const InputMesh& input, const DecomposeParams& params, const Options& options) {
  Timed best;
  for (int i = 0; i < options.repeat; ++i) {
    RunContext context;
    context.threads = options.threads;
    reset_peak_memory();
    const double processor = processor_seconds();
    const auto begin = std::chrono::steady_clock::now();
    Decomposition result = decompose(input, params, nullptr, context);
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (wall < best.wall) best = {std::move(result), wall, processor_seconds() - processor, peak_memory_mb()};
  }
  return best;
}

void row(const InputMesh& input, const DecomposeParams& params, const Options& options, CsvTable& table) {
  const double unit = yardstick(input.soup);
  const Timed timed = fastest(input, params, options);
  const Report& report = timed.result.report;
  table.put("threads", options.threads);
  table.put("patches", report.patches);
  table.put("tolerance_met", report.e_max_met);
  table.put("seconds", timed.wall);
  table.put("processor_seconds", timed.processor);
  table.put("yardstick_ms", 1000 * unit);
  table.put("yardsticks", timed.wall / unit);
  table.put("processor_yardsticks", timed.processor / unit);
  table.put("peak_mb", timed.peak_mb);
  for (const char* stage : kStages) {
    const auto it = report.timings.find(stage);
    table.put(stage, it == report.timings.end() ? 0 : it->second);
  }
  std::printf("%-16s %5.3g %7zu faces %3d parts  %6.2f s (%6.2f processor) %6.0f Y (Y %5.1f ms) %5.0f MB ",
              input.name.c_str(), params.e_max, input.soup.faces.size(), report.patches, timed.wall,
              timed.processor, timed.wall / unit, 1000 * unit, timed.peak_mb);
  for (const auto& [stage, seconds] : report.timings) std::printf(" %s %.2f", stage.c_str(), seconds);
  std::printf("%s\n", report.e_max_met ? "" : "  TOLERANCE NOT MET");
  std::fflush(stdout);
}

}  // namespace
}  // namespace sheetform::bench

int main(int argc, char** argv) try {
  const auto options = sheetform::bench::parse_options(argc, argv);
  return sheetform::bench::run_all(options, sheetform::bench::own_scaling(), sheetform::bench::row);
} catch (const std::exception& e) {
  std::fprintf(stderr, "bench_decompose: %s\n", e.what());
  return 2;
}
