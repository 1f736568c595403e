// A run stops wherever it is. How often it looks is counted in checkpoints: no clock tells that on a busy
// machine. The linker leads every call of RunContext::checkpoint() from another file through the counter here
// (CMakeLists.txt).
#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <functional>
#include <set>

#include "pipeline/run.h"
#include "sheetform/mesh/creases.h"
#include "sheetform/mesh/mesh_repair.h"
#include "sheetform/mesh/prepare.h"

namespace sheetform {
namespace {

std::atomic<long> looks{0};
std::atomic<double> longest_gap{0};  // seconds of one thread's work without a look
thread_local double last_look = -1;  // of this thread, in seconds of its own

// Of this thread: what others do to the machine does not count.
double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

void count_look() {
  looks.fetch_add(1, std::memory_order_relaxed);
  const double now = thread_seconds();
  double longest = longest_gap;
  if (last_look >= 0)
    while (now - last_look > longest && !longest_gap.compare_exchange_weak(longest, now - last_look)) {
    }
  last_look = now;
}

}  // namespace
}  // namespace sheetform

// RunContext::checkpoint() const, as compilers on this system name it.
extern "C" {
void __real__ZNK9sheetform10RunContext10checkpointEv(const sheetform::RunContext*);
void __wrap__ZNK9sheetform10RunContext10checkpointEv(const sheetform::RunContext* context) {
  sheetform::count_look();
  __real__ZNK9sheetform10RunContext10checkpointEv(context);
}
}

namespace sheetform {
namespace {

// A pass over the mesh costs at most 0.5 us a face, so this many faces are 25 ms.
constexpr long kFacesForALook = 50'000;

long looks_of(const std::function<void(RunContext&)>& step) {
  RunContext context;
  looks = 0;
  step(context);
  return looks;
}

TEST(Stopping, EveryStepOfPreparationLooksOftenEnough) {
  const TriangleSoup soup = shapes::sphere(60);
  const SurfaceMesh mesh = build_surface_mesh(soup.points, soup.faces);
  const long faces = mesh.face_count();
  const auto often = [&](long passes) { return passes * (faces / kFacesForALook + 1); };
  EXPECT_GE(looks_of([&](RunContext& c) { repair(soup, c); }), often(5));
  EXPECT_GE(looks_of([&](RunContext& c) { detect_creases(mesh, 40, c); }), often(2));
  EXPECT_GE(looks_of([&](RunContext& c) { ClosestPointTree(soup.points, soup.faces, c); }), often(8));
  const std::vector<char> smooth(mesh.edges.size(), 0);
  EXPECT_GE(looks_of([&](RunContext& c) { prepare(mesh, smooth, edge_length_for(mesh, 4000), c); }),
            often(20));
}

// The longer the work, the more looks: they are in the loops, not beside them.
TEST(Stopping, LooksGrowWithTheMesh) {
  for (const auto& step : std::vector<std::function<void(const TriangleSoup&, RunContext&)>>{
           [](const TriangleSoup&s, RunContext&c) { ClosestPointTree(s.points, s.faces, c); },
           [](const TriangleSoup&s, RunContext&c) {
             detect_creases(build_surface_mesh(s.points, s.faces), 40, c);
           },
           [](const TriangleSoup&s, RunContext&c) {
             const SurfaceMesh mesh = build_surface_mesh(s.points, s.faces);
             prepare(mesh, {}, edge_length_for(mesh, 2000), c);
           }}) {
    const auto looked = [&](int n) { return looks_of([&](RunContext& c) { step(shapes::sphere(n), c); }); };
    EXPECT_GT(looked(60), 2 * looked(24));
  }
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__OPTIMIZE__)
constexpr double kSlower = 15;
#else
constexpr double kSlower = 1;
#endif

// A run asked to stop does so within 200 ms, wherever it is, also on a mesh far larger than the working one,
// whether it is even or has to be cleaned first.
TEST(Stopping, NeverWorksLongWithoutALook) {
  for (const double stretch : {1.0, 6.0}) {
    InputMesh input;
    input.soup = shapes::torus(640, 160);
    for (Vector3& p : input.soup.points) p.x() *= stretch;
    DecomposeParams params = with_e_max(0.05);
    params.effort = Effort::kDraft;
    RunContext context;
    context.threads = 2;
    longest_gap = 0, last_look = thread_seconds();
    decompose(input, params, nullptr, context);
    context.checkpoint();
    EXPECT_LT(longest_gap, 0.2 * kSlower) << input.soup.faces.size() << " faces, stretched by " << stretch;
    EXPECT_GT(longest_gap, 0);
  }
}

struct Stopped {
  std::set<Stage> reached;
  long looks_after = 0;  // from the request to the end
  bool stopped = false;
};

// Asks to stop as soon as `stage` reports for the first time (never when nothing is given).
Stopped run_and_cancel(const TriangleSoup& soup, std::optional<Stage> stage, int threads) {
  InputMesh input;
  input.soup = soup;
  RunContext context;
  std::atomic<bool> cancelled{false};
  Stopped out;
  long asked = 0;
  context.threads = threads;
  context.cancelled = &cancelled;
  context.progress = [&](Stage now, double, const std::string&) {
    EXPECT_FALSE(cancelled) << "went on to report " << to_string(now);
    out.reached.insert(now);
    if (stage && now == *stage) cancelled = true, asked = looks;
  };
  try {
    decompose(input, with_e_max(0.05), nullptr, context);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::kCancelled);
    out.stopped = true;
  }
  out.looks_after = looks - asked;
  return out;
}

TEST(Stopping, TheNextLookEndsTheRunInEveryStage) {
  const TriangleSoup soup = shapes::torus(36, 18);
  const Stopped whole = run_and_cancel(soup, std::nullopt, 1);
  EXPECT_FALSE(whole.stopped);
  EXPECT_GE(whole.reached.size(), 5u);
  for (int threads : {1, 3})
    for (Stage stage : whole.reached) {
      const Stopped s = run_and_cancel(soup, stage, threads);
      EXPECT_TRUE(s.stopped) << to_string(stage);
      // Nothing catches the stop and goes on.
      EXPECT_LE(s.looks_after, 4 * threads) << to_string(stage);
    }
}

TEST(Stopping, CancelledBeforeItBegins) {
  std::atomic<bool> cancelled{true};
  InputMesh input;
  input.soup = shapes::sphere(40);
  RunContext context;
  context.cancelled = &cancelled;
  looks = 0;
  EXPECT_THROW(decompose(input, {}, nullptr, context), Error);
  EXPECT_LE(looks, 1);
}

TEST(Stopping, DeadlineEndsTheRun) {
  InputMesh input;
  input.soup = shapes::torus(72, 36);
  RunContext context;
  context.deadline = std::chrono::steady_clock::now() + std::chrono::milliseconds(30);
  try {
    decompose(input, with_e_max(0.01), nullptr, context);
    FAIL() << "went on";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::kDeadlineExceeded);
    EXPECT_FALSE(e.fix().empty());
  }
}

TEST(Stopping, DeadlineInTheFutureChangesNothing) {
  InputMesh input;
  input.soup = shapes::saddle(16, 0.8);
  RunContext hurried, free;
  hurried.deadline = std::chrono::steady_clock::now() + std::chrono::hours(1);
  EXPECT_EQ(decompose(input, {}, nullptr, hurried).strips.points,
            decompose(input, {}, nullptr, free).strips.points);
}

}  // namespace
}  // namespace sheetform
