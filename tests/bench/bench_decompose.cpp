// Time, memory and effort of whole runs: seconds by stage, and multiples of a yardstick that is measured in
// the same run on the same mesh, so that machines can be compared (a sparse factorisation of the mesh's
// Laplacian).
//   bench_decompose [options] [mesh...]   without meshes: three shapes with 2 k to 512 k faces
//   bench_decompose --coarse 2000 --refine 4 mesh...   the same for any shapes
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>
#include <tuple>

#include "bench_run.h"

namespace sheetform::bench {
namespace {

constexpr std::array<const char*, 7> kStages{"prepare", "field", "trace",  "insert",
                                             "remove",  "final", "certify"};
using PerStage = std::array<double, kStages.size()>;
constexpr double kTooShort = 0.02;  // seconds: says nothing about growth

std::size_t stage_index(Stage stage, const std::string& message) {
  const char* name = message == kCertifying ? "certify" : to_string(stage);
  for (std::size_t s = 0; s < kStages.size(); ++s)
    if (std::strcmp(kStages[s], name) == 0) return s;
  return 0;
}

// Processor seconds of each stage, by what the progress tells: other programs on the machine do not count.
class StageClock {
 public:
  explicit StageClock(RunContext& context) : last_(processor_seconds()) {
    context.progress = [this](Stage stage, double, const std::string& message) {
      stop();
      now_ = stage_index(stage, message);
    };
  }
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;
  PerStage stop() {
    const double t = processor_seconds();
    seconds_[now_] += t - last_;
    last_ = t;
    return seconds_;
  }

 private:
  PerStage seconds_{};
  std::size_t now_ = 0;
  double last_;
};

struct Timed {
  Decomposition result;
  double wall = 1e300, processor = 1e300, peak_mb = 0;
  PerStage stages{};
};

// The run that took the least of the processor; `wall` is the least of all runs.
Timed fastest(const InputMesh& input, const DecomposeParams& params, const Options& options) {
  Timed best;
  double wall = 1e300;
  for (int i = 0; i < options.repeat; ++i) {
    RunContext context;
    context.threads = options.threads;
    reset_peak_memory();
    StageClock clock(context);
    const auto begin = std::chrono::steady_clock::now();
    Timed run;
    run.result = decompose(input, params, nullptr, context);
    wall = std::min(wall, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    run.stages = clock.stop();
    run.processor = 0;
    for (double s : run.stages) run.processor += s;
    run.peak_mb = peak_memory_mb();
    if (run.processor < best.processor) best = std::move(run);
  }
  best.wall = wall;
  return best;
}

struct Size {
  std::string mesh;
  double faces = 0, e_max = 0;
  PerStage stages{};
};
std::vector<Size> sizes;  // of the runs so far, for the growth

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
  table.put("evaluations", static_cast<double>(report.counts.evaluations));
  table.put("cache_hits", static_cast<double>(report.counts.cache_hits));
  std::printf(
      "%-16s %5.3g %7zu faces %3d parts  %6.2f s (%6.2f processor) %6.0f Y (Y %5.1f ms) %5.0f MB %6lld "
      "evaluations %7lld hits ",
      input.name.c_str(), params.e_max, input.soup.faces.size(), report.patches, timed.wall, timed.processor,
      timed.wall / unit, 1000 * unit, timed.peak_mb, static_cast<long long>(report.counts.evaluations),
      static_cast<long long>(report.counts.cache_hits));
  for (std::size_t s = 0; s < kStages.size(); ++s) {
    const auto it = report.timings.find(kStages[s]);
    table.put(kStages[s], it == report.timings.end() ? 0 : it->second);
    table.put(std::string(kStages[s]) + "_processor", timed.stages[s]);
    std::printf(" %s %.2f", kStages[s], timed.stages[s]);
  }
  std::printf("%s\n", report.e_max_met ? "" : "  TOLERANCE NOT MET");
  std::fflush(stdout);
  sizes.push_back({input.name, static_cast<double>(input.soup.faces.size()), params.e_max, timed.stages});
}

// The power of the number of faces with which each stage grows, from each size to the next.
void print_growth() {
  std::printf("\ngrowth: processor seconds ~ faces ^\n");
  std::stable_sort(sizes.begin(), sizes.end(), [](const Size& a, const Size& b) {
    return std::tie(a.mesh, a.e_max) < std::tie(b.mesh, b.e_max);
  });
  for (std::size_t i = 1; i < sizes.size(); ++i) {
    const Size &small = sizes[i - 1], &large = sizes[i];
    if (small.mesh != large.mesh || small.e_max != large.e_max) continue;
    std::printf("%-16s %5.3g %7.0f -> %7.0f", large.mesh.c_str(), large.e_max, small.faces, large.faces);
    for (std::size_t s = 0; s < kStages.size(); ++s) {
      const double before = small.stages[s], after = large.stages[s];
      const double power = std::log(after / before) / std::log(large.faces / small.faces);
      if (before < kTooShort)
        std::printf("  %s    -", kStages[s]);
      else
        std::printf("  %s %4.2f", kStages[s], power);
    }
    std::printf("\n");
  }
}

}  // namespace
}  // namespace sheetform::bench

int main(int argc, char** argv) try {
  const auto options = sheetform::bench::parse_options(argc, argv);
  const int status =
      sheetform::bench::run_all(options, sheetform::bench::own_scaling(), sheetform::bench::row);
  if (options.files.empty() || options.refine > 0) sheetform::bench::print_growth();
  return status;
} catch (const std::exception& e) {
  std::fprintf(stderr, "bench_decompose: %s\n", e.what());
  return 2;
}
